// SPDX-License-Identifier: MIT
//
// registry.cpp: the table of eigensolvers, and the choice among them.
#include <algorithm>
#include <cmath>
#include <new>
#include <string>
#include <utility>

#include "solvers/eigenpair/faded.h"
#include "solvers/eigenpair/problem.h"
#include "solvers/linear/backends.h"
#include "solvers/linear/name_table.h"

namespace alcap {
namespace {

/// One line per method. These conclude() by themselves.
detail::NameTable<EigenSolver>& methods() {
  static detail::NameTable<EigenSolver> table({
      {"lanczos", detail::smallest_lanczos},
      {"lobpcg", detail::smallest_lobpcg},
      {"inverse-iteration", detail::smallest_inverse_iteration},
      {"dense", detail::smallest_dense},
  });
  return table;
}

/// From here on the cascade beats the factorisation: at 1,000 rows in 0.4 to 0.7 of its time on tori and for
/// n = 1, but in 1.4 times its time for nine-fold eigenvalues (round spheres, n = 4), where 1,600 rows break even.
constexpr Eigen::Index multigrid_rows = 1000;
/// Where an angle is enough the cascade ends earlier: at 640 rows 0.65 (tori, smooth shapes) to 1.2 (scans) of the
/// time.
constexpr Eigen::Index multigrid_rows_by_angle = 600;

/// Several eigenpairs of so few rows: densely, in a few milliseconds.
constexpr Eigen::Index dense_modes_rows = 96;

/// What is further off than this is no field that anybody means.
constexpr double most_degrees = 10;

void validate(const EigenProblem& problem, const EigenOptions& options) {
  detail::require_square(problem.S);
  detail::require_square(problem.M);
  if (problem.S.rows() != problem.M.rows()) {
    throw SolveError("S has " + std::to_string(problem.S.rows()) + " rows and M " + std::to_string(problem.M.rows()));
  }
  if (!(problem.area > 0) || !std::isfinite(problem.area)) {
    throw OptionError("area", problem.area, "must be positive and finite");
  }
  if (options.tolerance && !(*options.tolerance > 0 && *options.tolerance < 1)) {
    throw OptionError("tolerance", *options.tolerance, "must be in (0, 1)");
  }
  if (!(options.angle_tolerance >= 0 && options.angle_tolerance <= most_degrees)) {
    throw OptionError("angle_tolerance", options.angle_tolerance, "must be in [0, 10] degrees");
  }
  if (options.degree < 1) throw OptionError("degree", options.degree, "must be at least 1");
  detail::require_linear_solver("solver", options.solver);
  if (options.max_iterations < 1) {
    throw OptionError("max_iterations", options.max_iterations, "must be at least 1");
  }
}

std::string choose(const EigenOptions& options, Eigen::Index rows) {
  if (options.method != "auto") return options.method;
  // A linear backend asked for by name is meant to be used.
  const bool cascade =
      rows >= (options.by_angle() ? multigrid_rows_by_angle : multigrid_rows) && options.solver == "auto";
  return rows <= detail::dense_eigen_rows ? "dense" : cascade ? "lobpcg" : "lanczos";
}

[[noreturn]] void throw_no_memory(const EigenOptions& options, Eigen::Index rows) {
  const char* advice =
      choose(options, rows) == "lobpcg" ? detail::more_memory : "; EigenOptions::method 'lobpcg' needs least";
  throw SolveError(std::string("eigensolver: out of memory") + advice);
}

bool own_method(const std::string& name) {
  constexpr const char* own[] = {"dense", "lanczos", "lobpcg", "inverse-iteration"};
  return std::find(std::begin(own), std::end(own), name) != std::end(own);
}

/// What an eigensolver from outside returned, made true: see alcap/backends.h.
EigenResult concluded(const std::string& name, const EigenProblem& problem, const EigenOptions& options,
                      EigenResult result) {
  if (result.u.size() != problem.S.rows()) {
    throw SolveError("the eigensolver '" + name + "' returned a vector of " + std::to_string(result.u.size()) +
                     " entries for a problem of " + std::to_string(problem.S.rows()) + " rows");
  }
  if (!result.u.allFinite() || !(result.u.squaredNorm() > 0)) {
    throw SolveError("the eigensolver '" + name + "' returned a vector of zeros or of values that are not finite");
  }
  EigenReport& report = result.report;
  if (report.solver.empty()) report.solver = name;
  if (report.next && !std::isfinite(*report.next)) report.next.reset();
  report.smallest = Smallest::not_checked;
  report.lower_bound.reset();
  const std::string said = std::exchange(report.message, "");
  detail::conclude(problem, options, result);
  report.message = said + (said.empty() || report.message.empty() ? "" : "; ") + report.message;
  return result;
}

}  // namespace

bool within_tolerance(const EigenReport& report, const EigenOptions& options) {
  const double most = options.residual_tolerance();
  if (report.residual <= most && report.energy_residual <= most) return true;
  if (!options.by_angle() || !report.angle || !(*report.angle <= options.angle_tolerance)) return false;
  return report.angle_check != AngleCheck::estimated || (report.residual <= detail::residual_with_estimate &&
                                                         report.energy_residual <= detail::residual_with_estimate);
}

std::vector<std::string> eigen_solvers() { return methods().names(); }

BackendRegistration register_eigen_solver(std::string name, EigenSolver solver) {
  if (!solver) throw OptionError("solver", "none", "must be a function that solves eigenproblems");
  const std::string known = std::move(name);
  return methods().add(known,
                       [known, solver = std::move(solver)](const EigenProblem& problem, const EigenOptions& options) {
                         EigenOptions asked = options;
                         asked.tolerance = options.residual_tolerance();
                         return concluded(known, problem, asked, solver(problem, asked));
                       });
}

namespace detail {
namespace {

/// A pair by the method asked for, with the proof and the angle.
EigenResult solve_and_check(const EigenProblem& problem, const EigenOptions& options, const EigenSolver& solve) {
  const std::string method = choose(options, problem.S.rows());
  EigenOptions planned = options;
  const auto counter = method == "lobpcg" ? plan_proof(problem, planned) : nullptr;
  EigenResult result = solve(problem, planned);
  EigenReport& report = result.report;
  const double lambda = report.lambda;
  const std::optional<double> approximate = report.next;
  if (counter && worth_proving(*counter, problem.S.rows(), report.iterations))
    planned.prove_smallest = options.prove_smallest;
  prove_smallest(problem, planned, own_method(method), result, std::nullopt, counter);
  if (planned.prove_smallest != options.prove_smallest && report.converged) report.smallest_note = proof_takes_longer;
  const bool replaced = report.lambda != lambda;
  restore_faded(problem, options, result);
  // To the nearest of all that are as smooth, unless the second eigenvalue is known to lie beyond them.
  const double scale = std::max(report.lambda, 1 / problem.area);
  double above = report.lambda + equally_smooth * scale;
  AngleCheck check = AngleCheck::of_many;
  const auto beyond = [&](double second, AngleCheck known) {
    if (!(second > above)) return;
    above = second;
    check = known;
  };
  if (report.smallest == Smallest::proven && report.next) {
    beyond(*report.next - next_accuracy * std::max(*report.next, 1 / problem.area), AngleCheck::bounded);
  } else if (approximate && !replaced) {
    beyond(*approximate, AngleCheck::estimated);
  }
  report.angle.reset();  // whatever the solver says of it
  report.angle_at_vertices.reset();
  report.angle_check = AngleCheck::unknown;
  if (report.smallest != Smallest::refuted) judge_angle(problem, options, above, check, result);
  return result;
}

/// Whether a solve ended at a small angle that the proof did not confirm.
bool too_early(const EigenOptions& options, const EigenReport& report) {
  // What rounding limits, tighter tolerances will not improve.
  return options.by_angle() && report.converged && report.message.empty() && !within_tolerance(report, options);
}

}  // namespace
}  // namespace detail

EigenResult smallest_eigenpair(const SparseMatrix<std::complex<double>>& S, const SparseMatrix<std::complex<double>>& M,
                               double area, const EigenOptions& options) {
  const detail::Stopwatch timer;
  const auto solve = methods().get("method", choose(options, S.rows()));
  EigenProblem problem{.S = S, .M = M, .area = area};
  validate(problem, options);
  if (detail::same_pattern(S, M)) problem.transport = &M;
  detail::check_cancelled(options.cancel);
  try {
    EigenResult result = detail::solve_and_check(problem, options, *solve);
    if (detail::too_early(options, result.report)) {
      EigenOptions tighter = options;
      tighter.tolerance = options.residual_tolerance();
      result = detail::solve_and_check(problem, tighter, *solve);
    }
    result.report.seconds = timer.seconds();
    return result;
  } catch (const std::bad_alloc&) {
    throw_no_memory(options, S.rows());
  }
}

EigenModes eigenpairs(const SparseMatrix<std::complex<double>>& S, const SparseMatrix<std::complex<double>>& M,
                      double area, int count, const EigenOptions& options) {
  const detail::Stopwatch timer;
  static_cast<void>(methods().get("method", choose(options, S.rows())));
  EigenProblem problem{.S = S, .M = M, .area = area};
  validate(problem, options);
  if (count < 1 || count > S.rows())
    throw OptionError("count", count, "must be in [1, " + std::to_string(S.rows()) + "], the number of rows");
  if (detail::same_pattern(S, M)) problem.transport = &M;
  std::string method = options.method;
  // A dense solve is the quickest where most eigenvalues are wanted, too.
  if (method == "auto") method = S.rows() <= std::max<Eigen::Index>(dense_modes_rows, 2 * count) ? "dense" : "lanczos";
  if (!own_method(method))
    throw OptionError("method", method, "must be one of the library's own where several eigenpairs are asked for");
  const detail::ControlScope scope(options.cancel);
  try {
    EigenModes modes = detail::find_modes(problem, options, method, count);
    modes.seconds = timer.seconds();
    return modes;
  } catch (const std::bad_alloc&) {
    throw_no_memory(options, S.rows());
  }
}

}  // namespace alcap
