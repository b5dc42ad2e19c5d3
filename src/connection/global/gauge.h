// SPDX-License-Identifier: MIT
//
// gauge.h: the frame of each vertex, which may be turned without a change of energy (LTGD 2016, Sec. 5.3 sets one
// rho_{v->t} per vertex to zero instead).
#pragma once

#include "alcap/geometry.h"
#include "alcap/mesh.h"
#include "src/base/array.h"

namespace alcap::detail {

/// #V: by how much the corrections `corners` (3 #F) of rho_{v->t} turn all faces around a vertex, the mean weighted by
/// their angles. Taken away, the directions of its faces turn by 0 on average, whichever way the iteration took.
[[nodiscard]] VectorX<double> mean_turns(const Mesh& mesh, const Geometry& geometry, const Array<double>& corners);

}  // namespace alcap::detail
