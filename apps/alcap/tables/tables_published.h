// SPDX-License-Identifier: MIT
//
// tables_published.h: the numbers of LTGD 2016, Tables I and II, NaN where the paper has none. Its spheres are compared
// with the clean ones. Its operators in Table I are edge-based; it has one polar map and does not say which center it
// uses, so both of ours are compared with it.
#pragma once

#include <cstdint>
#include <string_view>

namespace alcap::app::published {

struct Operators {
  double l2_div, l2_curl, linf_div, linf_curl, energy;
};
[[nodiscard]] Operators operators(std::string_view sphere, std::int64_t vertices, std::string_view connection,
                                  std::string_view kind);

/// The energy by the formulas of Knoeppel et al. 2013, with the polar or the optimal rho.
[[nodiscard]] double stiffness_energy(std::string_view sphere, std::int64_t vertices, std::string_view connection);

struct Euler {
  double mean, deviation;
};
[[nodiscard]] Euler euler(std::string_view surface, std::int64_t vertices, std::string_view connection,
                          std::string_view kind);

}  // namespace alcap::app::published
