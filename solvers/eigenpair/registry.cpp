// SPDX-License-Identifier: MIT
//
// registry.cpp: the table of eigensolvers, and the choice among them.
#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <string>

#include "solvers/eigenpair/problem.h"
#include "solvers/linear/backends.h"

namespace alcap {
namespace {

struct EigenBackend {
  const char* name;
  EigenResult (*smallest)(const detail::EigenProblem&, const EigenOptions&);
};

// One line per method.
const auto methods = std::to_array<EigenBackend>({
    {"lanczos", detail::smallest_lanczos},
    {"lobpcg", detail::smallest_lobpcg},
    {"inverse-iteration", detail::smallest_inverse_iteration},
    {"dense", detail::smallest_dense},
});

/// Up to here a dense solve is faster than one factorisation, and it has no special cases.
constexpr Eigen::Index dense_rows = 48;
/// From here on the cascade beats the factorisation: at 1,000 rows in 0.4 to 0.7 of its time on tori and for
/// n = 1, but in 1.4 times its time for nine-fold eigenvalues (round spheres, n = 4), where 1,600 rows break even.
constexpr Eigen::Index multigrid_rows = 1000;

void validate(const detail::EigenProblem& problem, const EigenOptions& options) {
  detail::require_square(problem.S);
  detail::require_square(problem.M);
  if (problem.S.rows() != problem.M.rows()) {
    throw SolveError("S has " + std::to_string(problem.S.rows()) + " rows and M " + std::to_string(problem.M.rows()));
  }
  if (!(problem.area > 0) || !std::isfinite(problem.area)) {
    throw OptionError("area", std::to_string(problem.area), "must be positive and finite");
  }
  if (!(options.tolerance > 0 && options.tolerance < 1)) {
    throw OptionError("tolerance", std::to_string(options.tolerance), "must be in (0, 1)");
  }
  detail::require_known("method", options.method, eigen_solvers());
  detail::require_known("solver", options.solver, linear_solvers());
  if (options.max_iterations < 1) {
    throw OptionError("max_iterations", std::to_string(options.max_iterations), "must be at least 1");
  }
}

const EigenBackend& choose(const EigenOptions& options, Eigen::Index rows) {
  std::string name = options.method;
  if (name == "auto") {
    // A linear backend asked for by name is meant to be used.
    const bool cascade = rows >= multigrid_rows && options.solver == "auto";
    name = rows <= dense_rows ? "dense" : cascade ? "lobpcg" : "lanczos";
  }
  // A basis of a Krylov space needs room.
  if (rows <= 2) return methods.back();
  return *std::find_if(methods.begin(), methods.end(), [&](const EigenBackend& m) { return name == m.name; });
}

}  // namespace

std::vector<std::string> eigen_solvers() {
  std::vector<std::string> names;
  for (const EigenBackend& m : methods) names.emplace_back(m.name);
  return names;
}

EigenResult smallest_eigenpair(const SparseMatrix<std::complex<double>>& S, const SparseMatrix<std::complex<double>>& M,
                               double area, const EigenOptions& options) {
  const detail::Timer timer;
  const detail::EigenProblem problem{S, M, area};
  validate(problem, options);
  detail::check_cancelled(options.cancel);
  try {
    EigenResult result = choose(options, S.rows()).smallest(problem, options);
    result.report.seconds = timer.seconds();
    return result;
  } catch (const std::bad_alloc&) {
    throw SolveError("eigensolver: out of memory");
  }
}

}  // namespace alcap
