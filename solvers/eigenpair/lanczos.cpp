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
#include <vector>

#include "solvers/eigenpair/lanczos_loop.h"
#include "solvers/eigenpair/problem.h"

namespace alcap::detail {
namespace {

using std::complex;

const complex<double>* as_complex(const double* x) { return reinterpret_cast<const complex<double>*>(x); }
complex<double>* as_complex(double* x) { return reinterpret_cast<complex<double>*>(x); }

class ComplexProblem final : public LanczosProblem {
 public:
  ComplexProblem(const EigenProblem& problem, const ShiftInverted& inverse, ComplexVector start)
      : LanczosProblem(2 * problem.S.rows(), problem.area),
        problem_(problem),
        inverse_(inverse),
        Mx_(problem.S.rows(), 1),
        u_(std::move(start)) {}

  void solve(const double* Mx, double* y) const override {
    Mx_ = Eigen::Map<const ComplexVector>(as_complex(Mx), Mx_.rows()) * (2 / static_cast<double>(rows()));
    Eigen::Map<MatrixX<complex<double>>> result(as_complex(y), Mx_.rows(), 1);
    inverse_.solver->solve(Mx_, result);
  }

  void mass(const double* x, double* y) const override { hermitian_product(problem_.M, as_complex(x), as_complex(y)); }

  [[nodiscard]] double shifted_norm(const double* x) const override {
    ComplexVector Ax(u_.size());
    hermitian_product(inverse_.A, as_complex(x), Ax.data());
    return Ax.norm();
  }

  Eigen::Map<VectorX<double>> vector() override { return {reinterpret_cast<double*>(u_.data()), rows()}; }

  double check() override {
    const PairCheck check = check_pair(problem_, u_, Su_, Mu_);
    return std::max(check.residual, check.energy);
  }

  /// u = A^-1 M u with one step of iterative refinement: the error left is that of the residual's own rounding.
  int polish() override {
    MatrixX<complex<double>> x(u_.size(), 1);
    MatrixX<complex<double>> r = Mu_;
    inverse_.solver->solve(r, x);
    ComplexVector Ax(u_.size());
    hermitian_product(inverse_.A, x.data(), Ax.data());
    r = Mu_ - Ax;
    u_ = x;
    inverse_.solver->solve(r, x);
    u_ += x.col(0);
    return 2;
  }

  [[nodiscard]] ComplexVector& u() { return u_; }

 private:
  const EigenProblem& problem_;
  const ShiftInverted& inverse_;
  mutable MatrixX<complex<double>> Mx_;
  ComplexVector u_, Su_, Mu_;
};

/// The second eigenvalue from the first few Ritz vectors, u and i u counted once; nothing where there is one only.
std::optional<double> second_eigenvalue(const EigenProblem& problem, const LanczosLoop& loop) {
  const Eigen::Index k = loop.ritz().values.size();
  // Two beyond the second Ritz value, which may be a copy i u of the first.
  const Eigen::Index count = std::min<Eigen::Index>(k, k < 2 ? 1 : loop.second_place() + 2);
  MatrixX<complex<double>> Y(problem.S.rows(), count);
  loop.ritz_vectors(count, reinterpret_cast<double*>(Y.data()));
  const std::vector<double> values = ritz_values(problem, Y);
  if (values.size() < 2) return std::nullopt;
  return values[1];
}

}  // namespace

EigenResult smallest_lanczos(const EigenProblem& problem, const EigenOptions& options) {
  return smallest_lanczos_below(problem, options, std::nullopt);
}

EigenResult smallest_lanczos_below(const EigenProblem& problem, const EigenOptions& options,
                                   std::optional<double> above) {
  if (problem.S.rows() <= no_room) return smallest_dense(problem, options);
  const ShiftInverted inverse = shift_invert(problem, options, above);
  ComplexProblem real_view(problem, inverse, start_vector(problem.S.rows(), options.seed));
  static_cast<void>(real_view.check());  // throws when M is not positive definite
  const VectorX<double> start = real_view.vector();
  LanczosLoop loop(real_view, options);
  loop.run(start.data());
  EigenResult result;
  result.u = std::move(real_view.u());
  result.report.next = second_eigenvalue(problem, loop);
  result.report.iterations = loop.solves();
  result.report.solver = "shift-invert Lanczos, " + inverse.solver->name();
  conclude(problem, options, result);
  return result;
}

}  // namespace alcap::detail
