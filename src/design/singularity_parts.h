// SPDX-License-Identifier: MIT
//
// singularity_parts.h: faces around a singularity, unfolded into its plane: how its direction is carried to another
// face, and how one of index +-k/n is made of k of index +-1/n. Internal to design.
#pragma once

#include <functional>
#include <vector>

#include "alcap/controls.h"
#include "alcap/geometry.h"

namespace alcap::detail {

/// Zeros that one control may ask for: a ring of more has no common centre.
inline constexpr int largest_count = 8;

/// How components turn from the frame of one face to that of another when the shortest strip of faces between them is
/// unfolded. Throws OptionError when none joins them.
[[nodiscard]] double carried_turn(const Mesh& mesh, const Geometry& geometry, Index from, Index to);

/// One zero of index +-1/n.
struct SingularityPart {
  Index face = none;
  Complex<double> factor = 1;  ///< its P u (Q u) over the weakest one's, in the frame of its face
};

/// The zeros of a control: one in its face, the others in the nearest faces some way apart, with fluxes that make
/// the pattern u = c / prod_l conj(z - z_l), or its conjugate for sign -1, with z_l the barycenters in the unfolded
/// plane. Throws OptionError when the component has too few faces. visited(t), if it is given, hears of every face t
/// whose neighbours are looked at.
[[nodiscard]] std::vector<SingularityPart> singularity_parts(const Mesh& mesh, const Geometry& geometry, int n,
                                                             const SingularityTarget& target,
                                                             const std::function<void(Index)>& visited = {});

/// The same target in another face: its direction is carried there, a pin goes to the barycenter.
[[nodiscard]] SingularityTarget moved(const Mesh& mesh, const Geometry& geometry, int n,
                                      const SingularityTarget& target, Index face);

}  // namespace alcap::detail
