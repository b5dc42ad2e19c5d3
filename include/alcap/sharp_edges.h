// SPDX-License-Identifier: MIT
//
// sharp_edges.h: edges at which a surface folds, and the graph that they form: its vertices by kind, its lines.
//
//   const alcap::FeatureGraph creases = alcap::sharp_edges(surface, {.angle = 0.5});
//   for (const alcap::FeatureLine& line : creases.lines)
//     strokes.push_back(alcap::stroke_along_vertices(surface, line.vertices));
//   for (Index v = 0; v < surface.mesh().vertices(); ++v)
//     if (creases.vertices[v] == alcap::FeatureVertex::corner) { ... }
//
// Scale and position do not matter. Turning all faces over turns the sign of every angle and nothing else.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "alcap/surface.h"

namespace alcap {

/// A vertex by the feature edges that meet there.
enum class FeatureVertex : std::uint8_t {
  smooth,  ///< none
  end,     ///< one: a crease fades out here
  crease,  ///< two that go on into each other
  corner,  ///< three or more, or two that turn by at least corner_angle
};

/// A chain of feature edges from one end or corner to the next, or around a loop without either.
struct FeatureLine {
  std::vector<Index> vertices;  ///< in order, one more than edges; of a closed line the first one again at the end
  std::vector<Index> edges;     ///< edges[k] joins vertices[k] and vertices[k + 1]
  bool closed = false;          ///< the end is the start; the only vertex on the way that may be a corner
};

/// Feature edges, the vertices they meet at, and the lines they form.
struct FeatureGraph {
  std::vector<Index> edges;             ///< in ascending order
  std::vector<double> angles;           ///< of each of them: see dihedral_angle()
  std::vector<FeatureVertex> vertices;  ///< #V
  /// Every feature edge is in exactly one. First those that start at ends and corners, in the order of these vertices
  /// (the smaller number first) and their edges; then the loops without a corner, by their smallest edge, in the
  /// direction of its canonical halfedge.
  std::vector<FeatureLine> lines;
};

// Both angles default to 40 degrees. Chamfers of 45 degrees, the flattest edges that CAD models are commonly given, are
// sharp; a cylinder or circle that a tessellation cut into ten pieces or more (36 degrees) is round. On models with
// clear edges the exact value matters little: fandisk has the same 35 lines from 30 to 60 degrees.
/// Which edges are sharp, and where their lines break.
struct SharpEdgeOptions {
  double angle = 40 * pi<double> / 180;  // radians, in (0, pi]: edges whose faces turn by at least this are sharp
  double corner_angle = 40 * pi<double> / 180;  // radians, in (0, pi]: lines that turn by at least this break there
  bool boundary = true;                         // boundary edges are features too: nothing is sharper than an end
  bool creases = true;                          // false: the boundary alone
  // The rest cleans up what scans and coarse files blur. All off: on models with clear edges they change nothing, and
  // their lengths are the user's to choose.
  /// Radians, at most `angle`: edges that fold by at least this are sharp as well where they are joined, through others
  /// like them, to one that folds by `angle`. 0: off.
  double low_angle = 0;
  /// In the mesh's unit of length: an end is joined to the nearest other feature vertex that a path of edges no longer
  /// than this reaches without turning back (by corner_angle or more) from the line. 0: off.
  double gap = 0;
  /// In the mesh's unit of length: lines with an end that are shorter than this are removed, and again until there are
  /// none. 0: off.
  double spur = 0;
};

/// The angle between the normals of the two faces of edge e, in radians in [-pi, pi]: positive where the surface is
/// convex (seen from outside), negative where it is concave, 0 on a flat or boundary edge. Where the faces fold onto
/// each other (+-pi) the sign is that of the rounding. Throws OptionError when there is no such edge, and on a surface
/// that lies in no space.
[[nodiscard]] double dihedral_angle(const Surface& surface, Index e);

/// The graph of any edges, whoever found them; one that is given twice counts once. Throws OptionError for a number
/// that is not an edge, a bad angle, and on a surface that lies in no space. O(V + k log k) for k edges.
[[nodiscard]] FeatureGraph feature_graph(const Surface& surface, std::vector<Index> edges,
                                         double corner_angle = SharpEdgeOptions{}.corner_angle);

/// The same after gaps are closed and spurs removed, as `options` say: its other members but corner_angle do not count.
/// Throws OptionError for bad options as well.
[[nodiscard]] FeatureGraph feature_graph(const Surface& surface, std::vector<Index> edges,
                                         const SharpEdgeOptions& options);

/// The edges between pairs of vertices, as files of feature edges give them. Throws OptionError for a pair that no edge
/// joins.
[[nodiscard]] std::vector<Index> edges_between(const Surface& surface, const std::vector<std::array<Index, 2>>& pairs);

/// The graph of the edges whose dihedral angle is at least options.angle, up to rounding (1e-12), in absolute value,
/// and of the boundary edges if wanted; then low angles, gaps and spurs. Throws OptionError for bad options and on a
/// surface that lies in no space. O(V + F) without gaps and spurs.
[[nodiscard]] FeatureGraph sharp_edges(const Surface& surface, const SharpEdgeOptions& options = {});

}  // namespace alcap
