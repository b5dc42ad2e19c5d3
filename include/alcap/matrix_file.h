// SPDX-License-Identifier: MIT
//
// matrix_file.h: matrices as files that other programs read, to run one's own solver on them. `alcap export-matrices`
// does it for a mesh.
//
//   const auto [S, M] = alcap::energy_matrices(connected, 4);
//   alcap::write_matrix("stiffness.mtx", S, alcap::MatrixFormat::mtx);
//
// petsc: PETSc's binary format, read by MatLoad() of a complex build and by PETSc's scripts for Python and MATLAB: big
//        endian; four 32-bit numbers 1211216, rows, columns, entries; entries per row; column of each entry; values as
//        pairs of doubles, row by row.
// mtx:   Matrix Market, text: "coordinate complex hermitian", the lower triangle, numbers that read back exactly.
// npz:   what scipy.sparse.load_npz() reads, as a csc_matrix.
#pragma once

#include <complex>
#include <filesystem>

#include "alcap/names.h"
#include "alcap/solve.h"

namespace alcap {

/// See above.
enum class MatrixFormat { petsc, mtx, npz };

/// The names, which are the extensions of the files as well.
template <>
struct NamesOf<MatrixFormat> {
  static constexpr auto table = detail::name_table<MatrixFormat>(
      {{MatrixFormat::petsc, "petsc"}, {MatrixFormat::mtx, "mtx"}, {MatrixFormat::npz, "npz"}});
};

/// Writes a Hermitian matrix with both triangles stored; the file appears complete or not at all. Throws FileError when
/// it cannot be written, or when an array of an npz would have 4 GB or more (take petsc then).
/// Throws SolveError when the matrix is not square.
void write_matrix(const std::filesystem::path& path, const SparseMatrix<std::complex<double>>& A, MatrixFormat format);

}  // namespace alcap
