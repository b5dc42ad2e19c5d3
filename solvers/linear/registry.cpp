// SPDX-License-Identifier: MIT
//
// registry.cpp: the table of linear backends, and the choice among them.
#include <algorithm>
#include <array>
#include <string>

#include "solvers/linear/automatic.h"
#include "solvers/linear/backends.h"

namespace alcap {
namespace {

using detail::SolverPtr;
using std::complex;

struct Backend {
  const char* name;
  SolverPtr<double> (*real)(const SolverOptions&);
  SolverPtr<complex<double>> (*hermitian)(const SolverOptions&);
};

// One line per backend, the preferred factorisation first: "auto" takes it where it does not take "multigrid".
const auto backends = std::to_array<Backend>({
#ifdef ALCAP_WITH_CHOLMOD
    {"cholmod", [](const SolverOptions& o) { return detail::make_cholmod<double>(detail::Ordering::automatic, o); },
     [](const SolverOptions& o) { return detail::make_cholmod<complex<double>>(detail::Ordering::automatic, o); }},
    {"cholmod-amd", [](const SolverOptions& o) { return detail::make_cholmod<double>(detail::Ordering::amd, o); },
     [](const SolverOptions& o) { return detail::make_cholmod<complex<double>>(detail::Ordering::amd, o); }},
    {"cholmod-metis", [](const SolverOptions& o) { return detail::make_cholmod<double>(detail::Ordering::metis, o); },
     [](const SolverOptions& o) { return detail::make_cholmod<complex<double>>(detail::Ordering::metis, o); }},
#endif
    {"eigen-ldlt", [](const SolverOptions& o) { return detail::make_eigen_ldlt<double>(o); },
     [](const SolverOptions& o) { return detail::make_eigen_ldlt<complex<double>>(o); }},
    {"eigen-cg", [](const SolverOptions& o) { return detail::make_eigen_cg<double>(o); },
     [](const SolverOptions& o) { return detail::make_eigen_cg<complex<double>>(o); }},
    {"multigrid", [](const SolverOptions& o) { return detail::make_multigrid<double>(o); },
     [](const SolverOptions& o) { return detail::make_multigrid<complex<double>>(o); }},
});

void validate(const SolverOptions& options) {
  detail::require_known("name", options.name, linear_solvers());
  if (!(options.tolerance > 0 && options.tolerance < 1)) {
    throw OptionError("tolerance", std::to_string(options.tolerance), "must be in (0, 1)");
  }
  if (options.max_iterations < 1) {
    throw OptionError("max_iterations", std::to_string(options.max_iterations), "must be at least 1");
  }
  if (options.right_hand_sides < 0) {
    throw OptionError("right_hand_sides", std::to_string(options.right_hand_sides), "must be at least 0");
  }
}

}  // namespace

void detail::require_known(const char* field, const std::string& name, const std::vector<std::string>& known) {
  if (name == "auto" || std::find(known.begin(), known.end(), name) != known.end()) return;
  std::string list = "unknown; there are auto";
  for (const std::string& k : known) list += ", " + k;
  throw OptionError(field, "'" + name + "'", list);
}

std::vector<std::string> linear_solvers() {
  std::vector<std::string> names;
  for (const Backend& b : backends) names.emplace_back(b.name);
  return names;
}

template <class Scalar>
std::unique_ptr<LinearSolver<Scalar>> make_linear_solver(const SolverOptions& options) {
  validate(options);
  if (options.name == "auto") return std::make_unique<detail::AutomaticSolver<Scalar>>(options);
  const auto chosen =
      std::find_if(backends.begin(), backends.end(), [&](const Backend& b) { return options.name == b.name; });
  if constexpr (std::is_same_v<Scalar, double>) {
    return chosen->real(options);
  } else {
    return chosen->hermitian(options);
  }
}

template std::unique_ptr<LinearSolver<double>> make_linear_solver<double>(const SolverOptions&);
template std::unique_ptr<LinearSolver<complex<double>>> make_linear_solver<complex<double>>(const SolverOptions&);

}  // namespace alcap
