// SPDX-License-Identifier: MIT
//
// intrinsic.cpp: flips in the order of edges until all are Delaunay, refinement in between, and the result as a
// surface.
#include "alcap/intrinsic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/base/clock.h"
#include "src/base/parallel.h"
#include "src/mesh/intrinsic_refine.h"

namespace alcap {
namespace {

constexpr double sliver_corner = pi<double> / 180;
constexpr double largest_min_angle = pi<double> / 6;

void check_intrinsic(const Surface& surface, const IntrinsicOptions& o) {
  if (!(o.min_angle >= 0 && o.min_angle <= largest_min_angle))
    throw OptionError("min_angle", o.min_angle, "must be in [0, pi/6]");
  if (!(o.max_radius >= 0) || !std::isfinite(o.max_radius))
    throw OptionError("max_radius", o.max_radius, "must be finite and not negative");
  if (!(o.most_flips >= 0 && o.most_flips <= 1e6)) throw OptionError("most_flips", o.most_flips, "must be in [0, 1e6]");
  if (!(o.most_vertices >= 0 && o.most_vertices <= 1e6))
    throw OptionError("most_vertices", o.most_vertices, "must be in [0, 1e6]");
  for (const Index e : o.keep)
    if (e < 0 || e >= surface.mesh().edges()) throw OptionError("keep", e, "there is no such edge");
}

Surface surface_of(const detail::IntrinsicMesh& work) {
  Mesh mesh(work.F(), work.vertices());
  VectorX<double> lengths(mesh.edges()), cots(mesh.halfedges()), areas(mesh.faces());
  parallel_for(mesh.halfedges(), [&](std::int64_t i) {
    const auto h = static_cast<Index>(i);
    cots[h] = work.cot(h);
    if (mesh.canonical(h)) lengths[mesh.edge(h)] = work.length(work.edge(h));
  });
  parallel_for(mesh.faces(), [&](std::int64_t t) { areas[t] = work.twice_area(static_cast<Index>(t)) / 2; });
  Geometry geometry = Geometry::from_measures(mesh, std::move(lengths), std::move(cots), std::move(areas));
  return Surface::from_geometry(std::move(mesh), std::move(geometry));
}

/// Where the first halfedges of the new mesh point, in polar angles of the given one.
VectorX<double> turns_of(const Surface& given, const Surface& now, const detail::IntrinsicMesh& work) {
  VectorX<double> turn(given.mesh().vertices());
  parallel_for(turn.size(), [&](std::int64_t i) {
    const auto v = static_cast<Index>(i);
    const Index h = now.mesh().first(v);
    // Those of a boundary vertex are as the surface has them, and start along the boundary in both.
    turn[i] = h == none || given.mesh().boundary_vertex(v)
                  ? 0.0
                  : work.direction(h) * (2 * pi<double> / given.geometry().angle_sum(v));
  });
  return turn;
}

/// The vertices along every kept edge, by walking its parts.
std::vector<std::vector<Index>> chains_of(const Surface& given, const detail::IntrinsicMesh& work,
                                          const std::vector<Index>& keep) {
  std::vector<std::vector<Index>> chains;
  if (keep.empty()) return chains;
  detail::Array<Index> slot(given.mesh().edges(), none);
  std::vector<std::vector<Index>> parts(keep.size());
  for (std::size_t k = 0; k < keep.size(); ++k) slot[keep[k]] = static_cast<Index>(k);
  for (Index e = 0; e < work.edges(); ++e)
    if (work.kept(e) != none) parts[detail::at(slot[work.kept(e)])].push_back(e);
  for (std::size_t k = 0; k < keep.size(); ++k) {
    const Index h = given.mesh().halfedge(keep[k]), end = given.mesh().tip(h);
    std::vector<Index>& chain = chains.emplace_back(1, given.mesh().tail(h));
    std::vector<Index>& left = parts[detail::at(slot[keep[k]])];
    while (chain.back() != end) {
      const Index last = chain.back();
      const auto next = std::find_if(left.begin(), left.end(), [&](Index e) {
        return work.tail(work.halfedge(e)) == last || work.tip(work.halfedge(e)) == last;
      });
      if (next == left.end()) throw Error("internal error: a kept edge was lost");
      const Index g = work.halfedge(*next);
      chain.push_back(work.tail(g) == last ? work.tip(g) : work.tail(g));
      left.erase(next);
    }
  }
  return chains;
}

}  // namespace

TriangleQuality triangle_quality(const Surface& surface) {
  const Mesh& mesh = surface.mesh();
  const Geometry& geometry = surface.geometry();
  struct Worst {
    double least = pi<double>, most = 0;
    Index slivers = 0;
  };
  const Worst worst = parallel_reduce(
      mesh.faces(), Worst{},
      [&](std::int64_t begin, std::int64_t end) {
        Worst here;
        for (std::int64_t t = begin; t < end; ++t) {
          const auto angles = geometry.angles().segment<3>(3 * t);
          here.least = std::min(here.least, angles.minCoeff());
          here.most = std::max(here.most, angles.maxCoeff());
          here.slivers += angles.minCoeff() < sliver_corner ? 1 : 0;
        }
        return here;
      },
      [](const Worst& a, const Worst& b) {
        return Worst{std::min(a.least, b.least), std::max(a.most, b.most), a.slivers + b.slivers};
      });
  struct Edges {
    double least = std::numeric_limits<double>::infinity();
    Index negative = 0;
  };
  const Edges edges = parallel_reduce(
      mesh.edges(), Edges{},
      [&](std::int64_t begin, std::int64_t end) {
        Edges here;
        for (std::int64_t e = begin; e < end; ++e) {
          const Index h = mesh.halfedge(static_cast<Index>(e)), g = mesh.twin(h);
          if (g == none) continue;
          const double a = geometry.cot(Mesh::prev(h)), b = geometry.cot(Mesh::prev(g));
          here.least = std::min(here.least, a + b);
          here.negative += detail::delaunay_cotangents(a, b) ? 0 : 1;
        }
        return here;
      },
      [](const Edges& a, const Edges& b) {
        return Edges{std::min(a.least, b.least), a.negative + b.negative};
      });
  return {.angle_min = worst.least,
          .angle_max = worst.most,
          .cotangent_min = std::isfinite(edges.least) ? edges.least : 0.0,
          .not_delaunay = edges.negative,
          .slivers = worst.slivers};
}

ComplexVectorX<double> IntrinsicTriangulation::to_given(const ComplexVectorX<double>& u, int n) const {
  if (u.size() != surface.mesh().vertices())
    throw OptionError("u", std::to_string(u.size()) + " values", "needs one per vertex of the triangulation");
  ComplexVectorX<double> out(given_vertices);
  parallel_for(given_vertices, [&](std::int64_t v) { out[v] = u[v] * std::polar(1.0, n * turn[v]); });
  return out;
}

ComplexVectorX<double> IntrinsicTriangulation::from_given(const ComplexVectorX<double>& u, int n) const {
  if (u.size() != given_vertices)
    throw OptionError("u", std::to_string(u.size()) + " values", "needs one per given vertex");
  ComplexVectorX<double> out = ComplexVectorX<double>::Zero(surface.mesh().vertices());
  parallel_for(given_vertices, [&](std::int64_t v) { out[v] = u[v] * std::polar(1.0, -n * turn[v]); });
  return out;
}

IntrinsicTriangulation intrinsic_delaunay(const Surface& surface, const IntrinsicOptions& options) {
  check_intrinsic(surface, options);
  const detail::Stopwatch watch;
  IntrinsicTriangulation out;
  out.given_vertices = surface.mesh().vertices();
  out.before = triangle_quality(surface);
  detail::IntrinsicMesh work(surface, options.keep);
  detail::DelaunayFlips flips(work, options.most_flips);
  flips.all();
  if (options.min_angle > 0) {
    detail::Refinement refinement(work, flips, options);
    refinement.run();
    out.added = work.vertices() - out.given_vertices;
    out.complete = refinement.complete();
  }
  out.flips = flips.count();
  out.complete = out.complete && flips.complete();
  for (Index e = 0; e < work.edges(); ++e) out.barred += work.fixed(e) || work.delaunay(e) ? 0 : 1;
  out.surface = surface_of(work);
  out.turn = turns_of(surface, out.surface, work);
  out.kept = chains_of(surface, work, options.keep);
  out.after = triangle_quality(out.surface);
  out.seconds = watch.seconds();
  return out;
}

}  // namespace alcap
