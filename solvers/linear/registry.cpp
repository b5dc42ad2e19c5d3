// SPDX-License-Identifier: MIT
//
// registry.cpp: the table of linear backends, and the choice among them.
#include <algorithm>
#include <string>
#include <utility>

#include "solvers/linear/automatic.h"
#include "solvers/linear/backends.h"
#include "solvers/linear/name_table.h"
#include "solvers/linear/real_systems.h"

namespace alcap {
namespace {

using C = std::complex<double>;
using detail::Ordering;

struct Backend {
  LinearSolverFactory<C> complex;
  LinearSolverFactory<double> real;  // empty: by RealSystems
};

#ifdef ALCAP_WITH_CHOLMOD
Backend cholmod(Ordering ordering) {
  return {[=](const SolverOptions& o) { return detail::make_cholmod<C>(ordering, o); },
          [=](const SolverOptions& o) { return detail::make_cholmod<double>(ordering, o); }};
}
#endif

/// One line per backend, the preferred factorisation first: see preferred_factorisation().
detail::NameTable<Backend>& backends() {
  static detail::NameTable<Backend> table({
#ifdef ALCAP_WITH_CHOLMOD
      {"cholmod", cholmod(Ordering::automatic)},
      {"cholmod-amd", cholmod(Ordering::amd)},
      {"cholmod-metis", cholmod(Ordering::metis)},
#endif
      {"eigen-ldlt", {detail::make_eigen_ldlt<C>, detail::make_eigen_ldlt<double>}},
      {"eigen-cg", {detail::make_eigen_cg<C>, detail::make_eigen_cg<double>}},
      {"multigrid", {detail::make_multigrid, {}}},
  });
  return table;
}

void validate(const SolverOptions& options) {
  if (!(options.tolerance > 0 && options.tolerance < 1)) {
    throw OptionError("tolerance", options.tolerance, "must be in (0, 1)");
  }
  if (options.max_iterations < 1) {
    throw OptionError("max_iterations", options.max_iterations, "must be at least 1");
  }
  if (options.right_hand_sides < 0) {
    throw OptionError("right_hand_sides", options.right_hand_sides, "must be at least 0");
  }
}

template <class Scalar>
std::unique_ptr<LinearSolver<Scalar>> make(const Backend& backend, const SolverOptions& options) {
  if constexpr (std::is_same_v<Scalar, C>) {
    return backend.complex(options);
  } else {
    if (backend.real) return backend.real(options);
    auto solver = backend.complex(options);
    return solver ? std::make_unique<detail::RealSystems>(std::move(solver)) : nullptr;
  }
}

}  // namespace

void detail::require_linear_solver(const char* field, const std::string& name) {
  if (name != "auto") static_cast<void>(backends().get(field, name));
}

std::vector<std::string> linear_solvers() { return backends().names(); }

std::string detail::preferred_factorisation() { return linear_solvers().front(); }

BackendRegistration register_linear_solver(std::string name, LinearSolverFactory<C> complex,
                                           LinearSolverFactory<double> real) {
  if (!complex) throw OptionError("complex", "none", "must be a function that makes solvers");
  return backends().add(name, {std::move(complex), std::move(real)});
}

template <class Scalar>
std::unique_ptr<LinearSolver<Scalar>> make_linear_solver(const SolverOptions& options) {
  if (options.name == "auto") {
    validate(options);
    return std::make_unique<detail::AutomaticSolver<Scalar>>(options);
  }
  const auto backend = backends().get("name", options.name);
  validate(options);
  auto solver = make<Scalar>(*backend, options);
  if (!solver) throw SolveError("the factory of the linear solver '" + options.name + "' made none");
  return solver;
}

template std::unique_ptr<LinearSolver<double>> make_linear_solver<double>(const SolverOptions&);
template std::unique_ptr<LinearSolver<C>> make_linear_solver<C>(const SolverOptions&);

}  // namespace alcap
