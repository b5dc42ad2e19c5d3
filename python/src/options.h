// SPDX-License-Identifier: MIT
//
// options.h: the options that several functions take, as dict of Python; and reports as dict.
#pragma once

#include "alcap/connected_surface.h"
#include "alcap/controls.h"
#include "alcap/solve.h"
#include "python/src/arrays.h"

namespace alcap::python {

/// connection, detail, length_factor, tan_cap, cones, balance_cones, generator_holonomy, loop_index, n. Unknown keys
/// throw OptionError.
[[nodiscard]] ConnectionOptions connection_of(const py::dict& d);

/// tolerance, angle_tolerance, degree, solver, method, max_iterations, seed, prove_smallest.
[[nodiscard]] EigenOptions eigen_of(const py::dict& d);

/// Of a ControlTolerances of Python.
[[nodiscard]] ControlTolerances tolerances_of(const py::object& tolerances);

[[nodiscard]] py::dict eigen_dict(const EigenReport& report);
[[nodiscard]] py::dict connection_dict(const ConnectionReport& report);
[[nodiscard]] py::dict solve_dict(const SolveReport& report);

/// (eigenvalues, U, report).
[[nodiscard]] py::tuple modes_tuple(EigenModes modes);

/// (vertex, index) pairs.
[[nodiscard]] std::vector<Cone> cones_of(const py::object& list);
[[nodiscard]] py::list cones_list(const std::vector<Cone>& cones);

}  // namespace alcap::python
