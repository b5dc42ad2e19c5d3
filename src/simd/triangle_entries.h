// SPDX-License-Identifier: MIT
//
// triangle_entries.h: stiffness and mass entries of a range of triangles, the hot loop of assembly, compiled for
// several instruction sets and picked at run time.
//
//   const detail::TriangleInputs<double> in{.cot = cot, .area = area, .curvature = K, .n = 4};
//   const detail::TriangleOutputs<double> out{.stiffness_diagonal = d, .stiffness_off = s, .mass_off = m};
//   detail::triangle_entries(0, faces, in, out);
//
// Entries come without the phases e^{iR} (kernels/stiffness_mass.h). A triangle's result depends neither on the range
// it is computed in nor on the instruction set, to the last bit (beyond |n K| = 4 as far as the C library's sine does).
#pragma once

#include <complex>
#include <cstdint>

#include "src/simd/dispatch.h"

namespace alcap::detail {

/// Per face f; arrays of float or double.
template <class T>
struct TriangleInputs {
  const T* cot;        ///< 3 f + c: cotangent of corner c
  const T* area;       ///< f
  const T* curvature;  ///< f: lifted K of the connection
  T n;                 ///< degree of the field; the field sees n K
};

/// Per face f; pair c is (c, c+1), row c, column c+1, without e^{iR}.
template <class T>
struct TriangleOutputs {
  T* stiffness_diagonal;           ///< 3 f + c
  std::complex<T>* stiffness_off;  ///< 3 f + c
  std::complex<T>* mass_off;       ///< f: the same for the three pairs (the diagonal of M is area / 6)
};

/// Entries of the faces begin <= f < end. T is float or double. Throws OptionError when `isa` is not available here.
template <class T>
void triangle_entries(std::int64_t begin, std::int64_t end, const TriangleInputs<T>& in, const TriangleOutputs<T>& out,
                      Isa isa = best_isa()) {
  simd::element_loops<T>(isa).triangle_entries(
      begin, end,
      {in.cot, in.area, in.curvature, in.n, out.stiffness_diagonal, reinterpret_cast<T*>(out.stiffness_off),
       reinterpret_cast<T*>(out.mass_off)});
}

}  // namespace alcap::detail
