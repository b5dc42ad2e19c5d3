// SPDX-License-Identifier: MIT
//
// weight_range.h: which weights, strengths and lengths controls may have. Internal to design.
#pragma once

namespace alcap::detail {

/// Weights further apart leave no digits to what is lighter, and their squares would not be finite; smaller ones are
/// no numbers of full precision.
inline constexpr double least_weight = 1e-100, most_weight = 1e12;
inline constexpr const char* weight_rule = "must be in [1e-100, 1e12]";
inline constexpr const char* weight_or_zero_rule = "must be in [0, 1e12]";

[[nodiscard]] constexpr bool fit_weight(double x) { return x >= least_weight && x <= most_weight; }
[[nodiscard]] constexpr bool fit_weight_or_zero(double x) { return x >= 0 && x <= most_weight; }

}  // namespace alcap::detail
