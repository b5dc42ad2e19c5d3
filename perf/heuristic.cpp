// SPDX-License-Identifier: MIT
//
// heuristic.cpp: cross fields the way interactive remeshers find them (the idea of Jakob, Tarini, Panozzo,
// Sorkine-Hornung 2015): on a hierarchy of merged vertices every direction becomes the mean of its neighbours', each
// turned by the quarter turns that fit best, colour by colour, coarse to fine, in single precision. Cheap, and nobody
// knows what it is a minimum of. Beside it the same field the library's way: global connection, matrices, eigensolver.
// "singularities" of both.
#include <array>
#include <bit>
#include <cstdint>

#include "alcap/connected_surface.h"
#include "alcap/singularities.h"
#include "alcap/smoothest.h"
#include "perf/common.h"
#include "src/base/random.h"

namespace {

using namespace alcap;
using perf::Prepared;
using Vec = Eigen::Vector3f;

constexpr int sweeps = 6;  // on every level, as is usual
constexpr int most_colours = 64;

/// Vertices of one level, with their neighbours and what they became.
struct Level {
  std::vector<Vec> normal, direction;
  std::vector<float> area;
  std::vector<Index> start, neighbour, parent;
  std::vector<float> weight;
  std::vector<Index> order, colour_start;  // vertices by colour: none has a neighbour of its own
  [[nodiscard]] Index size() const { return static_cast<Index>(normal.size()); }
};

Vec normalised(const Vec& v) {
  const float length = v.norm();
  return length > 0 ? Vec(v / length) : Vec::UnitX();
}

Level finest(const Prepared& p) {
  const Mesh& mesh = p.mesh;
  Level level;
  const Index n = mesh.vertices();
  level.normal.resize(static_cast<std::size_t>(n));
  level.area.resize(level.normal.size());
  level.start.resize(level.normal.size() + 1);
  parallel_for(n, [&](std::int64_t v) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Index degree = mesh.boundary_vertex(static_cast<Index>(v)) ? 1 : 0;
    mesh.for_each_outgoing(static_cast<Index>(v), [&](Index h) {
      const Eigen::Vector3d a = p.surface.V.row(mesh.tip(h)) - p.surface.V.row(v);
      const Eigen::Vector3d b = p.surface.V.row(mesh.tail(Mesh::prev(h))) - p.surface.V.row(v);
      sum += a.cross(b);
      ++degree;
    });
    const auto i = static_cast<std::size_t>(v);
    level.area[i] = static_cast<float>(sum.norm() / 6);
    level.normal[i] = normalised(sum.cast<float>());
    level.start[i + 1] = degree;
  });
  for (std::size_t i = 0; i + 1 < level.start.size(); ++i) level.start[i + 1] += level.start[i];
  level.neighbour.resize(static_cast<std::size_t>(level.start.back()));
  level.weight.assign(level.neighbour.size(), 1);
  parallel_for(n, [&](std::int64_t v) {
    auto to = static_cast<std::size_t>(level.start[static_cast<std::size_t>(v)]);
    Index last = none;
    mesh.for_each_outgoing(static_cast<Index>(v), [&](Index h) {
      level.neighbour[to++] = mesh.tip(h);
      last = h;
    });
    if (mesh.boundary_vertex(static_cast<Index>(v))) level.neighbour[to] = mesh.tail(Mesh::prev(last));
  });
  return level;
}

