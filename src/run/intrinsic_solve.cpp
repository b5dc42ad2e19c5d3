// SPDX-License-Identifier: MIT
#include "src/run/intrinsic_solve.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "alcap/cones.h"
#include "alcap/singularities.h"
#include "alcap/solve.h"
#include "src/base/array.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"

namespace alcap::detail {
namespace {

using C = Complex<double>;

// One face in so many with a corner below 1 degree makes the intrinsic triangulation pay: single slivers cost nothing,
// chains of them let the connection take a hundred times the iterations.
constexpr Index faces_per_sliver = 100;

// Circles of the refined triangulation are at most so many times that of an equilateral triangle of the mean area.
constexpr double largest_circle = 1.5;

// Flips per edge before a run gives up. Shafts and cones of needles take 2 to 7, where they can be refined at all.
constexpr double most_flips = 20;

// Sum of the cotangents opposite an edge that does no harm if it is barred from its flip: two corners of 117 degrees.
constexpr double obtuse = -1;

// Weights of edges that the refinement's budget left obtuse: any positive one gives a definite matrix.
constexpr double least_weight = 1e-3;

double largest_radius(const Surface& surface) {
  const double mean = surface.geometry().total_area() / static_cast<double>(surface.mesh().faces());
  return largest_circle * std::sqrt(4 * mean / (3 * std::sqrt(3.0)));
}

/// Why a connection cannot be made on other triangles; null where it can.
const char* belongs_to_mesh(const ConnectionOptions& c) {
  if (!c.generator_holonomy.empty())
    return "cannot be combined with holonomies, which are prescribed along strips of the mesh's own triangles; without "
           "them "
           "the nearest possible ones are taken";
  if (c.target.rotation.size() + c.target.adjustment.size() + c.target.face_curvature.size() > 0)
    return "cannot be combined with a connection target per halfedge or face, which belongs to the mesh's own "
           "triangles; one "
           "per vertex carries over";
  return nullptr;
}

/// Loop indices in the order of the loops there.
std::vector<double> loops_there(const Surface& given, const Surface& there, const std::vector<double>& index) {
  const std::vector<Loop>&from = given.topology().loops, &to = there.topology().loops;
  if (index.size() != from.size()) return index;  // refused by the connection
  std::vector<Index> loop_of(at(given.mesh().vertices()), none);
  for (std::size_t l = 0; l < from.size(); ++l)
    for (const Index h : from[l].halfedges) loop_of[at(given.mesh().tail(h))] = static_cast<Index>(l);
  std::vector<double> out;
  for (const Loop& loop : to)
    for (const Index h : loop.halfedges) {
      const Index v = there.mesh().tail(h);
      if (v >= given.mesh().vertices()) continue;
      out.push_back(index[at(loop_of[at(v)])]);
      break;
    }
  return out;
}

}  // namespace

bool wants_intrinsic(const Surface& surface, Triangulation kind, const ConnectionOptions& connection) {
  if (kind == Triangulation::extrinsic) return false;
  const char* const reason = belongs_to_mesh(connection);
  if (kind == Triangulation::intrinsic) {
    if (reason != nullptr) throw OptionError("triangulation", "intrinsic", reason);
    return true;
  }
  return reason == nullptr &&
         triangle_quality(surface).slivers >= std::max<Index>(1, surface.mesh().faces() / faces_per_sliver);
}

namespace {

/// Refinement that its budget ended in the middle of a needle leaves worse triangles there than were given, and so do
/// flips that others bar.
bool improves(const IntrinsicTriangulation& now) {
  return now.after.angle_min >= now.before.angle_min &&
         now.after.cotangent_min >= std::min(now.before.cotangent_min, obtuse) &&
         (now.complete || now.after.slivers == 0);
}

/// Nothing where lengths are too far apart.
std::optional<IntrinsicTriangulation> attempt(const Surface& surface, const IntrinsicOptions& options) {
  try {
    return intrinsic_delaunay(surface, options);
  } catch (const MeshError&) {
    return std::nullopt;
  }
}

}  // namespace

std::optional<IntrinsicTriangulation> triangulate(const Surface& surface, Triangulation kind, double min_angle,
                                                  std::vector<Index> keep) {
  IntrinsicOptions options{.keep = std::move(keep), .min_angle = min_angle, .most_flips = most_flips};
  if (min_angle > 0) {
    options.max_radius = largest_radius(surface);
    std::optional<IntrinsicTriangulation> refined = attempt(surface, options);
    if (refined && improves(*refined)) return refined;
    options.min_angle = options.max_radius = 0;
  }
  if (kind == Triangulation::intrinsic) {
    IntrinsicTriangulation flipped = intrinsic_delaunay(surface, options);
    flipped.complete = flipped.complete && min_angle == 0;
    return flipped;
  }
  std::optional<IntrinsicTriangulation> flipped = attempt(surface, options);
  if (!flipped || !improves(*flipped)) return std::nullopt;
  flipped->complete = min_angle == 0;
  return flipped;
}

ConnectionOptions connection_there(const Surface& given, const IntrinsicTriangulation& now, ConnectionOptions options) {
  // Cones are added at vertices that the user has.
  if (options.kind == ConnectionKind::trivial && options.balance_cones) {
    options.cones = balance_cones(given, options.cones, {.n = options.n});
    options.balance_cones = false;
  }
  options.loop_index = loops_there(given, now.surface, options.loop_index);
  VectorX<double>& curvature = options.target.vertex_curvature;
  if (curvature.size() == now.given_vertices) {
    const auto size = curvature.size();
    curvature.conservativeResize(now.surface.mesh().vertices());
    curvature.tail(curvature.size() - size).setZero();
  }
  return options;
}

FeatureGraph graph_on(const IntrinsicTriangulation& now, const std::vector<Index>& kept, const FeatureGraph& given) {
  const Mesh& mesh = now.surface.mesh();
  const auto chain_of = [&](Index e) -> const std::vector<Index>& {
    return now.kept[at(std::lower_bound(kept.begin(), kept.end(), e) - kept.begin())];
  };
  FeatureGraph graph;
  graph.vertices = given.vertices;
  graph.vertices.resize(at(mesh.vertices()), FeatureVertex::smooth);
  std::vector<std::pair<Index, double>> edges;
  for (std::size_t k = 0; k < given.edges.size(); ++k) {
    const std::vector<Index>& chain = chain_of(given.edges[k]);
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
      edges.emplace_back(mesh.edge(chain[i], chain[i + 1]), given.angles[k]);
      if (i > 0) graph.vertices[at(chain[i])] = FeatureVertex::crease;
    }
  }
  std::sort(edges.begin(), edges.end());
  for (const auto& [edge, angle] : edges) {
    graph.edges.push_back(edge);
    graph.angles.push_back(angle);
  }
  for (const FeatureLine& line : given.lines) {
    FeatureLine& here = graph.lines.emplace_back();
    here.closed = line.closed;
    here.vertices.push_back(line.vertices.front());
    for (const Index e : line.edges) {
      std::vector<Index> chain = chain_of(e);
      if (chain.front() != here.vertices.back()) std::reverse(chain.begin(), chain.end());
      for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        here.edges.push_back(mesh.edge(chain[i], chain[i + 1]));
        here.vertices.push_back(chain[i + 1]);
      }
    }
  }
  return graph;
}

