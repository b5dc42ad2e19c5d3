// SPDX-License-Identifier: MIT
//
// features.h: sharp edges, what fields were aligned with, how well they follow, and how good triangles are, as dict of
// Python.
#pragma once

#include "alcap/aligned.h"
#include "alcap/intrinsic.h"
#include "python/src/arrays.h"

namespace alcap::python {

[[nodiscard]] py::dict graph_dict(const FeatureGraph& graph);
/// Of a FeatureGraph of Python.
[[nodiscard]] FeatureGraph graph_of(const py::object& graph);

[[nodiscard]] py::list pieces_list(const std::vector<AlignedPiece>& list);
[[nodiscard]] py::dict deviations_dict(const FeatureReport& report);

[[nodiscard]] py::dict quality_dict(const TriangleQuality& quality);

/// angle, corner_angle, boundary, creases, low_angle, gap, spur.
[[nodiscard]] SharpEdgeOptions sharp_options(const py::dict& d);

}  // namespace alcap::python
