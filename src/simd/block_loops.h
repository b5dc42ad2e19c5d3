// SPDX-License-Identifier: MIT
//
// block_loops.h: the loops of the solvers over blocks of vectors (part of loops.h). Only pointers and numbers.
//
// Blocks of K vectors have 2 K numbers a row: K real parts, then K imaginary parts.
#pragma once

#include "alcap/index.h"

namespace alcap::detail::simd {

/// Rows of a sparse complex matrix in single precision.
struct RawRows {
  const long long* start;
  const Index* column;
  const float* value;  ///< pairs
};

/// Columns of two Hermitian matrices of one pattern; row j is the conjugate of column j.
struct RawPencil {
  const Index* start;
  const Index* row;
  const double* S;  ///< pairs
  const double* M;
  double S_scale, M_scale;
};

/// The loops for one K.
struct BlockKernels {
  /// y_i = p u_i + q v_i + s (A x)_i for rows begin ... end - 1; u and v may be null, or y.
  void (*rows)(const RawRows& A, long long begin, long long end, const float* x, float p, const float* u, float q,
               const float* v, float s, float* y);
  /// Scaled S x and M x of rows begin ... end - 1 into the first rows of Sx and Mx, summed in double.
  void (*pencil)(const RawPencil& A, long long begin, long long end, const float* x, float* Sx, float* Mx);
  /// out += left^H right over `rows` rows; out is K x K: rows of real parts and, behind all of them, of imaginary
  /// parts.
  void (*gram)(const float* left, const float* right, long long rows, double* out);
  /// out = a ca + b cb, row by row; ca and cb K x K as out of gram; b may be null; out may be a or b.
  void (*combine)(const float* a, const float* ca, const float* b, const float* cb, long long rows, float* out);
};

/// The loops for one vector in double beside K of single precision. Its numbers are pairs.
struct VectorKernels {
  /// Scaled S x and M x of rows begin ... end - 1 into the first rows of Sx and Mx.
  void (*pencil)(const RawPencil& A, long long begin, long long end, const double* x, double* Sx, double* Mx);
  /// Adds y^H s and y^H m for the K vectors y: K real parts and K imaginary parts of the first, then of the second.
  void (*products)(const float* y, const double* s, const double* m, long long rows, double* out);
  /// p = w own[1] + p own[2] + y of_y, and then x = x own[0] + p. `own` are pairs, `of_y` K real, then K imaginary
  /// parts.
  void (*advance)(const double* own, const double* of_y, const float* y, const double* w, long long rows, double* p,
                  double* x);
};

}  // namespace alcap::detail::simd
