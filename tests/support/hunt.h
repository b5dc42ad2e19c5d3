// SPDX-License-Identifier: MIT
//
// hunt.h: what the programs that look for hard meshes share: arguments, one run after another over all families, seeds
// that tell which one it was. See scripts/hunt.sh.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <string>

#include "tests/support/random_meshes.h"

namespace alcap::test {

/// Calls hunt(family, seed, tally) RUNS times, family after family; every run has a seed of its own. Prints a line for
/// each family and one for all at the end, and after every 200 runs, so that a search that is stopped still tells what
/// it saw. Returns the exit code: 0 where nothing was wrong. Tally: add(Tally), bad().
///
///   NAME RUNS SEED [FAMILY]
template <class Tally, class Hunt, class Print>
int hunt_all(int argc, char** argv, const char* head, Hunt&& hunt, Print&& print) {
  if (argc < 3 || (argc > 3 && families.count(argv[3]) == 0)) {
    std::fprintf(stderr, "%s RUNS SEED [FAMILY]\n", argv[0]);
    return 2;
  }
  const int runs = std::atoi(argv[1]);
  const std::uint64_t seed = std::strtoull(argv[2], nullptr, 10);
  std::map<std::string, Tally> tallies;
  Tally all;
  const auto table = [&] {
    std::printf("%s\n", head);
    all = {};
    for (const auto& [family, tally] : tallies) {
      print(family, tally);
      all.add(tally);
    }
    print(std::string("all"), all);
    std::fflush(stdout);
  };
  constexpr int runs_per_table = 200;
  int failures = 0;
  for (int run = 0; run < runs;)
    for (const auto& [family, make] : families) {
      if ((argc > 3 && family != argv[3]) || run >= runs) continue;
      const std::uint64_t own = seed * 1'000'003 + static_cast<std::uint64_t>(run++);
      try {
        hunt(family, own, tallies[family]);
      } catch (const std::exception& e) {
        std::printf("%s, seed %llu: %s\n", family.c_str(), static_cast<unsigned long long>(own), e.what());
        ++failures;
      }
      std::fflush(stdout);
      if (run % runs_per_table == 0 && run < runs) table();
    }
  table();
  return all.bad() + failures > 0 ? 1 : 0;
}

}  // namespace alcap::test
