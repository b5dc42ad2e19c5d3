// SPDX-License-Identifier: MIT
//
// triangle_entries.cpp: picks the loop for this machine. Compiled with baseline flags.
#include "alcap/detail/triangle_entries.h"

#include <algorithm>

#include "alcap/errors.h"
#include "src/simd/entries_raw.h"

namespace alcap::detail {

std::vector<Isa> available_isas() {
  std::vector<Isa> isas{Isa::scalar};
#if defined(__x86_64__)
  isas.push_back(Isa::sse2);
  // The compiler's run-time support also asks the operating system whether it saves the wide registers.
  if (__builtin_cpu_supports("avx2")) {
    isas.push_back(Isa::avx2);
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) {
      isas.push_back(Isa::avx512);
    }
  }
#endif
  return isas;
}

Isa best_isa() {
  static const Isa best = available_isas().back();
  return best;
}

const char* name(Isa isa) {
  switch (isa) {
    case Isa::scalar:
      return "scalar";
    case Isa::sse2:
      return "sse2";
    case Isa::avx2:
      return "avx2";
    case Isa::avx512:
      return "avx512";
  }
  return "unknown";
}

template <class T>
void triangle_entries(std::int64_t begin, std::int64_t end, const TriangleInputs<T>& in, const TriangleOutputs<T>& out,
                      Isa isa) {
  if (isa != best_isa()) {
    const std::vector<Isa> isas = available_isas();
    if (std::find(isas.begin(), isas.end(), isa) == isas.end()) {
      throw OptionError("isa", name(isa), "this machine cannot run it");
    }
  }
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
