// SPDX-License-Identifier: MIT
//
// cones.h: cones of a trivial connection that sum to what topology demands, for those who know only some of them.
//
//   std::vector<alcap::Cone> cones = alcap::balance_cones(surface, {{.vertex = 12, .index = 0.25}}, {.n = 4});
//   auto connection = alcap::trivial(surface, cones, {.n = 4});
#pragma once

#include <string>
#include <vector>

#include "alcap/connection.h"
#include "alcap/geometry.h"
#include "alcap/mesh.h"

namespace alcap {

/// How cones are added.
struct BalanceOptions {
  int n = 1;                    // cones are added in steps of 1/n
  std::string solver = "auto";  // backend of the Poisson solves
};

/// The given cones, and behind them as many of index +1/n or -1/n as each component lacks to its Euler characteristic,
/// less what its boundary loops take: the turning of the boundary itself, to the next multiple of 1/n. Each is placed
/// where the Gaussian curvature that no cone accounts for yet is strongest felt: at the extremum of the potential L phi
/// = curvature - 2 pi cones - mean (conformal factor; Ben-Chen, Gotsman, Bunin 2008). Cones lie off the boundary; what
/// a component with few such vertices cannot take is left to its loops. O(cones) solves with one factorisation. Throws
/// OptionError for cones that trivial() would refuse.
[[nodiscard]] std::vector<Cone> balance_cones(const Surface& surface, const std::vector<Cone>& cones,
                                              const BalanceOptions& options = {});
[[nodiscard]] std::vector<Cone> balance_cones(const Mesh& mesh, const Geometry& geometry,
                                              const std::vector<Cone>& cones, const BalanceOptions& options = {});

}  // namespace alcap
