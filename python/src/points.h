// SPDX-License-Identifier: MIT
//
// points.h: points of a surface as two arrays.
#pragma once

#include <vector>

#include "alcap/surface_path.h"
#include "python/src/arrays.h"

namespace alcap::python {

/// faces (k,), barycentric (k, 3).
[[nodiscard]] std::vector<SurfacePoint> points_of(const py::object& faces, const py::object& barycentric);

}  // namespace alcap::python
