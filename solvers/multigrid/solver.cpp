// SPDX-License-Identifier: MIT
//
// solver.cpp: flexible conjugate gradients (Notay 2000) in double, preconditioned by a single precision W-cycle of
// gauge-covariant smoothed aggregation. On triangle meshes 9 to 20 iterations at any size. Where the cycles stall, on
// matrices that are no connection Laplacians, the matrix is factorised, and the report's `solver` says so.
#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <new>
#include <string>

#include "solvers/linear/backends.h"
#include "solvers/linear/stages.h"
#include "solvers/multigrid/hierarchy.h"
#include "src/base/parallel.h"

namespace alcap::detail {
namespace {

using std::complex;
using Hermitian = SparseMatrix<complex<double>>;
using Vector = ComplexVectorX<double>;

/// x^H y, real part; bitwise independent of threads.
double dot(const Vector& x, const Vector& y) {
  return parallel_sum<double>(x.size(),
                              [&](std::int64_t i) { return x[i].real() * y[i].real() + x[i].imag() * y[i].imag(); });
}

/// So many iterations must at least halve the residual; on meshes that multigrid is for they gain ten digits.
constexpr int patience = 30;
constexpr double least_progress = 0.5;

class Multigrid final : public LinearSolver<complex<double>> {
 public:
  explicit Multigrid(const SolverOptions& options) : options_(options), stages_(own_name, options.cancel) {}

  void set_transport(const Hermitian& T) override {
    transport_ = T;
    transport_.makeCompressed();
  }

  void analyse(const Hermitian& A) override {
    stages_.begin_analysis(A);
    stages_.analysed(A);
  }

  void factorise(const Hermitian& A) override {
    stages_.begin_factorisation(A);
    direct_.reset();
    try {
      A_ = A;
      A_.makeCompressed();
      const bool given = transport_.rows() != 0;
      if (given && !same_pattern(A_, transport_))
        throw SolveError("multigrid: the transport has another pattern than the matrix");
      hierarchy_.build({.S = A_}, given ? &transport_ : nullptr, options_.cancel);
    } catch (const std::bad_alloc&) {
      throw SolveError(std::string("multigrid: out of memory") + more_memory);
    }
    stages_.factorised(hierarchy_.nonzeros());
  }

  SolveReport solve(const Eigen::Ref<const MatrixX<complex<double>>>& B,
                    Eigen::Ref<MatrixX<complex<double>>> X) const override {
    const Stopwatch timer;
    SolveReport report = stages_.begin_solve<complex<double>>(B, X, own_name);
    guarded("multigrid solve", more_memory, [&] { columns(B, X, report); });
    report.converged = report.residual <= options_.tolerance;
    report.solve_seconds = timer.seconds();
    return report;
  }

  [[nodiscard]] std::string name() const override {
    const std::lock_guard<std::mutex> lock(*direct_lock_);
    return direct_ ? std::string(own_name) + ", stalled, then " + direct_->name() : own_name;
  }

 private:
  static constexpr const char* own_name = "multigrid";

  void columns(const Eigen::Ref<const MatrixX<complex<double>>>& B, Eigen::Ref<MatrixX<complex<double>>> X,
               SolveReport& report) const {
    auto workspace = hierarchy_.workspace<1>();
    for (Eigen::Index c = 0; c < B.cols(); ++c) {
      Vector x;
      auto [iterations, relative] = conjugate_gradients(B.col(c), x, workspace);
      if (relative > options_.tolerance && iterations < options_.max_iterations && A_.rows() <= factorisable_rows) {
        const LinearSolver<complex<double>>& direct = factorised();
        MatrixX<complex<double>> column(A_.rows(), 1);
        (void)direct.solve(B.col(c), column);
        x = column.col(0);
        relative = residual_of(x, B.col(c));
        report.solver = name();
      }
      X.col(c) = x;
      report.iterations = std::max(report.iterations, iterations);
      if (!(relative <= report.residual)) report.residual = relative;
    }
  }

  struct Outcome {
    int iterations;
    double relative;
  };

