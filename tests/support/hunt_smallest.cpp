// SPDX-License-Identifier: MIT
//
// hunt_smallest.cpp: looks for meshes on which the eigenpair that is returned is not the smallest one, or the second
// eigenvalue is wrong. Every mesh is random; what solvers say is held against counts of eigenvalues. No test: a run has
// no end but the one asked for. See scripts/hunt_smallest.sh.
//
//   hunt_smallest RUNS SEED [FAMILY]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "alcap/connected_surface.h"
#include "alcap/energies.h"
#include "alcap/generators.h"
#include "alcap/solve.h"
#include "src/base/random.h"
#include "tests/support/mesh_helpers.h"

namespace {

using namespace alcap;
using alcap::test::together;
using Row = Eigen::RowVector3d;

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  double between(double a, double b) { return random_.uniform(a, b); }
  int whole(int a, int b) { return a + static_cast<int>(random_.uniform(0, 1) * (b - a + 1)); }
  /// Normally distributed (Box and Muller 1958).
  double normal() {
    return std::sqrt(-2 * std::log(1 - random_.uniform(0, 1))) * std::cos(2 * pi<double> * random_.uniform(0, 1));
  }
  std::uint64_t seed() { return static_cast<std::uint64_t>(whole(1, 1'000'000)); }

 private:
  detail::Random random_;
};

/// Points spread evenly over the sphere.
std::vector<Row> spread(int count) {
  std::vector<Row> points;
  for (int k = 0; k < count; ++k) {
    const double z = 1 - (2 * k + 1.0) / count, turn = pi<double> * (1 + std::sqrt(5.0)) * (k + 0.5);
    const double r = std::sqrt(1 - z * z);
    points.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  return points;
}

double edge_of(const MeshData& sphere) { return std::sqrt(4 * pi<double> / static_cast<double>(sphere.V.rows())); }

int level(Dice& dice) { return dice.whole(4, 5); }

/// Every vertex moved along its normal.
MeshData noise(Dice& dice) {
  MeshData m = icosphere(level(dice));
  const double amount = dice.between(0.05, 0.6) * edge_of(m);
  for (Eigen::Index i = 0; i < m.V.rows(); ++i) m.V.row(i) *= 1 + amount * dice.normal();
  return m;
}

/// Noise with smooth patches of about the same size in it, each of which holds a localised vector.
MeshData patches(Dice& dice) {
  MeshData m = icosphere(level(dice));
  const double amount = dice.between(0.2, 0.6) * edge_of(m), radius = dice.between(0.08, 0.2);
  const double difference = dice.between(0, 0.1);
  const std::vector<Row> centres = spread(dice.whole(20, 100));
  std::vector<double> radii;
  for (std::size_t k = 0; k < centres.size(); ++k) radii.push_back(radius * (1 + difference * dice.between(-1, 1)));
  for (Eigen::Index i = 0; i < m.V.rows(); ++i) {
    const Row x = m.V.row(i);
    double nearest = 10;
    for (std::size_t k = 0; k < centres.size(); ++k)
      nearest = std::min(nearest, std::acos(std::clamp(x.dot(centres[k]), -1.0, 1.0)) / radii[k]);
    m.V.row(i) = x * (1 + amount * std::clamp(4 * (nearest - 1), 0.0, 1.0) * dice.normal());
  }
  return m;
}

/// Bumps on a sphere, all the same and evenly spread, or of any height anywhere.
MeshData bumps(Dice& dice) {
  MeshData m = icosphere(level(dice));
  const bool same = dice.whole(0, 1) == 1;
  const double height = dice.between(0.1, 0.6), width = dice.between(0.04, 0.12);
  std::vector<Row> centres = spread(dice.whole(20, 120));
  std::vector<double> heights(centres.size(), height);
  for (std::size_t k = 0; !same && k < centres.size(); ++k) {
    centres[k] = Row(dice.normal(), dice.normal(), dice.normal()).normalized();
    heights[k] *= dice.between(0.3, 1);
  }
  for (Eigen::Index i = 0; i < m.V.rows(); ++i) {
    const Row x = m.V.row(i);
    double scale = 1;
    for (std::size_t k = 0; k < centres.size(); ++k)
      scale += heights[k] * std::exp(-(x - centres[k]).squaredNorm() / (width * width));
    m.V.row(i) = scale * x;
  }
  return m;
}

/// Spheres in a row, joined by thin necks: a surface of revolution, `around` vertices a ring.
MeshData chain(Dice& dice) {
  const int count = dice.whole(10, 70), around = dice.whole(10, 15), rings = dice.whole(10, 15);
  const double neck = dice.between(0.05, 0.3), difference = dice.between(0, 0.05);
  std::vector<std::array<double, 2>> profile;  // height and radius
  double base = 0;
  for (int q = 0; q < count; ++q) {
    const double R = 1 + difference * dice.normal();
    const double from = q > 0 ? std::asin(neck / R) : 0;
    const double to = pi<double> - (q + 1 < count ? std::asin(neck / R) : 0);
    for (int k = q > 0 ? 1 : 0; k < rings; ++k) {
      const double t = from + (to - from) * k / (rings - 1);
      profile.push_back({base + R * (std::cos(from) - std::cos(t)), R * std::sin(t)});
    }
    base = profile.back()[0];
  }
  const int n = static_cast<int>(profile.size()) - 2, last = n * around + 1;
  MeshData m{Positions<double>(last + 1, 3), Faces(2 * around * n, 3)};
  m.V.row(0) = Row(0, 0, profile.front()[0]);
  m.V.row(last) = Row(0, 0, profile.back()[0]);
  const auto at = [&](int i, int j) { return 1 + i * around + j % around; };
  int face = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < around; ++j) {
      const double t = (2 * j + i % 2) * pi<double> / around, r = profile[static_cast<std::size_t>(i) + 1][1];
      m.V.row(at(i, j)) = Row(r * std::cos(t), r * std::sin(t), profile[static_cast<std::size_t>(i) + 1][0]);
      if (i == 0) m.F.row(face++) << 0, at(0, j + 1), at(0, j);
      if (i + 1 == n) {
        m.F.row(face++) << last, at(i, j), at(i, j + 1);
        continue;
      }
      const int s = i % 2, a = at(i, j), b = at(i, j + 1), c = at(i + 1, j), d = at(i + 1, j + 1);
      m.F.row(face++) << a, b, s == 0 ? c : d;
      m.F.row(face++) << (s == 0 ? b : a), d, c;
    }
  return m;
}

