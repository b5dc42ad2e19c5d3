// SPDX-License-Identifier: MIT
//
// faded.cpp: S u = lambda M u on the rows D where |u| is small, the values around them given. The correction d has
//   A_DD d = -(A u)_D,  A = S - lambda M.
// A_DD is positive definite if u is the smallest eigenvector and D not everything, because an eigenvalue with Dirichlet
// conditions around D is larger (Courant and Fischer). What the solve leaves of the error is a part of the largest one
// in D, and too much for entries far below: they are solved for again, with a smaller D.
#include "solvers/eigenpair/faded.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "solvers/eigenpair/patches.h"
#include "solvers/linear/backends.h"
#include "src/base/parallel.h"

namespace alcap::detail {
namespace {

using std::complex;

/// D are regions where |u| is below the first of these parts of its root mean square, and somewhere below the second,
/// which the error of a field to 0.01 degrees reaches. Around zeros of ordinary fields |u| is larger, on meshes of a
/// few million triangles. At the first, u has two digits or more.
constexpr double faded = 1e-3;
constexpr double deep = 1e-5;
/// Smaller regions are zeros: on symmetric meshes a vertex may lie at one exactly.
constexpr std::size_t least_rows = 32;
/// What an iterative solve leaves of the error, and a direct one at most; both bounds then go down by as much.
constexpr double tolerance = 1e-4;
constexpr double left_by_direct = 1e-8;
constexpr int most_rounds = 10;
/// Multigrid takes 10 to 15; where u is not the smallest eigenvector the rows may be indefinite, and it would not end.
constexpr int most_iterations = 100;
/// The distance may grow by this factor: the residual of rows around D changes by what the values inside change. What
/// the report says of angles is judged afterwards.
constexpr double growth = 2;
/// Where an angle is enough, it takes a fifth of a run's time on more rows than these, for values that no mean notices.
constexpr Eigen::Index most_rows_by_angle = 200'000;

/// The regions of small |u| that have a value below `floor`: their rows, ascending.
std::vector<Index> small_regions(const HermitianMatrix& A, const ComplexVector& u, double ceiling, double floor) {
  const auto n = static_cast<Index>(u.size());
  std::vector<char> taken(static_cast<std::size_t>(n), 0);
  std::vector<Index> region;
  for (Index seed = 0; seed < n; ++seed) {
    if (taken[static_cast<std::size_t>(seed)] || !(std::abs(u[seed]) < floor)) continue;
    taken[static_cast<std::size_t>(seed)] = 1;
    const std::size_t first = region.size();
    region.push_back(seed);
    for (std::size_t k = first; k < region.size(); ++k)
      for (HermitianMatrix::InnerIterator it(A, region[k]); it; ++it) {
        const auto j = static_cast<std::size_t>(it.row());
        if (taken[j] || !(std::abs(u[it.row()]) < ceiling)) continue;
        taken[j] = 1;
        region.push_back(static_cast<Index>(it.row()));
      }
    if (region.size() - first < least_rows) region.resize(first);
  }
  std::sort(region.begin(), region.end());
  return region;
}

struct Corrected {
  ComplexVector u;
  double left = 0;  // part of the error that is left
};

/// u with its values on `rows` corrected, or nothing where the solve does not succeed.
std::optional<Corrected> corrected_on(const std::vector<Index>& rows, const HermitianMatrix& A,
                                      const EigenProblem& problem, const EigenOptions& options,
                                      const ComplexVector& u) {
  // Row i of a Hermitian matrix is its conjugated column.
  MatrixX<complex<double>> b(static_cast<Eigen::Index>(rows.size()), 1);
  parallel_for(static_cast<std::int64_t>(rows.size()), [&](std::int64_t k) {
    complex<double> sum = 0;
    for (HermitianMatrix::InnerIterator it(A, rows[static_cast<std::size_t>(k)]); it; ++it)
      sum -= std::conj(it.value()) * u[it.row()];
    b(k, 0) = sum;
  });
  const HermitianMatrix inside = block_of(A, rows);
  MatrixX<complex<double>> x(b.rows(), 1);
  SolveReport report;
  try {
    const auto solver = make_linear_solver<complex<double>>({.name = options.solver,
                                                             .right_hand_sides = 1,
                                                             .tolerance = tolerance,
                                                             .max_iterations = most_iterations,
                                                             .cancel = options.cancel});
    HermitianMatrix transport;
    if (problem.transport != nullptr) {
      transport = block_of(*problem.transport, rows);
      solver->set_transport(transport);
    }
    solver->analyse(inside);
    solver->factorise(inside);
    report = solver->solve(b, x);
  } catch (const SolveError&) {
    return std::nullopt;  // not positive definite
  }
  if (!report.converged || !x.allFinite()) return std::nullopt;
  Corrected result{.u = u, .left = report.iterations > 0 ? tolerance : left_by_direct};
  for (std::size_t k = 0; k < rows.size(); ++k) result.u[rows[k]] += x(static_cast<Eigen::Index>(k), 0);
  return result;
}

}  // namespace

void restore_faded(const EigenProblem& problem, const EigenOptions& options, EigenResult& result) {
  EigenReport& report = result.report;
  if (!report.converged || report.smallest == Smallest::refuted) return;
  if (options.by_angle() && result.u.size() > most_rows_by_angle) return;
  const double rms = 1 / std::sqrt(problem.area);  // |u|_M = 1
  if (!(result.u.cwiseAbs().minCoeff() < deep * rms)) return;
  const double tolerance_asked = options.residual_tolerance();
  HermitianMatrix A;
  ComplexVector Su, Mu;
  double scale = rms;
  for (int round = 0; round < most_rounds; ++round) {
    const std::vector<Index> rows = small_regions(problem.S, result.u, faded * scale, deep * scale);
    if (rows.empty() || static_cast<Eigen::Index>(rows.size()) == result.u.size()) return;
    if (round == 0) A = shifted(problem, report.lambda);
    std::optional<Corrected> corrected = corrected_on(rows, A, problem, options, result.u);
    if (!corrected) return;
    const PairCheck check = check_distance(problem, corrected->u, Su, Mu);
    const bool met = report.residual <= tolerance_asked && report.energy_residual <= tolerance_asked;
    if (!(check.distance <= growth * report.distance) || (met && !check.within(tolerance_asked))) return;
    result.u = std::move(corrected->u);
    report.lambda = check.lambda;
    report.residual = check.residual;
    report.energy_residual = check.energy;
    report.distance = check.distance;
    scale *= corrected->left;
  }
}

}  // namespace alcap::detail
