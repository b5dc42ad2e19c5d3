// SPDX-License-Identifier: MIT
//
// faded.h: the part of an eigenvector that has faded to less than what a residual sees. Internal to solvers/.
#pragma once

#include "solvers/eigenpair/problem.h"

namespace alcap::detail {

/// Where noise, bumps or necks localise an eigenvector, it fades by many orders of magnitude elsewhere. A small
/// residual says nothing of its directions there, and singularities are where rounding puts them. Solves the equations
/// of small values once more, for given values around them, which keep their error: what is solved for has digits of
/// its own. Does nothing where u is large everywhere but near its zeros, and stops where the equations are not positive
/// definite (u is not the smallest eigenvector then), or the distance would double or leave the tolerance.
void restore_faded(const EigenProblem& problem, const EigenOptions& options, EigenResult& result);

}  // namespace alcap::detail
