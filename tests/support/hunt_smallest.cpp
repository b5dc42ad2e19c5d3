// SPDX-License-Identifier: MIT
//
// hunt_smallest.cpp: looks for meshes on which the eigenpair that is returned is not the smallest one, or the second
// eigenvalue is wrong. Every mesh is random; what solvers say is held against counts of eigenvalues. No test: a run has
// no end but the one asked for. See scripts/hunt.sh.
//
//   hunt_smallest RUNS SEED [FAMILY]
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <string>

#include "alcap/connected_surface.h"
#include "alcap/energies.h"
#include "alcap/solve.h"
#include "tests/support/hunt.h"

namespace {

using namespace alcap;
using alcap::test::Dice, alcap::test::families;

struct Tally {
  int runs = 0, cascade_wrong = 0, wrong = 0, proven = 0, next = 0, next_wrong = 0;
  double cascade_seconds = 0, seconds = 0;

  void add(const Tally& t) {
    runs += t.runs, cascade_wrong += t.cascade_wrong, wrong += t.wrong, proven += t.proven;
    next += t.next, next_wrong += t.next_wrong;
    cascade_seconds += t.cascade_seconds, seconds += t.seconds;
  }
  [[nodiscard]] int bad() const { return wrong + next_wrong; }
};

/// Of this process, on all its threads.
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

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
  const double start = cpu_seconds();
  const EigenReport cascade =
      smallest_eigenpair(m.S, m.M, area, {.method = "lobpcg", .prove_smallest = Prove::never}).report;
  const double between = cpu_seconds();
  const EigenReport all = smallest_eigenpair(m.S, m.M, area).report;
  tally.seconds += cpu_seconds() - between;
  tally.cascade_seconds += between - start;
  constexpr double below = 2e-6;  // twice what a proof leaves open
  const auto count = inertia(m.S, m.M, all.lambda - below * std::max(all.lambda, 1 / area)).below;
  const bool next_wrong = all.next && !next_right(m, *all.next);
  ++tally.runs;
  const bool cascade_wrong = cascade.lambda > all.lambda * (1 + below);
  tally.cascade_wrong += cascade_wrong;
  tally.wrong += count != 0;
  tally.proven += all.smallest == Smallest::proven;
  tally.next += all.next.has_value();
  tally.next_wrong += next_wrong;
  if (count == 0 && !next_wrong && !cascade_wrong && all.smallest == Smallest::proven) return;
  std::printf("%s, seed %llu, n = %d, %d vertices: lambda %.9g (%s), %lld below, lobpcg %.9g, next %.9g %s; %s\n",
              family.c_str(), static_cast<unsigned long long>(seed), n, static_cast<int>(mesh.V.rows()), all.lambda,
              std::string(name(all.smallest)).c_str(), static_cast<long long>(count), cascade.lambda,
              all.next.value_or(0), next_wrong ? "WRONG" : "", all.smallest_note.c_str());
}

void print(const std::string& family, const Tally& t) {
  std::printf("%-8s %6d %10d %6d %7d %6d %6d %9.2f %9.2f\n", family.c_str(), t.runs, t.cascade_wrong, t.wrong, t.proven,
              t.next, t.next_wrong, t.cascade_seconds, t.seconds);
}

}  // namespace

int main(int argc, char** argv) {
  char head[128];
  std::snprintf(head, sizeof(head), "%-8s %6s %10s %6s %7s %6s %6s %9s %9s", "family", "runs", "lobpcg bad", "bad",
                "proven", "next", "bad", "lobpcg s", "auto s");
  return alcap::test::hunt_all<Tally>(argc, argv, head, hunt, print);
}
