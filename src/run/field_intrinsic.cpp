// SPDX-License-Identifier: MIT
#include "src/run/field_intrinsic.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "alcap/singularities.h"
#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/base/clock.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/run/field_aligned.h"

namespace alcap::detail {
namespace {

// One face in so many with a corner below 1 degree makes the intrinsic triangulation pay: single slivers cost nothing,
// chains of them let the connection take a hundred times the iterations.
constexpr Index faces_per_sliver = 100;

bool levi_civita(ConnectionKind kind) {
  return kind == ConnectionKind::global || kind == ConnectionKind::local || kind == ConnectionKind::polar;
}

// Circles of the refined triangulation are at most so many times that of an equilateral triangle of the mean area.
constexpr double largest_circle = 1.5;

double largest_radius(const Surface& surface) {
  const double mean = surface.geometry().total_area() / surface.mesh().faces();
  return largest_circle * std::sqrt(4 * mean / (3 * std::sqrt(3.0)));
}

/// The same features on the triangulation that kept them, in as many edges as it made of them.
FeatureGraph graph_on(const IntrinsicTriangulation& now, const FeatureGraph& given) {
  const Mesh& mesh = now.surface.mesh();
  FeatureGraph graph;
  graph.vertices = given.vertices;
  graph.vertices.resize(at(mesh.vertices()), FeatureVertex::smooth);
  std::vector<std::pair<Index, double>> edges;
  for (std::size_t k = 0; k < now.kept.size(); ++k) {
    const std::vector<Index>& chain = now.kept[k];
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
      const auto k = std::lower_bound(given.edges.begin(), given.edges.end(), e) - given.edges.begin();
      std::vector<Index> chain = now.kept[at(k)];
      if (chain.front() != here.vertices.back()) std::reverse(chain.begin(), chain.end());
      for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        here.edges.push_back(mesh.edge(chain[i], chain[i + 1]));
        here.vertices.push_back(chain[i + 1]);
      }
    }
  }
  return graph;
}

void solve_smoothest(const ConnectedSurface& there, const IntrinsicTriangulation& now, const FieldRunOptions& options,
                     FieldRun& run) {
  const SmoothestOptions smooth{.n = options.n, .s = options.s, .eigen = options.eigen};
  SmoothestResult result = smoothest_field(there, smooth);
  run.field.u = std::move(result.field.u);
  run.eigen = std::move(result.components);
  if (options.modes > 1) {
    run.modes = smoothest_modes(there, options.modes, smooth);
    MatrixX<Complex<double>> U(now.given_vertices, run.modes.U.cols());
    for (Eigen::Index k = 0; k < U.cols(); ++k) U.col(k) = now.to_given(run.modes.U.col(k), options.n);
    run.modes.U = std::move(U);
  }
  run.times.assembly = result.assembly_seconds;
  run.times.eigen = result.eigen_seconds + run.modes.seconds;
}

}  // namespace

bool wants_intrinsic(const Surface& surface, const FieldRunOptions& options) {
  if (options.triangulation == Triangulation::extrinsic) return false;
  const bool possible = levi_civita(options.connection.kind);
  if (options.triangulation == Triangulation::intrinsic) {
    if (!possible)
      throw OptionError("triangulation", "intrinsic",
                        "serves the connections global, local and polar; one with cones belongs to the mesh");
    return true;
  }
  return possible && triangle_quality(surface).slivers >= std::max<Index>(1, surface.mesh().faces() / faces_per_sliver);
}

std::optional<double> solve_on_intrinsic(const FieldRunOptions& options, const Surface& surface, FieldRun& run) {
  Stopwatch watch;
  FeatureGraph graph;
  if (options.align) graph = features_of(options, surface);
  IntrinsicTriangulation now;
  try {
    now = intrinsic_delaunay(surface, {.keep = graph.edges,
                                       .min_angle = options.min_angle,
                                       .max_radius = options.min_angle > 0 ? largest_radius(surface) : 0.0});
  } catch (const MeshError&) {
    if (options.triangulation == Triangulation::intrinsic) throw;
    return std::nullopt;
  }
  ConnectionOptions connection = options.connection;
  connection.n = options.n;
  const ConnectedSurface there = connect(now.surface, connection);
  // The global one would take as long here as this saves.
  if (connection.kind == ConnectionKind::global) connection.kind = ConnectionKind::local;
  run.surface = connect(surface, connection);
  const double seconds = watch.lap();

  report_phase("solve");
  if (options.progress) options.progress("solve");
  if (options.align) {
    // Zeros are wanted to the triangles of the mesh, not to those that only carry its needles.
    const double coarser = static_cast<double>(now.surface.mesh().vertices()) / now.given_vertices;
    solve_aligned(options, there, graph_on(now, graph), coarser, run);
    run.features->graph = std::move(graph);
    std::erase_if(run.features->free_corners, [&](Index v) { return v >= now.given_vertices; });
  } else {
    solve_smoothest(there, now, options, run);
  }
  run.field.n = options.n;
  run.field.frames = nullptr;
  const std::vector<int> indices = face_indices(there, run.field);
  run.triangulation =
      SolvedTriangulation{.before = now.before,
                          .after = now.after,
                          .flips = now.flips,
                          .added = now.added,
                          .faces = now.surface.mesh().faces(),
                          .barred = now.barred,
                          .complete = now.complete,
                          .seconds = now.seconds,
                          .connection = there.connection().report,
                          .singularities = static_cast<Index>(indices.size()) -
                                           static_cast<Index>(std::count(indices.begin(), indices.end(), 0))};
  run.field.u = now.to_given(run.field.u, options.n);
  if (surface.in_space()) run.field.frames = run.surface.frames();
  return seconds;
}

void remark_triangulation(FieldRun& run) {
  const SolvedTriangulation& t = *run.triangulation;
  run.remarks.push_back({.code = "intrinsic_triangulation",
                         .warning = false,
                         .message = "solved on an intrinsic triangulation of " + counted(t.faces, "face", "faces") +
                                    ", whose smallest corner is " + rounded_text(t.after.angle_min * 180 / pi<double>) +
                                    " degrees",
                         .count = t.flips});
  if (!t.complete)
    run.remarks.push_back({.code = "triangulation_incomplete",
                           .warning = false,
                           .message = "its refinement ended at its budget; angles below that asked for remain"});
  if (t.singularities != static_cast<Index>(run.singularities.size()))
    run.remarks.push_back({.code = "singularities_differ",
                           .warning = false,
                           .message = "on the triangulation it was solved on the field has " +
                                      counted(t.singularities, "singularity", "singularities") +
                                      "; the triangles of the mesh are too long to tell all of them",
                           .count = t.singularities});
}

}  // namespace alcap::detail
