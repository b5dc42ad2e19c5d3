// SPDX-License-Identifier: MIT
//
// hunt_smallest.cpp: looks for meshes on which the eigenpair that is returned is not the smallest one, or the second
// eigenvalue is wrong. Every mesh is random; what solvers say is held against counts of eigenvalues. No test: a run has
// no end but the one asked for. See scripts/hunt_smallest.sh.
//
//   hunt_smallest RUNS SEED [FAMILY]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <string>

#include "alcap/connected_surface.h"
#include "alcap/energies.h"
#include "alcap/solve.h"
#include "tests/support/random_meshes.h"

namespace {

using namespace alcap;
using alcap::test::Dice, alcap::test::families;
struct Tally {
  int runs = 0, cascade_wrong = 0, wrong = 0, proven = 0, next = 0, next_wrong = 0;
  double cascade_seconds = 0, seconds = 0;
};

/// Whether `next` is the second eigenvalue to what it promises.
bool next_right(const StiffnessMass& m, double next) {
  constexpr double accuracy = 1.01e-3;
  return inertia(m.S, m.M, next * (1 - accuracy)).below <= 1 && inertia(m.S, m.M, next * (1 + accuracy)).below >= 2;
}

void hunt(const std::string& family, std::uint64_t seed, Tally& tally) {
  Dice dice(seed);
  const MeshData mesh = families.at(family)(dice);
  const int n = dice.whole(1, 8);
  const ConnectedSurface surface = connect(Surface(mesh.V, mesh.F), {.n = n});
  const StiffnessMass m = energy_matrices(surface.mesh(), surface.geometry(), surface.connection(), n, 0.0);
  const double area = surface.geometry().total_area();
  const EigenReport cascade =
      smallest_eigenpair(m.S, m.M, area, {.method = "lobpcg", .prove_smallest = Prove::never}).report;
  const EigenReport all = smallest_eigenpair(m.S, m.M, area).report;
  constexpr double below = 2e-6;  // twice what a proof leaves open
  const auto count = inertia(m.S, m.M, all.lambda - below * std::max(all.lambda, 1 / area)).below;
  const bool next_wrong = all.next && !next_right(m, *all.next);
  ++tally.runs;
  tally.cascade_wrong += cascade.lambda > all.lambda * (1 + below);
  tally.wrong += count != 0;
  tally.proven += all.smallest == Smallest::proven;
  tally.next += all.next.has_value();
  tally.next_wrong += next_wrong;
  tally.cascade_seconds += cascade.seconds;
  tally.seconds += all.seconds;
  if (count == 0 && !next_wrong && all.smallest == Smallest::proven) return;
  std::printf("%s, seed %llu, n = %d, %d vertices: lambda %.9g (%s), %lld below, next %.9g %s; %s\n", family.c_str(),
              static_cast<unsigned long long>(seed), n, static_cast<int>(mesh.V.rows()), all.lambda,
              std::string(name(all.smallest)).c_str(), static_cast<long long>(count), all.next.value_or(0),
              next_wrong ? "WRONG" : "", all.smallest_note.c_str());
  std::fflush(stdout);
}

void print(const std::string& family, const Tally& t) {
  std::printf("%-8s %6d %10d %6d %7d %6d %6d %9.2f %9.2f\n", family.c_str(), t.runs, t.cascade_wrong, t.wrong, t.proven,
              t.next, t.next_wrong, t.cascade_seconds, t.seconds);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "hunt_smallest RUNS SEED [FAMILY]\n");
    return 2;
  }
  const int runs = std::atoi(argv[1]);
  const std::uint64_t seed = std::strtoull(argv[2], nullptr, 10);
  std::map<std::string, Tally> tallies;
  int failures = 0;
  for (int run = 0; run < runs;) {
    for (const auto& [family, make] : families) {
      if ((argc > 3 && family != argv[3]) || run >= runs) continue;
      try {
        hunt(family, seed * 1'000'003 + static_cast<std::uint64_t>(run), tallies[family]);
      } catch (const std::exception& e) {
        std::printf("%s, seed %llu: %s\n", family.c_str(),
                    static_cast<unsigned long long>(seed * 1'000'003 + static_cast<std::uint64_t>(run)), e.what());
        ++failures;
      }
      ++run;
    }
    if (argc > 3 && families.count(argv[3]) == 0) return 2;
  }
  std::printf("%-8s %6s %10s %6s %7s %6s %6s %9s %9s\n", "family", "runs", "lobpcg bad", "bad", "proven", "next", "bad",
              "lobpcg s", "auto s");
  Tally all;
  for (const auto& [family, t] : tallies) {
    print(family, t);
    all.runs += t.runs, all.cascade_wrong += t.cascade_wrong, all.wrong += t.wrong, all.proven += t.proven;
    all.next += t.next, all.next_wrong += t.next_wrong;
    all.cascade_seconds += t.cascade_seconds, all.seconds += t.seconds;
  }
  print("all", all);
  return all.wrong + all.next_wrong + failures > 0 ? 1 : 0;
}
