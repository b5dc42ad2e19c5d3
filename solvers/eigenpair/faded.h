// SPDX-License-Identifier: MIT
//
// faded.h: the part of an eigenvector that has faded to less than what a residual sees. Internal to solvers/.
#pragma once

#include "solvers/eigenpair/problem.h"

namespace alcap::detail {

/// Where noise, bumps or necks localise an eigenvector, it fades by many orders of magnitude elsewhere. A small
/// residual says nothing of its directions there, and singularities are where rounding puts them. Solves the rows of S
/// u = lambda M u where |u| is small, once more, for given values around them: the values inside then have digits of
/// their own. Does nothing where u is large everywhere but near its zeros, where the rows are not positive definite (u
/// is not the smallest eigenvector then), and where the residual would grow.
void restore_faded(const EigenProblem& problem, const EigenOptions& options, EigenResult& result);

}  // namespace alcap::detail