IntrinsicSolve::IntrinsicSolve(const Surface& given, IntrinsicTriangulation triangulation, ConnectionOptions connection)
    : triangulation_(std::move(triangulation)),
      there_(connect(triangulation_.surface, connection_there(given, triangulation_, std::move(connection)))),
      turn_(triangulation_.turn) {
  if (there_.connection().alpha.size() > 0) find_turns();
}

// A connection with cones turns edges away from where they point. The axis of a vertex is the one that its edges agree
// with best, as in vertex_frames(), only that their directions are those of the surface and not of space.
void IntrinsicSolve::find_turns() {
  const Mesh& mesh = there_.mesh();
  const Geometry& geometry = there_.geometry();
  parallel_for(turn_.size(), [&](std::int64_t i) {
    const auto v = static_cast<Index>(i);
    if (!mesh.referenced(v)) return;
    const bool boundary = mesh.boundary_vertex(v);
    const double scale = boundary ? 1.0 : 2 * pi<double> / geometry.angle_sum(v);
    C axis = 0;
    double direction = 0, before = 0;
    Index last = none;
    mesh.for_each_outgoing(v, [&](Index h) {
      const double angle = geometry.angle(h);
      axis += (before + angle) / 2 * std::polar(1.0, scale * direction - there_.connection().rho_start(mesh, h));
      direction += angle;
      before = angle;
      last = Mesh::prev(h);
    });
    const double end = boundary ? direction + pi<double> - there_.connection().rho_end(mesh, last)
                                : -there_.connection().rho_start(mesh, mesh.first(v));
    axis += before / 2 * std::polar(1.0, end);
    if (std::abs(axis) > 1e-6 * direction) turn_[i] += std::arg(axis);
  });
}

ComplexVectorX<double> IntrinsicSolve::to_given(const ComplexVectorX<double>& u, int n) const {
  ComplexVectorX<double> out(given_vertices());
  parallel_for(given_vertices(), [&](std::int64_t v) { out[v] = u[v] * std::polar(1.0, n * turn_[v]); });
  return out;
}

