// SPDX-License-Identifier: MIT
//
// loops.h: the hot loops, as one table of functions that is compiled once per instruction set (loops_impl.h), and their
// arguments. Callers use the typed accessors: triangle_entries.h, angles.h, block_kernels.h, and loops() of dispatch.h.
//
// Only pointers and numbers: the files that include this are compiled for wide registers, and must not pull in inline
// functions that the linker could share with baseline code.
#pragma once

#include "src/simd/block_loops.h"
#include "src/simd/correction_loops.h"
#include "src/simd/front_loops.h"

namespace alcap::detail::simd {

/// TriangleInputs and TriangleOutputs (triangle_entries.h) with complex numbers as pairs of reals.
template <class T>
struct RawEntries {
  const T* cot;
  const T* area;
  const T* curvature;
  T n;
  T* stiffness_diagonal;
  T* stiffness_off;
  T* mass_off;
};

/// Loops over triangles and angles; see triangle_entries.h and angles.h. Complex numbers are pairs of reals.
template <class T>
struct ElementLoops {
  void (*triangle_entries)(long long begin, long long end, const RawEntries<T>& e);
  void (*upper_angles)(long long count, const T* y, const T* x, T* out);
  void (*unit_numbers)(long long count, const T* angle, T factor, T* out);
};

/// Everything that is compiled for one instruction set.
struct Loops {
  ElementLoops<float> elements_float;
  ElementLoops<double> elements_double;
  CorrectionLoops<float> correction_float;
  CorrectionLoops<double> correction_double;
  GroupLoops group;
  BlockKernels block_1, block_4, block_8, block_16;  // block_1: only `rows`
  VectorKernels vector_4, vector_8, vector_16;
  FrontLoops front;
};

}  // namespace alcap::detail::simd
