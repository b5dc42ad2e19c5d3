// SPDX-License-Identifier: MIT
//
// triangle_entries.cpp: picks the loop for this machine. Compiled with baseline flags.
#include "src/simd/triangle_entries.h"

#include "src/simd/entries_raw.h"

namespace alcap::detail {

template <class T>
void triangle_entries(std::int64_t begin, std::int64_t end, const TriangleInputs<T>& in, const TriangleOutputs<T>& out,
                      Isa isa) {
  require_isa(isa);
  const simd::RawEntries<T> raw{in.cot,
                                in.area,
                                in.curvature,
                                in.n,
                                out.stiffness_diagonal,
                                reinterpret_cast<T*>(out.stiffness_off),
                                reinterpret_cast<T*>(out.mass_off)};
  switch (isa) {
#if defined(__x86_64__)
    case Isa::avx512:
      return simd::entries_avx512(begin, end, raw);
    case Isa::avx2:
      return simd::entries_avx2(begin, end, raw);
    case Isa::sse2:
      return simd::entries_sse2(begin, end, raw);
#endif
    default:
      return simd::entries_scalar(begin, end, raw);
  }
}

template void triangle_entries(std::int64_t, std::int64_t, const TriangleInputs<float>&, const TriangleOutputs<float>&,
                               Isa);
template void triangle_entries(std::int64_t, std::int64_t, const TriangleInputs<double>&,
                               const TriangleOutputs<double>&, Isa);

}  // namespace alcap::detail