  Outcome conjugate_gradients(const Eigen::Ref<const Vector>& b, Vector& x, Hierarchy::Workspace& workspace) const {
    const Eigen::Index n = A_.rows();
    x.setZero(n);
    Vector r = b;
    const double norm_b = std::sqrt(dot(r, r));
    if (norm_b == 0) return {0, 0};
    Vector z(n);
    Vector p = Vector::Zero(n);
    Vector Ap = Vector::Zero(n);
    double curvature = 1;
    double relative = 1;
    double checkpoint = 1;
    int iteration = 0;
    while (iteration < options_.max_iterations) {
      check_cancelled(options_.cancel);
      if (iteration > 0 && iteration % patience == 0) {
        if (!(relative <= least_progress * checkpoint)) break;
        checkpoint = relative;
      }
      ++iteration;
      precondition(r, z, norm_b * relative, workspace);
      // The preconditioner is rounded: p is made conjugate to the last one explicitly.
      const double beta = -dot(Ap, z) / curvature;
      parallel_for(n, [&](std::int64_t i) { p[i] = z[i] + beta * p[i]; });
      hermitian_product(A_, p.data(), Ap.data());
      curvature = dot(p, Ap);
      if (!(curvature > 0))
        throw SolveError("multigrid: the matrix is not positive definite; a factorisation (the solver '" +
                         preferred_factorisation() + "') says at which column");
      const double alpha = dot(r, p) / curvature;
      parallel_for(n, [&](std::int64_t i) {
        x[i] += alpha * p[i];
        r[i] -= alpha * Ap[i];
      });
      relative = std::sqrt(dot(r, r)) / norm_b;
      if (relative > options_.tolerance) continue;
      // The recurrence drifts from the truth: recompute, and go on from there when needed.
      hermitian_product(A_, x.data(), Ap.data());
      parallel_for(n, [&](std::int64_t i) { r[i] = b[i] - Ap[i]; });
      relative = std::sqrt(dot(r, r)) / norm_b;
      if (relative <= options_.tolerance) break;
      p.setZero();
      Ap.setZero();
      curvature = 1;
    }
    return {iteration, relative};
  }

  [[nodiscard]] double residual_of(const Vector& x, const Eigen::Ref<const Vector>& b) const {
    return alcap::residual<complex<double>>(A_, MatrixX<complex<double>>(x), MatrixX<complex<double>>(b));
  }

  /// The factorisation that takes over, made when it is first needed.
  const LinearSolver<complex<double>>& factorised() const {
    const std::lock_guard<std::mutex> lock(*direct_lock_);
    if (!direct_) {
      auto direct = make_linear_solver<complex<double>>({.name = preferred_factorisation(), .cancel = options_.cancel});
      try {
        direct->analyse(A_);
        direct->factorise(A_);
      } catch (const SolveError& e) {
        std::string what = e.what();
        if (const std::size_t advice = what.find(less_than_a_factor); advice != std::string::npos)
          what.replace(advice, std::string::npos, more_memory);  // multigrid was tried
        throw SolveError("multigrid stalled, and so it was factorised: " + what);
      }
      direct_ = std::move(direct);
    }
    return *direct_;
  }

  /// z = one cycle applied to r, which is brought to unit size first so that single precision has its full range.
  void precondition(const Vector& r, Vector& z, double size, Hierarchy::Workspace& w) const {
    const double unit = 1 / size;
    auto* b = reinterpret_cast<ComplexF*>(w.b[0].data());
    const auto* x = reinterpret_cast<const ComplexF*>(w.x[0].data());
    const float* const near = hierarchy_.levels()[0].near.data();
    parallel_for(A_.rows(), [&](std::int64_t i) { b[i] = ComplexF(r[i] * (unit / double{near[i]})); });
    hierarchy_.cycle<1>(w);
    parallel_for(A_.rows(), [&](std::int64_t i) { z[i] = size / double{near[i]} * complex<double>(x[i]); });
  }

  SolverOptions options_;
  Stages stages_;
  Hermitian A_;
  Hermitian transport_;
  Hierarchy hierarchy_;
  std::unique_ptr<std::mutex> direct_lock_ = std::make_unique<std::mutex>();
  mutable std::unique_ptr<LinearSolver<complex<double>>> direct_;
};

}  // namespace

SolverPtr<complex<double>> make_multigrid(const SolverOptions& options) { return std::make_unique<Multigrid>(options); }

}  // namespace alcap::detail
