// SPDX-License-Identifier: MIT
//
// singularity_array.h: singularities as a structured array: face, barycentric, index, orientation, located.
#pragma once

#include <vector>

#include "alcap/singularities.h"
#include "python/src/arrays.h"

namespace alcap::python {

[[nodiscard]] py::array singularity_array(std::vector<Singularity> list);
[[nodiscard]] std::vector<Singularity> singularities_of(const py::object& array);

}  // namespace alcap::python
