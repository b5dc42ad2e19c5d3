// SPDX-License-Identifier: MIT
//
// design_system.h: the linear system of a variational design over all ranks, as src/design/variational has it on one
// machine: A = 2 S + w M with the soft rows in it, and exact rows as multipliers. Internal to src/distributed.
#pragma once

#include <string>
#include <vector>

#include "src/distributed/design_loads.h"
#include "src/distributed/matrices.h"

namespace alcap::detail::distributed {

/// What a design weighs its terms with.
struct DesignTerms {
  int n = 1;
  double total_area = 0;
  double mass_weight = 0;               ///< of M in the matrix, units included
  double guidance_scale = 0;            ///< of M in the right-hand side
  double guidance_weight = 0;           ///< as given, for messages
  ComplexVectorX<double> u0 = {};       ///< at owned vertices; empty: none
  VectorX<double> vertex_weights = {};  ///< at owned vertices; empty: 1
};

struct DesignSolution {
  ComplexVectorX<double> u;  ///< at owned vertices
  int rows = 0, solves = 0, iterations = 0;
  double residual = 0;
  std::string solver;
};

/// Components that a control names.
[[nodiscard]] std::vector<char> touched_components(const Stage& stage, const std::vector<LocalControl>& controls);

/// Zero on components that neither a control nor guidance touches. Throws OptionError where nothing determines a field.
[[nodiscard]] DesignSolution solve_design(const Stage& stage, const Matrices& matrices,
                                          const std::vector<LocalControl>& controls, const DesignTerms& terms,
                                          const DistributedDesignOptions& options);

}  // namespace alcap::detail::distributed
