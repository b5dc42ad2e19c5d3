// SPDX-License-Identifier: MIT
//
// field_intrinsic.h: a run that is solved on an intrinsic triangulation. Internal to run.
#pragma once

#include <optional>

#include "alcap/field_run.h"

namespace alcap::detail {

/// Triangulation, connections, field, eigenvalues, features; their times but those of the connections, which are
/// returned, in seconds. Nothing, and nothing done, where lengths are too far apart for a triangulation that was not
/// asked for by name.
[[nodiscard]] std::optional<double> solve_on_intrinsic(const FieldRunOptions& options, const Surface& surface,
                                                       FieldRun& run);

}  // namespace alcap::detail
