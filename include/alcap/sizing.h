// SPDX-License-Identifier: MIT
//
// sizing.h: how long the edges of a remesh should be at each vertex: short where the surface or a feature bends, longer
// elsewhere, and never changing faster than asked for.
//
//   const alcap::FeatureGraph creases = alcap::sharp_edges(surface);
//   const alcap::VectorX<double> h = alcap::target_edge_lengths(surface, creases, {.error = 0.0005});
//   alcap::write_scalars(h, "h", "part.sol");   // mmgs part.mesh -sol part.sol
#pragma once

#include "alcap/sharp_edges.h"
#include "alcap/surface.h"

namespace alcap {

// Lengths are in diagonals of the box around the mesh, so that the defaults fit any unit.
/// What target_edge_lengths() aims at.
struct SizingOptions {
  double error = 0.001;     // how far the middle of an edge may be from the surface: 38 edges around a ball
  double smallest = 0.001;  // no shorter
  double largest = 0.1;     // no longer: ten edges across the box
  /// Two target lengths differ by at most this times their distance along edges; 0: one length everywhere. 0.3 is about
  /// what mesh generators use (a next element 1.3 times as long).
  double growth = 0.3;
  int rings = 1;  // curvature is the mean over so many rings of neighbours: 0 is raw
};

/// The target edge length of every vertex (#V), in the unit of V. A chord of length h of a circle of curvature k is
/// error away from it in the middle where h = 2 sqrt(error (2 / k - error)). k is the largest principal curvature by
/// magnitude, from the normal cycle (Cohen-Steiner, Morvan 2003) of all edges but `features`: creases do not count.
/// Along a feature line it is also that of the line, and no length exceeds that of the line (a third of a closed one).
/// Then lengths are cut to [smallest, largest] and to `growth`, which makes them smaller only (the largest function
/// below that grows so slowly, by Dijkstra's method). At vertices that no face uses it is `largest`. Faces may be
/// turned over. Throws OptionError for bad options, the features of another surface, and on a surface that lies in no
/// space. O(V log V).
[[nodiscard]] VectorX<double> target_edge_lengths(const Surface& surface, const FeatureGraph& features,
                                                  const SizingOptions& options = {});

}  // namespace alcap