MeshData scan(Dice& dice) { return noisy_scan(level(dice), dice.between(0.05, 0.5), dice.seed()); }

MeshData shaft(Dice& dice) { return cad_like(24 + 8 * dice.whole(0, 11), dice.whole(8, 19)); }

MeshData noisy_torus(Dice& dice) {
  MeshData m = torus_random_diagonals(dice.whole(60, 120), dice.whole(30, 60), 1, dice.between(0.1, 0.7), dice.seed());
  const double amount = dice.between(0, 0.25) * std::sqrt(4 * pi<double> * pi<double> * 0.4 / double(m.V.rows()));
  for (Eigen::Index i = 0; i < m.V.rows(); ++i) m.V.row(i) += amount * Row(dice.normal(), dice.normal(), dice.normal());
  return m;
}

MeshData jittered(Dice& dice) { return jittered_sphere(level(dice), dice.between(0.02, 0.3), dice.seed()); }

/// The whole matrix of several pieces at once, as callers of smallest_eigenpair() may have it.
MeshData pieces(Dice& dice) {
  MeshData all = jittered_sphere(3, dice.between(0.02, 0.2), dice.seed());
  for (int k = dice.whole(1, 8); k > 0; --k) {
    MeshData next = jittered_sphere(3, dice.between(0.02, 0.2), dice.seed());
    next.V *= dice.between(0.95, 1.05);
    all = together(all, next);
  }
  return all;
}

const std::map<std::string, std::function<MeshData(Dice&)>> families{
    {"noise", noise}, {"patches", patches},   {"bumps", bumps},     {"chain", chain},  {"scan", scan},
    {"shaft", shaft}, {"torus", noisy_torus}, {"jitter", jittered}, {"pieces", pieces}};

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
