// SPDX-License-Identifier: MIT
//
// eigen.h: SLEPc's eigensolvers. Internal to solvers/petsc/.
#pragma once

#include "alcap/backends.h"

namespace alcap::detail::petsc {

enum class Method { krylovschur, lobpcg, gd, jd };

[[nodiscard]] EigenResult smallest(Method method, const EigenProblem& problem, const EigenOptions& options);

}  // namespace alcap::detail::petsc
