// SPDX-License-Identifier: MIT
//
// eigen.h: the smallest eigenpair of every component. Internal to src/distributed.
#pragma once

#include "src/distributed/matrices.h"

namespace alcap::detail::distributed {

/// Values at owned vertices, |u|_M = 1 and the phase of EigenResult::u on every component, zero where no face is; the
/// components' reports. Of components whose `wanted` is 0, if it is not empty, neither.
[[nodiscard]] ComplexVectorX<double> solve_components(const Patch& patch, const Matrices& matrices,
                                                      Components& components, const DistributedOptions& options,
                                                      const std::vector<char>& wanted = {});

/// One eigenproblem over all ranks, by block LOBPCG. `numbers`: the users' of this rank's rows; `u`: their values. Of
/// the report, `next` is an upper bound of the second eigenvalue, and nothing is said of `smallest`.
[[nodiscard]] EigenReport smallest_together(const petsc::OwnedMat& S, const petsc::OwnedMat& M, double area,
                                            const std::vector<Index>& numbers, const DistributedOptions& options,
                                            ComplexVectorX<double>& u);

}  // namespace alcap::detail::distributed
