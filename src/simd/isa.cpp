// SPDX-License-Identifier: MIT
//
// isa.cpp: what this machine can run. Compiled with baseline flags.
#include "src/simd/isa.h"

#include <algorithm>

#include "alcap/errors.h"

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

void require_isa(Isa isa) {
  if (isa == best_isa()) return;
  const std::vector<Isa> isas = available_isas();
  if (std::find(isas.begin(), isas.end(), isa) == isas.end()) {
    throw OptionError("isa", name(isa), "this machine cannot run it");
  }
}

}  // namespace alcap::detail
