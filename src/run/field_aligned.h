// SPDX-License-Identifier: MIT
//
// field_aligned.h: a run whose field is aligned with features. Internal to run.
#pragma once

#include "alcap/field_run.h"

namespace alcap::detail {

/// The features and the field; its times and, of pieces without features, nothing in run.eigen. Throws OptionError.
void solve_aligned(const FieldRunOptions& options, FieldRun& run);

/// Deviations, what the certificate says of them, and remarks, when indices and singularities are known.
void judge_aligned(const FieldRunOptions& options, FieldRun& run);

}  // namespace alcap::detail
