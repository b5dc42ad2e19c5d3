// SPDX-License-Identifier: MIT
//
// Matrices as files, read back by hand, bit for bit, and files that cannot be written. SciPy reads them in
// cli_matrices_read_back.
#include <doctest/doctest.h>

#include <bit>
#include <complex>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>

#include "alcap/connection.h"
#include "alcap/energies.h"
#include "alcap/generators.h"
#include "alcap/matrix_file.h"
#include "src/base/bytes.h"
#include "tests/support/folder.h"
#include "tests/support/mesh_case.h"

using namespace alcap;

namespace {

using Z = std::complex<double>;
using Matrix = SparseMatrix<Z>;

std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

Matrix from_entries(Eigen::Index rows, const std::vector<Eigen::Triplet<Z>>& entries) {
  Matrix A(rows, rows);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

Matrix read_petsc(const std::string& bytes) {
  const char* at = bytes.data();
  const auto integer = [&] { return at += 4, detail::load<std::int32_t, std::endian::big>(at - 4); };
  const auto real = [&] { return at += 8, detail::load<double, std::endian::big>(at - 8); };
  REQUIRE(integer() == 1211216);
  const int rows = integer();
  REQUIRE(integer() == rows);
  const auto entries = static_cast<std::size_t>(integer());
  std::vector<int> row;
  for (int i = 0; i < rows; ++i)
    for (int k = integer(); k > 0; --k) row.push_back(i);
  REQUIRE(row.size() == entries);
  std::vector<int> column(entries);
  for (int& j : column) j = integer();
  std::vector<Eigen::Triplet<Z>> all;
  for (std::size_t k = 0; k < entries; ++k) {
    const double re = real();
    all.emplace_back(row[k], column[k], Z(re, real()));
  }
  CHECK(at == bytes.data() + bytes.size());
  return from_entries(rows, all);
}

Matrix read_mtx(const std::string& text) {
  std::istringstream in(text);
  std::string line;
  std::getline(in, line);
  CHECK(line == "%%MatrixMarket matrix coordinate complex hermitian");
  std::getline(in, line);
  int rows = 0, columns = 0, entries = 0;
  in >> rows >> columns >> entries;
  std::vector<Eigen::Triplet<Z>> all;
  int i = 0, j = 0;
  std::string re, im;
  for (; in >> i >> j >> re >> im; --entries) {
    const Z value(std::stod(re), std::stod(im));
    all.emplace_back(i - 1, j - 1, value);
    if (i != j) all.emplace_back(j - 1, i - 1, std::conj(value));
  }
  CHECK(entries == 0);
  return from_entries(rows, all);
}

Matrix stiffness() {
  const test::MeshCase s(bumpy_sphere(2, 0.3, 5));
  return energy_matrices(s.mesh, s.geometry, polar(s.mesh, s.geometry), 2).S;
}

}  // namespace

TEST_CASE("petsc and mtx hold the matrix to the last bit") {
  const test::Folder folder;
  Matrix A = stiffness();
  const auto same = [&] {
    write_matrix(folder.path / "A.petsc", A, MatrixFormat::petsc);
    write_matrix(folder.path / "A.mtx", A, MatrixFormat::mtx);
    const Matrix B = read_petsc(text_of(folder.path / "A.petsc")), C = read_mtx(text_of(folder.path / "A.mtx"));
    CHECK((MatrixX<Z>(A) == MatrixX<Z>(B)));
    CHECK((MatrixX<Z>(A) == MatrixX<Z>(C)));
    CHECK(B.nonZeros() == A.nonZeros());
  };
  same();
  A.coeffRef(0, 50) = Z(1e-300, -3);  // no longer compressed, and values of all sizes
  A.coeffRef(50, 0) = Z(1e-300, 3);
  A.coeffRef(7, 7) = 1e300;
  same();
  A.resize(3, 3);  // without entries
  same();
}

TEST_CASE("an npz is an archive of arrays with the right checksums") {
  const test::Folder folder;
  Matrix A(2, 2);
  A.insert(0, 0) = 1;
  A.insert(1, 1) = 2;
  write_matrix(folder.path / "A.npz", A, MatrixFormat::npz);
  const std::string bytes = text_of(folder.path / "A.npz");
  CHECK(bytes.starts_with("PK\x03\x04"));
  for (const char* name : {"indices.npy", "indptr.npy", "format.npy", "shape.npy", "data.npy"})
    CHECK(bytes.find(name) != std::string::npos);
  // The member "format": its checksum is that of its bytes, bit by bit.
  const std::size_t head = bytes.find("format.npy") - 30;
  const auto size = detail::load<std::uint32_t, std::endian::little>(&bytes[head + 18]);
  const std::string member = bytes.substr(head + 30 + 10, size);
  CHECK(member.ends_with("csc"));
  std::uint32_t crc = ~0U;
  for (const char c : member)
    for (int bit = 0; bit < 8; ++bit) {
      const bool odd = ((crc ^ (static_cast<unsigned char>(c) >> bit)) & 1U) != 0;
      crc = (crc >> 1U) ^ (odd ? 0xEDB88320U : 0U);
    }
  CHECK(detail::load<std::uint32_t, std::endian::little>(&bytes[head + 14]) == ~crc);
}

TEST_CASE("what cannot be written is a FileError, what is no Hermitian matrix a SolveError") {
  const test::Folder folder;
  const Matrix A = stiffness();
  for (const auto& [format, name] : names_of<MatrixFormat>()) {
    const std::string shown(name);
    CAPTURE(shown);
    CHECK_THROWS_AS(write_matrix(folder.path / "none" / "A", A, format), FileError);
    CHECK_THROWS_AS(write_matrix("/dev/full", A, format), FileError);
    CHECK_THROWS_AS(write_matrix(folder.path / "A", Matrix(2, 3), format), SolveError);
    CHECK(!std::filesystem::exists(folder.path / "A"));
  }
}
