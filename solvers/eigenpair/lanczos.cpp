// SPDX-License-Identifier: MIT
//
// lanczos.cpp: smallest eigenpair by shift-invert Lanczos with implicit restarts (Sorensen 1992), the
// recurrence by Spectra, the linear solves by any backend.
//
// Spectra knows real symmetric operators only. The complex operator Op = (S - sigma M)^-1 M acts on the interleaved
// real view of its vectors. For a Hermitian operator and one start vector the two Lanczos processes are the same in
// exact arithmetic (all inner products are real), so the doubled spectrum of the real view costs nothing; copies i u
// that rounding brings in are removed by a complex Rayleigh-Ritz step.
#include <algorithm>
#include <cmath>
#include <vector>

#include "solvers/eigenpair/lanczos_loop.h"
#include "solvers/eigenpair/problem.h"

namespace alcap::detail {
namespace {

using Eigen::Index;
using std::complex;

/// Op in units of the area, so that Spectra's absolute thresholds see numbers near 1.
class ShiftInvert {
 public:
  using Scalar = double;
  ShiftInvert(const EigenProblem& problem, const LinearSolver<complex<double>>& solver)
      : problem_(problem), solver_(solver), Mx_(problem.M.rows(), 1) {}
  [[nodiscard]] Index rows() const { return 2 * problem_.M.rows(); }
  void perform_op(const double* x, double* y) const {
    hermitian_product(problem_.M, reinterpret_cast<const complex<double>*>(x), Mx_.data());
    Mx_ /= problem_.area;
    Eigen::Map<MatrixX<complex<double>>> result(reinterpret_cast<complex<double>*>(y), Mx_.rows(), 1);
    solver_.solve(Mx_, result);
  }

 private:
  const EigenProblem& problem_;
  const LinearSolver<complex<double>>& solver_;
  mutable MatrixX<complex<double>> Mx_;
};

/// Inner product: M in units of its mean row sum.
class Mass {
 public:
  using Scalar = double;
  explicit Mass(const EigenProblem& problem)
      : M_(problem.M), scale_(static_cast<double>(problem.M.rows()) / problem.area) {}
  [[nodiscard]] Index rows() const { return 2 * M_.rows(); }
  void perform_op(const double* x, double* y) const {
    hermitian_product(M_, reinterpret_cast<const complex<double>*>(x), reinterpret_cast<complex<double>*>(y));
    Eigen::Map<VectorX<double>>(y, rows()) *= scale_;
  }

 private:
  const HermitianMatrix& M_;
  double scale_;
};

using Operators = Spectra::ArnoldiOp<double, ShiftInvert, Mass>;

using Recurrence = LanczosRecurrence<Operators>;

/// See lanczos_loop.h.
class Iterated {
 public:
  ComplexVector u;

  Iterated(const EigenProblem& problem, const ShiftInverted& inverse)
      : problem_(problem), inverse_(inverse), rows_(problem.S.rows()) {}

  /// But for |M y|, for which the guess is that of a uniform vector.
  [[nodiscard]] double estimate(const Recurrence& basis, const RitzPairs& ritz) const {
    const Index k = ritz.values.size();
    const double theta = ritz.values[k - 1];
    ComplexVector r(rows_);
    hermitian_product(inverse_.A, reinterpret_cast<const complex<double>*>(basis.vector_f().data()), r.data());
    // Basis vectors have y^H M y = area / rows: see Mass. Eigenvalues are theta = 1 / (area (lambda - sigma)).
    const double uniform = problem_.area / static_cast<double>(rows_);
    const double scale = std::max(1 / theta, 1.0) / problem_.area;
    return r.norm() * std::abs(ritz.vectors(k - 1, k - 1)) / (theta * scale * uniform);
  }

  void form(const Recurrence& basis, const RitzPairs& ritz) {
    const Index k = ritz.values.size();
    u.resize(rows_);
    Eigen::Map<VectorX<double>>(reinterpret_cast<double*>(u.data()), 2 * rows_).noalias() =
        basis.matrix_V().leftCols(k) * ritz.vectors.col(k - 1);
  }

  double check() { return check_pair(problem_, u, Su_, Mu_).residual; }

  /// With a refined solve: its error is that of the residual's own rounding.
  void polish(Index& solves) {
    MatrixX<complex<double>> x(rows_, 1);
    MatrixX<complex<double>> r = Mu_;
    inverse_.solver->solve(r, x);
    ComplexVector Ax(rows_);
    hermitian_product(inverse_.A, x.data(), Ax.data());
    r = Mu_ - Ax;
    u = x;
    inverse_.solver->solve(r, x);
    u += x.col(0);
    solves += 2;
  }

  /// The second eigenvalue from the first few Ritz vectors, u and i u counted once.
  [[nodiscard]] double second(const Recurrence& basis, const RitzPairs& ritz) const {
    const Index k = ritz.values.size();
    const Index count = std::min<Index>(k, k < 2 ? 1 : second_place(ritz) + 2);
    MatrixX<complex<double>> Y(rows_, count);
    Eigen::Map<MatrixX<double>>(reinterpret_cast<double*>(Y.data()), 2 * rows_, count).noalias() =
        basis.matrix_V().leftCols(k) * ritz.vectors.rightCols(count);
    const std::vector<double> values = ritz_values(problem_, Y);
    return values[std::min<std::size_t>(1, values.size() - 1)];
  }

 private:
  const EigenProblem& problem_;
  const ShiftInverted& inverse_;
  Index rows_;
  ComplexVector Su_, Mu_;
};

}  // namespace

EigenResult smallest_lanczos(const EigenProblem& problem, const EigenOptions& options) {
  const ShiftInverted inverse = shift_invert(problem, options);
  const Index rows = problem.S.rows(), size = std::min<Index>(basis_size, 2 * rows - 1);
  const ShiftInvert op(problem, *inverse.solver);
  const Mass mass(problem);
  Recurrence basis(Operators(op, mass), size);
  Iterated pair(problem, inverse);
  pair.u = start_vector(rows, options.seed);
  static_cast<void>(pair.check());  // throws when M is not positive definite
  const ComplexVector start = pair.u;
  LanczosLoop loop(pair, basis, options);
  const RitzPairs ritz = loop.run({reinterpret_cast<const double*>(start.data()), 2 * rows}, size);
  EigenResult result;
  result.u = std::move(pair.u);
  result.report.next = pair.second(basis, ritz);
  result.report.iterations = loop.solves();
  result.report.solver = "shift-invert Lanczos, " + inverse.solver->name();
  conclude(problem, options, result);
  return result;
}

}  // namespace alcap::detail
