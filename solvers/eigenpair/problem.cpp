// SPDX-License-Identifier: MIT
#include "solvers/eigenpair/problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/dense/hermitian.h"
#include "solvers/linear/backends.h"
#include "src/base/parallel.h"
#include "src/base/random.h"

namespace alcap::detail {
namespace {

/// Shift in units of -1/area: S - sigma M is then positive definite also when S is singular, and far smaller than the
/// smallest eigenvalue of a curved surface (about 4 pi n / area), so that it costs no convergence.
constexpr double relative_shift = 1e-3;
/// When S is a little indefinite, the shift grows by this factor, this many times.
constexpr double shift_growth = 100;
constexpr int shift_attempts = 3;
/// Of iterative backends: this part of the tolerance of the eigenvector, but nothing below what double precision gives.
constexpr double inner_tolerance = 1e-2;
constexpr double least_tolerance = 1e-13;
/// Near an upper bound of the smallest eigenvalue: this part of it below, then further and further.
constexpr double near_shifts[] = {0.02, 0.1, 0.4};
/// Of 1/area: eigenvalues below are 0 as far as the energy residual is concerned.
constexpr double energy_floor = 1e-6;

/// r^H diag(S)^-1 r / max(lambda, energy_floor / area) for |r_j|^2 = squares(j).
template <class Squares>
double energy(const EigenProblem& problem, double lambda, Squares&& squares) {
  const double sum = parallel_sum<double>(problem.S.cols(), [&](std::int64_t j) {
    const double stiffness = problem.S.coeff(static_cast<Index>(j), static_cast<Index>(j)).real();
    return stiffness > 0 ? squares(j) / stiffness : 0.0;
  });
  return sum / std::max(lambda, energy_floor / problem.area);
}

/// An upper bound of |r|_{M^-1}: conjugate gradients for M y = r, preconditioned by the diagonal, build up r^H y step
/// by step, which is the square of the norm but for what they leave of r (Hestenes and Stiefel 1952).
double inverse_mass_norm(const HermitianMatrix& M, ComplexVector r) {
  // M is at least this part of its diagonal: linear elements a half, less the more curvature their faces have.
  constexpr double least_part = 0.01;
  constexpr double enough = 0.2;  // what is left may add this part to the square
  constexpr int most_steps = 12;  // four or five are usual
  const Eigen::Index n = r.size();
  VectorX<double> inverse(n);
  parallel_for(n, [&](std::int64_t i) {
    const double own = M.coeff(static_cast<Index>(i), static_cast<Index>(i)).real();
    inverse[i] = own > 0 ? 1 / own : 0;
  });
  const auto weighted = [&] {
    return parallel_sum<double>(n, [&](std::int64_t i) { return inverse[i] * std::norm(r[i]); });
  };
  ComplexVector p = ComplexVector::Zero(n), Mp(n);
  double built = 0, left = weighted(), before = 1;
  for (int k = 0; k < most_steps && left > enough * least_part * built; ++k) {
    const double beta = k == 0 ? 0 : left / before;
    parallel_for(n, [&](std::int64_t i) { p[i] = inverse[i] * r[i] + beta * p[i]; });
    hermitian_product(M, p.data(), Mp.data());
    const double curvature = parallel_sum<double>(
        n, [&](std::int64_t i) { return p[i].real() * Mp[i].real() + p[i].imag() * Mp[i].imag(); });
    if (!(curvature > 0)) break;
    const double alpha = left / curvature;
    parallel_for(n, [&](std::int64_t i) { r[i] -= alpha * Mp[i]; });
    built += alpha * left;
    before = left;
    left = weighted();
  }
  return std::sqrt(built + left / least_part);
}

}  // namespace

PairCheck check_pair(const EigenProblem& problem, ComplexVector& u, ComplexVector& Su, ComplexVector& Mu) {
  Su.resize(u.size());
  Mu.resize(u.size());
  hermitian_product(problem.M, u.data(), Mu.data());
  const double norm = std::sqrt(u.dot(Mu).real());
  if (!(norm > 0)) {
    if (!u.allFinite() || u.isZero(0))
      throw SolveError(
          "the linear solver returned zeros or values that are not finite; try another "
          "EigenOptions::solver");
    throw_mass(problem.M);
  }
  u /= norm;
  Mu /= norm;
  hermitian_product(problem.S, u.data(), Su.data());
  PairCheck check;
  check.lambda = u.dot(Su).real() / u.dot(Mu).real();
  const auto squares = [&](std::int64_t j) { return std::norm(Su[j] - check.lambda * Mu[j]); };
  check.residual =
      std::sqrt(parallel_sum<double>(u.size(), squares)) / (std::max(check.lambda, 1 / problem.area) * Mu.norm());
  check.energy = energy(problem, check.lambda, squares);
  return check;
}

PairCheck check_distance(const EigenProblem& problem, ComplexVector& u, ComplexVector& Su, ComplexVector& Mu) {
  PairCheck check = check_pair(problem, u, Su, Mu);
  check.distance = inverse_mass_norm(problem.M, Su - check.lambda * Mu);
  return check;
}

PairCheck check_residual(const EigenProblem& problem, double lambda, const ComplexVector& r) {
  return {.lambda = lambda,
          .energy = energy(problem, lambda, [&](std::int64_t j) { return std::norm(r[j]); }),
          .distance = inverse_mass_norm(problem.M, r)};
}

double sine_tolerance(const EigenOptions& options) {
  constexpr double right_angle = 90;
  return std::sin(std::min(options.degree * options.angle_tolerance, right_angle) * pi<double> / 180);
}

void judge_angle(const EigenProblem& problem, const EigenOptions& options, double above, AngleCheck check,
                 EigenResult& result) {
  EigenReport& report = result.report;
  report.angle.reset();
  report.angle_at_vertices.reset();
  report.angle_check = AngleCheck::unknown;
  const double gap = above - report.lambda;
  if (!(gap > report.distance)) return;
  const double sine = report.distance / gap;
  const auto degrees = [&](double s) { return std::asin(std::min(1.0, s)) * 180 / pi<double> / options.degree; };
  report.angle = degrees(sine);
  report.angle_check = check;
  // |u|_M = 1. Vertices as they would move alone, and an even error of the length that the bound allows.
  constexpr double near_zero = 0.1;
  const double rms = 1 / std::sqrt(problem.area);
  ComplexVector Su(result.u.size()), Mu(result.u.size());
  hermitian_product(problem.S, result.u.data(), Su.data());
  hermitian_product(problem.M, result.u.data(), Mu.data());
  const double largest = parallel_reduce(
      std::int64_t{result.u.size()}, 0.0,
      [&](std::int64_t begin, std::int64_t end) {
        double most = 0;
        for (std::int64_t i = begin; i < end; ++i) {
          const double length = std::abs(result.u[i]);
          const double own = problem.S.coeff(static_cast<Index>(i), static_cast<Index>(i)).real();
          if (!(length >= near_zero * rms) || !(own > 0)) continue;
          most = std::max(most, (sine * rms + std::abs(Su[i] - report.lambda * Mu[i]) / own) / length);
        }
        return most;
      },
      [](double a, double b) { return std::max(a, b); });
  report.angle_at_vertices = degrees(largest);
}

PairCheck rounding_floor(const EigenProblem& problem, const ComplexVector& u, double lambda) {
  const auto absolute_product = [&u](const HermitianMatrix& A, Eigen::Index j) {
    double sum = 0;
    for (HermitianMatrix::InnerIterator it(A, j); it; ++it) sum += std::abs(it.value()) * std::abs(u[it.row()]);
    return sum;
  };
  // A handful of rounded operations on each of these terms, in the product here and in the solves before.
  constexpr double margin = 8 * std::numeric_limits<double>::epsilon();
  const auto squares = [&](std::int64_t j) {
    const double r = margin * (absolute_product(problem.S, j) + std::abs(lambda) * absolute_product(problem.M, j));
    return r * r;
  };
  ComplexVector Mu(u.size());
  hermitian_product(problem.M, u.data(), Mu.data());
  PairCheck floor{.lambda = lambda};
  floor.residual =
      std::sqrt(parallel_sum<double>(u.size(), squares)) / (std::max(lambda, 1 / problem.area) * Mu.norm());
  floor.energy = energy(problem, lambda, squares);
  return floor;
}

void conclude(const EigenProblem& problem, const EigenOptions& options, EigenResult& result) {
  EigenReport& report = result.report;
  fix_phase(result.u);
  ComplexVector Su;
  ComplexVector Mu;
  const PairCheck check = check_distance(problem, result.u, Su, Mu);
  report.lambda = check.lambda;
  report.residual = check.residual;
  report.energy_residual = check.energy;
  report.distance = check.distance;
  if (report.next) report.next = std::max(*report.next, report.lambda);
  report.converged = check.within(options.residual_tolerance());
  if (report.converged) return;
  const double many = equally_smooth * std::max(report.lambda, 1 / problem.area);
  const double gap = std::max(many, report.next.value_or(report.lambda) - report.lambda);
  report.converged = options.by_angle() && check.distance <= sine_tolerance(options) * gap;
  if (report.converged) return;
  const PairCheck floor = rounding_floor(problem, result.u, check.lambda);
  report.converged = check.residual <= std::max(floor.residual, options.residual_tolerance()) &&
                     check.energy <= std::max(floor.energy, options.residual_tolerance());
  report.message = report.converged
                       ? "the residual is limited by rounding, badly shaped triangles are the usual reason: "
                         "repair them, or take a larger EigenOptions::tolerance"
                       : not_reached;
}

void fix_phase(ComplexVector& u) {
  constexpr double as_large = 1e-6;  // entries that far apart, relatively, may change places between machines
  const double largest = u.cwiseAbs().maxCoeff();
  for (const std::complex<double>& z : u) {
    if (std::abs(z) < (1 - as_large) * largest) continue;
    u *= std::conj(z) / std::abs(z);
    return;
  }
}

ComplexVector start_vector(Eigen::Index rows, std::uint64_t seed) {
  Random random(seed);
  ComplexVector u(rows);
  for (std::complex<double>& z : u) {
    const double re = random.uniform(-1, 1);
    z = {re, random.uniform(-1, 1)};
  }
  return u;
}

std::vector<double> ritz_values(const EigenProblem& problem, const MatrixX<std::complex<double>>& Y) {
  using Dense = MatrixX<std::complex<double>>;
  Dense product(Y.rows(), Y.cols());
  const auto projected = [&](const HermitianMatrix& A) {
    for (Eigen::Index c = 0; c < Y.cols(); ++c) hermitian_product(A, Y.col(c).data(), product.col(c).data());
    return Dense(Y.adjoint() * product);
  };
  // A direction with this little of the whole is a copy plus rounding: Ritz vectors are orthonormal to about 1e-8.
  constexpr double dependent = 1e-6;
  const Dense W = orthonormal_basis(projected(problem.M), dependent);
  const VectorX<double> values = hermitian_eigenvalues(W.adjoint() * projected(problem.S) * W);
  return {values.begin(), values.end()};
}

HermitianMatrix shifted(const EigenProblem& problem, double sigma) {
  HermitianMatrix A;  // assigned: Eigen's constructors leak where memory runs out in the middle of them
  if (problem.transport == nullptr) {
    A = problem.S - sigma * problem.M;
    return A;
  }
  A = problem.S;  // the same pattern: entry by entry
  std::complex<double>* a = A.valuePtr();
  const std::complex<double>* m = problem.M.valuePtr();
  parallel_for(A.nonZeros(), [=](std::int64_t k) { a[k] -= sigma * m[k]; });
  return A;
}

ShiftInverted shift_invert(const EigenProblem& problem, const EigenOptions& options, std::optional<double> above) {
  const double inner = std::max(inner_tolerance * options.residual_tolerance(), least_tolerance);
  ShiftInverted result;
  result.solver =
      make_linear_solver<std::complex<double>>({.name = options.solver, .tolerance = inner, .cancel = options.cancel});
  if (problem.transport != nullptr) result.solver->set_transport(*problem.transport);
  std::vector<double> shifts;
  if (above && *above > 0)
    for (const double part : near_shifts) shifts.push_back((1 - part) * *above);
  for (double sigma = -relative_shift / problem.area; shifts.size() < shift_attempts + (above ? 3U : 0U);
       sigma *= shift_growth)
    shifts.push_back(sigma);
  for (std::size_t attempt = 0;; ++attempt) {
    result.sigma = shifts[attempt];
    result.A = shifted(problem, result.sigma);
    if (attempt == 0) result.solver->analyse(result.A);
    try {
      result.solver->factorise(result.A);
      return result;
    } catch (const SolveError& e) {
      if (attempt + 1 < shifts.size()) continue;
      throw SolveError(std::string(e.what()) + " (the matrix is S - sigma M with sigma = " + number_text(result.sigma) +
                       ": S must not be negative, and M positive definite)");
    }
  }
}

EigenResult smallest_dense(const EigenProblem& problem, const EigenOptions& options) {
  using Dense = MatrixX<std::complex<double>>;
  const auto pairs = generalised_eigenpairs<std::complex<double>>(Dense(problem.S), Dense(problem.M));
  if (!pairs) throw_mass(problem.M);
  EigenResult result;
  result.report.solver = "dense";
  result.u = pairs->vectors.col(0);
  if (problem.S.rows() > 1) result.report.next = pairs->values[1];
  conclude(problem, options, result);
  // All eigenvalues are known.
  EigenReport& report = result.report;
  report.smallest = Smallest::proven;
  report.lower_bound = report.lambda - (bound_margin + 4 * report.residual) * std::max(report.lambda, 1 / problem.area);
  return result;
}

}  // namespace alcap::detail