/// Pairs of neighbours, those of like normals and areas first.
std::vector<std::array<Index, 2>> pairs_of(const Level& level, std::vector<bool>& taken) {
  constexpr int buckets = 256;
  const auto score = [&](std::size_t i, std::size_t j) {
    const float a = level.area[i], b = level.area[j];
    const float even = a > b ? b / a : a > 0 ? a / b : 1;
    return std::max(0.0F, level.normal[i].dot(level.normal[j])) * even;
  };
  const auto n = static_cast<std::size_t>(level.size());
  std::vector<std::uint8_t> rank(level.neighbour.size());
  std::array<std::size_t, buckets + 1> first{};
  parallel_for(level.size(), [&](std::int64_t v) {
    const auto i = static_cast<std::size_t>(v);
    for (auto e = static_cast<std::size_t>(level.start[i]); e < static_cast<std::size_t>(level.start[i + 1]); ++e)
      rank[e] = static_cast<std::uint8_t>(
          (buckets - 1) - static_cast<int>((buckets - 1) * std::min(1.0F, score(i, std::size_t(level.neighbour[e])))));
  });
  const auto each = [&](const auto& body) {
    for (std::size_t i = 0; i < n; ++i)
      for (auto e = static_cast<std::size_t>(level.start[i]); e < static_cast<std::size_t>(level.start[i + 1]); ++e)
        if (i < static_cast<std::size_t>(level.neighbour[e])) body(static_cast<Index>(i), e);
  };
  each([&](Index, std::size_t e) { ++first[rank[e] + 1U]; });
  for (std::size_t b = 0; b < buckets; ++b) first[b + 1] += first[b];
  std::vector<std::array<Index, 2>> sorted(first[buckets]), pairs;
  each([&](Index i, std::size_t e) { sorted[first[rank[e]]++] = {i, level.neighbour[e]}; });
  for (const auto& [i, j] : sorted) {
    if (taken[static_cast<std::size_t>(i)] || taken[static_cast<std::size_t>(j)]) continue;
    taken[static_cast<std::size_t>(i)] = taken[static_cast<std::size_t>(j)] = true;
    pairs.push_back({i, j});
  }
  return pairs;
}

Level coarser(Level& fine) {
  std::vector<bool> taken(fine.normal.size());
  std::vector<std::array<Index, 2>> members = pairs_of(fine, taken);
  for (Index i = 0; i < fine.size(); ++i)
    if (!taken[static_cast<std::size_t>(i)]) members.push_back({i, none});
  fine.parent.resize(fine.normal.size());
  Level level;
  level.normal.resize(members.size());
  level.area.resize(members.size());
  level.start.assign(members.size() + 1, 0);
  for (std::size_t c = 0; c < members.size(); ++c) {
    Vec sum = Vec::Zero();
    for (const Index i : members[c]) {
      if (i == none) continue;
      const auto f = static_cast<std::size_t>(i);
      fine.parent[f] = static_cast<Index>(c);
      sum += fine.area[f] * fine.normal[f];
      level.area[c] += fine.area[f];
    }
    level.normal[c] = normalised(sum);
  }
  for (std::size_t c = 0; c < members.size(); ++c) {
    const auto begin = static_cast<std::size_t>(level.start[c]);
    for (const Index i : members[c]) {
      if (i == none) continue;
      for (auto e = static_cast<std::size_t>(fine.start[std::size_t(i)]);
           e < static_cast<std::size_t>(fine.start[std::size_t(i) + 1]); ++e) {
        const Index to = fine.parent[static_cast<std::size_t>(fine.neighbour[e])];
        if (to == static_cast<Index>(c)) continue;
        std::size_t k = begin;
        while (k < level.neighbour.size() && level.neighbour[k] != to) ++k;
        if (k == level.neighbour.size()) {
          level.neighbour.push_back(to);
          level.weight.push_back(0);
        }
        level.weight[k] += fine.weight[e];
      }
    }
    level.start[c + 1] = static_cast<Index>(level.neighbour.size());
  }
  return level;
}

void colour(Level& level) {
  const auto n = static_cast<std::size_t>(level.size());
  std::vector<std::uint8_t> of(n, most_colours);
  std::array<Index, most_colours + 1> count{};
  for (std::size_t i = 0; i < n; ++i) {
    std::uint64_t used = 0;
    for (auto e = static_cast<std::size_t>(level.start[i]); e < static_cast<std::size_t>(level.start[i + 1]); ++e) {
      const std::uint8_t c = of[static_cast<std::size_t>(level.neighbour[e])];
      if (c < most_colours) used |= std::uint64_t{1} << c;
    }
    of[i] = static_cast<std::uint8_t>(std::min(std::countr_one(used), most_colours - 1));
    ++count[of[i] + 1U];
  }
  for (std::size_t c = 0; c < most_colours; ++c) count[c + 1] += count[c];
  level.colour_start.assign(count.begin(), count.end());
  level.order.resize(n);
  for (std::size_t i = 0; i < n; ++i) level.order[static_cast<std::size_t>(count[of[i]]++)] = static_cast<Index>(i);
}

/// sum + weight b, b turned by the quarter turns around its normal that fit `sum` best, or `sum` by one.
Vec joined(const Vec& sum, const Vec& normal, float total, const Vec& b, const Vec& of_b, float weight) {
  const Vec first[2] = {sum, normal.cross(sum)}, second[2] = {b, of_b.cross(b)};
  float best = -1;
  int at = 0, with = 0;
  for (int k = 0; k < 2; ++k)
    for (int l = 0; l < 2; ++l) {
      const float fit = std::abs(first[k].dot(second[l]));
      if (fit > best) {
        best = fit;
        at = k;
        with = l;
      }
    }
  const float sign = first[at].dot(second[with]) < 0 ? -1.0F : 1.0F;
  return total * first[at] + sign * weight * second[with];
}

