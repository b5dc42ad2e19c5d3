// SPDX-License-Identifier: MIT
//
// connect.h: connections of a distributed mesh. Internal to src/distributed.
#pragma once

#include "src/connection/construction.h"
#include "src/distributed/components.h"

namespace alcap::detail::distributed {

/// The connection of a patch: right on core faces, on their edges and around inner vertices, as on one machine. The
/// report is that of the whole mesh. Throws OptionError.
[[nodiscard]] Connection connect(const Patch& patch, const Components& components, const DistributedOptions& options);

/// w_h of D_E on a patch (src/connection/global/energy.h), with the mean edge lengths of whole components.
class PatchWeights {
 public:
  PatchWeights(const Patch& patch, const Components& components, const GlobalOptions& options);
  [[nodiscard]] double operator()(Index h) const;

 private:
  const Patch& patch_;
  const Components& components_;
  double cap_;
  LengthFactor factor_;
  std::vector<double> per_length_;
};

/// Minimises D_T + detail D_E over all of rho from here (LTGD 2016, Sec. 5.3), all ranks together.
void optimise_together(const Patch& patch, const PatchWeights& weights, const GlobalOptions& options, Connection& c,
                       LiftedResiduals& r);

/// The same over rho_{v->t} and rho_{v->e} alone, as optimise_with_held_rotations() of construction.h.
void optimise_held_together(const Patch& patch, const Components& components, const PatchWeights& weights,
                            const GlobalOptions& options, Connection& c, LiftedResiduals& r);

/// A trivial or metric connection, as those of trivial.cpp. Throws OptionError.
[[nodiscard]] Connection connect_cones(const Patch& patch, const Components& components, const PatchWeights& weights,
                                       const DistributedOptions& options, LiftedResiduals& r);

}  // namespace alcap::detail::distributed
