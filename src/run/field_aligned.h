// SPDX-License-Identifier: MIT
//
// field_aligned.h: a run whose field is aligned with features. Internal to run.
#pragma once

#include "alcap/field_run.h"

namespace alcap::detail {

/// The features that are asked for. Throws OptionError, also for options that do not go with alignment.
[[nodiscard]] FeatureGraph features_of(const FieldRunOptions& options, const Surface& surface);

/// The field along `graph` on `surface`; its times and, of pieces without features, nothing in run.eigen. `coarser`:
/// how many times larger triangles its zeros need to be told apart by. Throws OptionError.
void solve_aligned(const FieldRunOptions& options, const ConnectedSurface& surface, FeatureGraph graph, double coarser,
                   FieldRun& run);

/// Deviations, what the certificate says of them, and remarks, when indices and singularities are known.
void judge_aligned(const FieldRunOptions& options, FieldRun& run);

/// What is worth saying about features: `none` where there are none, free corners, edges between them.
void remark_features(const FieldFeatures& features, const char* none, std::vector<Remark>& remarks);

/// Sets `followed`, and warns where it is false.
void judge_followed(FieldFeatures& features, std::vector<Remark>& remarks);

}  // namespace alcap::detail
