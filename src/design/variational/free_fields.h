// SPDX-License-Identifier: MIT
//
// free_fields.h: of systems that leave parallel fields free: when a field counts as parallel, and what holds it.
// Internal to design and to its distributed form.
#pragma once

#include <cstddef>
#include <string>

#include "alcap/errors.h"
#include "src/base/numbers.h"

namespace alcap::detail {

/// A field whose energy is this small, relative to its size, in units of 1/area, is parallel.
inline constexpr double parallel_energy = 1e-6;
/// Inverse iterations that tell a singular system.
inline constexpr int singular_probes = 4;
/// Of the guidance weight's unit: what is added of the mass to tell which components have parallel fields.
inline constexpr double probe_lift = 1e-8;
/// Weight of guidance towards zero where directions alone are held among parallel fields: it picks their length.
inline constexpr double free_length = 1e-6;

[[noreturn]] inline void throw_undetermined(double guidance_weight, std::size_t component) {
  throw OptionError("guidance_weight", guidance_weight,
                    "the design's system is singular on component " + std::to_string(component) +
                        ": this connection has parallel fields (flat or trivial), so targets alone do not determine "
                        "one; give a guidance weight, or hold the field there");
}

[[noreturn]] inline void throw_nothing_asked() {
  throw OptionError("controls", "none", "without targets, constraints, strokes or guidance the field is zero");
}

[[noreturn]] inline void throw_above_smallest(double t, double limit) {
  throw OptionError("t", t, "must be below lambda_1, which is " + rounded_text(limit) + " here in the same units");
}

}  // namespace alcap::detail