void smooth(Level& level) {
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t c = 0; c < most_colours; ++c) {
      const std::int64_t begin = level.colour_start[c], size = level.colour_start[c + 1] - begin;
      if (size == 0) continue;
      parallel_for(
          size,
          [&](std::int64_t k) {
            const auto i = static_cast<std::size_t>(level.order[static_cast<std::size_t>(begin + k)]);
            const Vec& normal = level.normal[i];
            Vec sum = level.direction[i];
            float total = 0;
            for (auto e = static_cast<std::size_t>(level.start[i]); e < static_cast<std::size_t>(level.start[i + 1]);
                 ++e) {
              const auto j = static_cast<std::size_t>(level.neighbour[e]);
              sum = joined(sum, normal, total, level.direction[j], level.normal[j], level.weight[e]);
              sum = normalised(sum - normal * normal.dot(sum));
              total += level.weight[e];
            }
            level.direction[i] = sum;
          },
          512);
    }
}

std::vector<Vec> field_of(const Prepared& p) {
  std::vector<Level> levels{finest(p)};
  for (;;) {
    Level next = coarser(levels.back());
    const bool done = next.size() > 0.9 * levels.back().size() || next.size() < 8;
    levels.push_back(std::move(next));
    if (done) break;
  }
  for (Level& level : levels) colour(level);
  detail::Random random(1);
  for (std::size_t l = levels.size(); l-- > 0;) {
    Level& level = levels[l];
    level.direction.resize(level.normal.size());
    const bool coarsest = l + 1 == levels.size();
    for (std::size_t i = 0; i < level.direction.size(); ++i) {
      const Vec start =
          coarsest ? Vec(float(random.uniform(-1, 1)), float(random.uniform(-1, 1)), float(random.uniform(-1, 1)))
                   : levels[l + 1].direction[static_cast<std::size_t>(level.parent[i])];
      level.direction[i] = normalised(start - level.normal[i] * level.normal[i].dot(start));
    }
    smooth(level);
  }
  return std::move(levels[0].direction);
}

double singularities(const Prepared& p, const Field& field) {
  const std::vector<int> indices = face_indices(p.mesh, p.connection(), field);
  return double(std::count_if(indices.begin(), indices.end(), [](int i) { return i != 0; }));
}

void heuristic(benchmark::State& state, const Prepared& p, int threads) {
  std::vector<Vec> directions;
  perf::timed(state, threads, [&] { directions = field_of(p); });
  Positions<double> vectors(p.mesh.vertices(), 3);
  for (std::size_t i = 0; i < directions.size(); ++i)
    vectors.row(static_cast<Index>(i)) = directions[i].cast<double>().transpose();
  const auto frames = std::make_shared<const Frames>(vertex_frames(p.mesh, p.surface.V, p.geometry, p.connection()));
  state.counters["singularities"] = singularities(p, from_vectors(4, vectors, frames));
}

void exact(benchmark::State& state, const Prepared& p, int threads, Prove prove) {
  SmoothestResult result;
  perf::timed(state, threads, [&] {
    const Connection connection = globally_optimal(p.mesh, p.geometry, {.tolerance = 1e-6});
    result = smoothest_field(p.mesh, p.geometry, connection, nullptr,
                             {.n = 4, .eigen = {.angle_tolerance = 0.01, .prove_smallest = prove}});
  });
  state.counters["its"] = result.components[0].iterations;
  if (result.components[0].angle) state.counters["angle"] = *result.components[0].angle;
  state.counters["singularities"] = singularities(p, result.field);
}

void declare(const perf::Plan& plan) {
  perf::add(plan, "field", "n:4/backend:heuristic", heuristic);
  for (const Prove prove : {Prove::never, Prove::always})
    perf::add(plan, "field", prove == Prove::never ? "n:4/backend:auto" : "n:4/backend:auto+proof",
              [prove](benchmark::State& state, const Prepared& p, int threads) { exact(state, p, threads, prove); },
              {.faces = prove == Prove::never ? perf::Limits{}.faces : 400'000});
}

}  // namespace

int main(int argc, char** argv) { return perf::run(argc, argv, declare); }
