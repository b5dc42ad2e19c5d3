// SPDX-License-Identifier: MIT
//
// dispatch.cpp: what this machine can run. Compiled with baseline flags.
#include "src/simd/dispatch.h"

#include "alcap/errors.h"

namespace alcap::detail {
namespace simd {

namespace scalar {
const Loops& loops();
}
namespace portable {
const Loops& loops();
}
namespace avx2 {
const Loops& loops();
}
namespace avx512 {
const Loops& loops();
}

}  // namespace simd

namespace {

struct Set {
  Isa isa;
  const char* name;
  const simd::Loops& (*loops)();
  bool (*runs_here)();
};

bool anywhere() { return true; }

// Slowest first. The compiler's run-time support also asks the operating system whether it saves the wide registers.
constexpr Set sets[] = {
    {Isa::scalar, "scalar", simd::scalar::loops, anywhere},
    {Isa::portable, "portable", simd::portable::loops, anywhere},
#if defined(__x86_64__)
    {Isa::avx2, "avx2", simd::avx2::loops, [] { return bool(__builtin_cpu_supports("avx2")); }},
    {Isa::avx512, "avx512", simd::avx512::loops,
     [] {
       return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
              __builtin_cpu_supports("avx512vl");
     }},
#endif
};

const Set* find(Isa isa) {
  for (const Set& set : sets)
    if (set.isa == isa) return &set;
  return nullptr;
}

const Set& best() {
  static const Set& found = *find(available_isas().back());
  return found;
}

}  // namespace

std::vector<Isa> available_isas() {
  std::vector<Isa> isas;
  for (const Set& set : sets)
    if (set.runs_here()) isas.push_back(set.isa);
  return isas;
}

Isa best_isa() { return best().isa; }

const char* name(Isa isa) {
  const Set* const set = find(isa);
  return set == nullptr ? "unknown" : set->name;
}

const simd::Loops& simd::loops(Isa isa) {
  if (isa == best().isa) return best().loops();
  const Set* const set = find(isa);
  if (set == nullptr || !set->runs_here()) throw OptionError("isa", name(isa), "this machine cannot run it");
  return set->loops();
}

}  // namespace alcap::detail
