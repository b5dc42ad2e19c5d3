// SPDX-License-Identifier: MIT
//
// hunt_accuracy.cpp: fields to an angle of 0.01 degrees against the same solved to ten digits and more, on random
// meshes: angles, what was said of them, singularities. No test: a run has no end but the one asked for. See
// scripts/hunt.sh.
//
//   hunt_accuracy RUNS SEED [FAMILY]
#include <algorithm>
#include <cstdio>
#include <string>

#include "alcap/energies.h"
#include "alcap/field_run.h"
#include "tests/support/angles.h"
#include "tests/support/hunt.h"

namespace {

using namespace alcap;
using alcap::test::AngleError, alcap::test::Dice, alcap::test::families;

struct Tally {
  int runs = 0, bounded = 0, unknown = 0, close = 0, above_bound = 0, moved = 0;
  int failures = 0;
  double worst = 0, worst_bound = 0;

  void add(const Tally& t) {
    runs += t.runs, bounded += t.bounded, close += t.close, unknown += t.unknown, above_bound += t.above_bound;
    moved += t.moved, failures += t.failures;
    worst = std::max(worst, t.worst), worst_bound = std::max(worst_bound, t.worst_bound);
  }
  [[nodiscard]] int bad() const { return failures; }
};

/// A failure where the truth is beyond what was said, or singularities differ without a reason.
void hunt(const std::string& family, std::uint64_t seed, Tally& tally) {
  Dice dice(seed);
  const MeshData mesh = families.at(family)(dice);
  const int n = dice.whole(1, 8);
  FieldRunOptions by_angle{.n = n};
  by_angle.connection.global.tolerance = 1e-6;
  by_angle.eigen.angle_tolerance = 0.01;
  const FieldRun run = run_field(mesh.V, mesh.F, by_angle);
  FieldRunOptions options{.n = n};
  options.connection.global.tolerance = 1e-10;
  options.eigen.tolerance = 1e-10;
  const FieldRun exact = run_field(mesh.V, mesh.F, options);
  ++tally.runs;
  if (run.eigen.size() > 1) {
    tally.moved += !alcap::test::moved_singularities(run.mesh(), run.indices, exact.indices).empty();
    return;
  }
  const EigenReport& eigen = run.eigen[0];
  const bool close = !eigen.next || *eigen.next - eigen.lambda < 1e-3 * *eigen.next;
  const StiffnessMass m = energy_matrices(run.mesh(), run.geometry(), run.connection(), n, 0.0);
  const AngleError error = alcap::test::angle_error(m.M, run.geometry().total_area(), run.field.u, exact.field.u, n);
  const bool bounded = eigen.angle_check == AngleCheck::bounded;
  // The other connection moves the field as well.
  constexpr double of_connection = 1e-3;
  const bool beyond = bounded && error.rms > *eigen.angle + of_connection;
  const std::vector<Index> changed = alcap::test::moved_singularities(run.mesh(), run.indices, exact.indices);
  const bool moved = !changed.empty();
  // The largest |u| at their corners, beside its root mean square.
  double length = 0;
  for (const Index t : changed)
    for (Index k = 0; k < 3; ++k)
      length = std::max(length,
                        std::abs(exact.field.u[exact.mesh().tail(3 * t + k)]) * std::sqrt(run.geometry().total_area()));
  tally.bounded += bounded;
  tally.unknown += !eigen.next;
  tally.close += close && eigen.next;
  tally.above_bound += beyond;
  tally.moved += moved;
  if (bounded) {
    tally.worst = std::max(tally.worst, error.rms);
    tally.worst_bound = std::max(tally.worst_bound, *eigen.angle);
  }
  if (!beyond && !moved && run.certificate.holds()) return;
  std::printf(
      "%s, seed %llu, n = %d, %d vertices: lambda %.6g, next %.6g, residual %.1e, angle %.2e (%s), true %.2e, at "
      "vertices %.2e%s%s, |u| %.1e\n",
      family.c_str(), static_cast<unsigned long long>(seed), n, static_cast<int>(mesh.V.rows()), eigen.lambda,
      eigen.next.value_or(0), eigen.residual, eigen.angle.value_or(-1), std::string(name(eigen.angle_check)).c_str(),
      error.rms, error.vertices, moved ? ", singularities moved" : "", beyond ? ", BEYOND ITS BOUND" : "", length);
  // Localised vectors fade to nothing; the connection and lambda have 6 and 10 digits.
  constexpr double faded = 1e-12;
  tally.failures += beyond || (moved && !close && length > faded);
}

void print(const std::string& family, const Tally& t) {
  std::printf("%-8s %6d %8d %8d %9d %7d %6d %10.2e %10.2e\n", family.c_str(), t.runs, t.bounded, t.unknown, t.close,
              t.above_bound, t.moved, t.worst_bound, t.worst);
}

}  // namespace

int main(int argc, char** argv) {
  char head[128];
  std::snprintf(head, sizeof(head), "%-8s %6s %8s %8s %9s %7s %6s %10s %10s", "family", "runs", "bounded", "no next",
                "small gap", "beyond", "moved", "angle", "true");
  return alcap::test::hunt_all<Tally>(argc, argv, head, hunt, print);
}