C IntrinsicSolve::from_given(Index v, C u, int n) const { return u * std::polar(1.0, -n * turn_[v]); }

ComplexVectorX<double> IntrinsicSolve::from_given(const ComplexVectorX<double>& u, int n) const {
  ComplexVectorX<double> out = ComplexVectorX<double>::Zero(there_.mesh().vertices());
  parallel_for(given_vertices(), [&](std::int64_t v) { out[v] = from_given(static_cast<Index>(v), u[v], n); });
  extend(out, n);
  return out;
}

VectorX<double> IntrinsicSolve::from_given(const VectorX<double>& x) const {
  ComplexVectorX<double> out = ComplexVectorX<double>::Zero(there_.mesh().vertices());
  out.head(x.size()) = x.cast<C>();
  extend(out, 0);
  return out.real().cwiseMax(x.minCoeff()).cwiseMin(x.maxCoeff());
}

// Minimises sum w |u_j - exp(-i n rho) u_i|^2 over the added vertices, w the mean of the two cotangents.
void IntrinsicSolve::extend(ComplexVectorX<double>& u, int n) const {
  const Mesh& mesh = there_.mesh();
  const Geometry& geometry = there_.geometry();
  const Index first = given_vertices(), added = mesh.vertices() - first;
  if (added == 0) return;
  std::vector<Eigen::Triplet<C, Index>> entries;
  MatrixX<C> load = MatrixX<C>::Zero(added, 1), inside(added, 1);
  for (Index e = 0; e < mesh.edges(); ++e) {
    const Index h = mesh.halfedge(e), g = mesh.twin(h);
    const double sum = geometry.cot(Mesh::prev(h)) + (g == none ? 0.0 : geometry.cot(Mesh::prev(g)));
    const double weight = std::max(sum / 2, least_weight);
    const C along = std::polar(1.0, -n * there_.connection().rho_along(mesh, h));
    const auto end = [&](Index v, Index other, C carried) {
      if (v < first) return;
      entries.emplace_back(v - first, v - first, weight);
      if (other < first)
        load(v - first, 0) += weight * carried * u[other];
      else
        entries.emplace_back(v - first, other - first, -weight * carried);
    };
    end(mesh.tip(h), mesh.tail(h), along);
    end(mesh.tail(h), mesh.tip(h), std::conj(along));
  }
  SparseMatrix<C> A(added, added);
  A.setFromTriplets(entries.begin(), entries.end());
  const auto solver = make_linear_solver<C>({.right_hand_sides = 1});
  solver->analyse(A);
  solver->factorise(A);
  (void)solver->solve(load, inside);
  u.tail(added) = inside.col(0);
}

SolvedTriangulation IntrinsicSolve::summary(const Field& field) const {
  const std::vector<int> indices = face_indices(there_, field);
  const Connection& connection = there_.connection();
  return {.before = triangulation_.before,
          .after = triangulation_.after,
          .flips = triangulation_.flips,
          .added = triangulation_.added,
          .faces = there_.mesh().faces(),
          .barred = triangulation_.barred,
          .complete = triangulation_.complete,
          .seconds = triangulation_.seconds,
          .connection = connection.report,
          .cones = connection.cones,
          .generator_holonomy = connection.generator_holonomy,
          .loop_index = connection.loop_index,
          .parallel = !connection.flat || connection.admits_parallel(field.n),
          .singularities =
              static_cast<Index>(indices.size()) - static_cast<Index>(std::count(indices.begin(), indices.end(), 0))};
}

void remark_triangulation(const SolvedTriangulation& t, std::size_t singularities, std::vector<Remark>& remarks) {
  remarks.push_back({.code = "intrinsic_triangulation",
                     .warning = false,
                     .message = "solved on an intrinsic triangulation of " + counted(t.faces, "face", "faces") +
                                ", whose smallest corner is " + rounded_text(t.after.angle_min * 180 / pi<double>) +
                                " degrees",
                     .count = t.flips});
  if (!t.complete)
    remarks.push_back(
        {.code = "triangulation_incomplete",
         .warning = false,
         .message = "it could not be refined to the angle asked for within its budget; smaller ones remain"});
  if (at(t.singularities) != singularities)
    remarks.push_back({.code = "singularities_differ",
                       .warning = false,
                       .message = "on the triangulation it was solved on the field has " +
                                  counted(t.singularities, "singularity", "singularities") +
                                  "; the triangles of the mesh are too long to tell all of them",
                       .count = t.singularities});
}

Remark own_triangles() {
  return {.code = "own_triangles",
          .warning = false,
          .message =
              "the mesh has needles, but an intrinsic triangulation did not help; solved on the mesh's own "
              "triangles, and the eigenvalue depends on them"};
}

}  // namespace alcap::detail
