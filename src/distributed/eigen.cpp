// SPDX-License-Identifier: MIT
//
// eigen.cpp: one component over all ranks: block LOBPCG (Knyazev 2001) in double, preconditioned by PETSc's multigrid
// cycle. Residuals are those of the matrices, in every step.
#include "src/distributed/eigen.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/dense/ritz.h"
#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/base/clock.h"
#include "src/base/random.h"
#include "src/distributed/multigrid.h"

namespace alcap::detail::distributed {
namespace {

using Dense = MatrixX<C>;

/// S - sigma M is positive definite even where S is singular or indefinite by rounding.
constexpr double relative_shift = 1e-3;
/// Directions of the basis that carry less than this of it are rounding.
constexpr double dependent = 1e-12;
/// So many steps without a better residual: rounding is all that is left.
constexpr int patience = 25;

/// A matrix, or a preconditioner, applied to columns of this rank's rows.
class Columns {
 public:
  explicit Columns(Mat like) {
    check(MatGetLocalSize(like, &rows_, nullptr));
    PetscInt all = 0;
    check(MatGetSize(like, &all, nullptr));
    for (petsc::OwnedVec* v : {&in_, &out_})
      check(VecCreateMPIWithArray(PETSC_COMM_WORLD, 1, rows_, all, nullptr, v->out()));
  }
  [[nodiscard]] PetscInt rows() const { return rows_; }
  void multiply(Mat A, const C* x, C* y) const {
    apply(x, y, [&] { check(MatMult(A, in_.get(), out_.get())); });
  }
  void precondition(PC pc, const C* x, C* y) const {
    apply(x, y, [&] { check(PCApply(pc, in_.get(), out_.get())); });
  }

 private:
  template <class Body>
  void apply(const C* x, C* y, Body&& body) const {
    check(VecPlaceArray(in_.get(), x));
    check(VecPlaceArray(out_.get(), y));
    body();
    check(VecResetArray(in_.get()));
    check(VecResetArray(out_.get()));
  }
  PetscInt rows_ = 0;
  petsc::OwnedVec in_, out_;
};

class Together {
 public:
  Together(const petsc::OwnedMat& S, const petsc::OwnedMat& M, double area, const std::vector<Index>& numbers,
           const DistributedOptions& options)
      : S_(S.get()),
        M_(M.get()),
        area_(area),
        options_(options),
        multigrid_(shifted(), M_),
        columns_(S_),
        width_(std::min<Eigen::Index>(options.n == 1 ? 4 : 6, sum(count_of(numbers)) / 8)),
        basis_(columns_.rows(), 3 * width_),
        y_(columns_.rows()),
        z_(columns_.rows()) {
    check(PCCreate(PETSC_COMM_WORLD, pc_.out()));
    check(PCSetOperators(pc_.get(), multigrid_.matrix(), multigrid_.matrix()));
    multigrid_.configure(pc_.get());
    check(PCSetUp(pc_.get()));
    petsc::OwnedVec diagonal;
    check(MatCreateVecs(S_, diagonal.out(), nullptr));
    check(MatGetDiagonal(S_, diagonal.get()));
    const PetscScalar* value = nullptr;
    check(VecGetArrayRead(diagonal.get(), &value));
    diagonal_ = Eigen::Map<const ComplexVectorX<double>>(value, columns_.rows()).real();
    check(VecRestoreArrayRead(diagonal.get(), &value));
    start(numbers);
  }

  EigenReport run(ComplexVectorX<double>& u) {
    EigenReport report;
    report.solver = "LOBPCG, covariant multigrid of " + std::to_string(multigrid_.levels()) + " levels over PETSc";
    rotate(0);
    double best = HUGE_VAL;
    int since = 0;
    for (bool with_p = false;; ++report.iterations) {
      check_cancelled();
      residuals(report);  // into W
      const double now = std::max(report.residual, report.energy_residual);
      if (now < best) since = 0;
      best = std::min(best, now);
      if (now <= options_.tolerance || !std::isfinite(now)) break;
      if (report.iterations >= options_.max_iterations || ++since > patience) break;
      precondition();
      with_p = rotate(with_p ? 2 : 1);
    }
    u = X().col(0);
    conclude(report);
    if (width_ > 1) report.next = next_;
    return report;
  }

 private:
  using Block = Eigen::Block<Dense, Eigen::Dynamic, Eigen::Dynamic, true>;
  Block X() { return {basis_, 0, 0, basis_.rows(), width_}; }
  Block W() { return {basis_, 0, width_, basis_.rows(), width_}; }

  [[nodiscard]] petsc::OwnedMat shifted() const {
    petsc::OwnedMat A;
    check(MatDuplicate(S_, MAT_COPY_VALUES, A.out()));
    check(MatAXPY(A.get(), relative_shift / area_, M_, SAME_NONZERO_PATTERN));
    check(MatSetOption(A.get(), MAT_HERMITIAN, PETSC_TRUE));
    return A;
  }

  /// The same start however the rows are divided among ranks, smoothed by a cycle.
  void start(const std::vector<Index>& numbers) {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      Random random(options_.seed + (static_cast<std::uint64_t>(numbers[i]) << 20U));
      for (Eigen::Index k = 0; k < width_; ++k) {
        const double re = random.uniform(-1, 1);
        W()(static_cast<Eigen::Index>(i), k) = C(re, random.uniform(-1, 1));
      }
    }
    for (Eigen::Index k = 0; k < width_; ++k) {
      columns_.multiply(M_, W().col(k).data(), y_.data());
      columns_.precondition(pc_.get(), y_.data(), X().col(k).data());
    }
  }

  /// X becomes the lowest Ritz vectors of X, with 1 of X and W, with 2 of X, W and P; P the part from outside of X.
  /// Whether P is worth keeping.
  bool rotate(int blocks) {
    const Eigen::Index m = (1 + blocks) * width_;
    Ritz ritz;
    if (m > width_) unit_columns(width_, m);
    const Dense GS = gram(S_, m), GM = gram(M_, m);
    agreed([&] { ritz = rayleigh_ritz(GS, GM, width_, dependent); });
    share_from_first({reinterpret_cast<double*>(ritz.coefficients.data()), at(2 * ritz.coefficients.size())});
    const Eigen::Index found = ritz.coefficients.cols();
    if (found < width_) throw SolveError("the start vectors of the eigensolver are dependent");
    constexpr Eigen::Index tile = 512;
    Dense outside, all;
    for (Eigen::Index i = 0; i < basis_.rows(); i += tile) {
      const Eigen::Index count = std::min(tile, basis_.rows() - i);
      auto rows = basis_.middleRows(i, count);
      outside.noalias() = rows.middleCols(width_, m - width_) * ritz.coefficients.bottomRows(m - width_);
      all.noalias() = rows.leftCols(width_) * ritz.coefficients.topRows(width_);
      if (m > width_) {
        all += outside;
        rows.rightCols(width_) = outside;
      }
      rows.leftCols(width_) = all;
    }
    return m > width_;
  }

  /// Columns [begin, end) of the basis scaled to length 1, so that nothing is lost in Gram matrices.
  void unit_columns(Eigen::Index begin, Eigen::Index end) {
    std::vector<double> squares;
    for (Eigen::Index k = begin; k < end; ++k) squares.push_back(basis_.col(k).squaredNorm());
    sum_all(squares);
    for (Eigen::Index k = begin; k < end; ++k) {
      const double square = squares[at(k - begin)];
      if (square > 0) basis_.col(k) /= std::sqrt(square);
    }
  }

  /// B^H A B of the first m columns of the basis.
  Dense gram(Mat A, Eigen::Index m) {
    Dense G(m, m);
    for (Eigen::Index k = 0; k < m; ++k) {
      columns_.multiply(A, basis_.col(k).data(), y_.data());
      G.col(k).noalias() = basis_.leftCols(m).adjoint() * y_;
    }
    sum_all({reinterpret_cast<double*>(G.data()), at(2 * G.size())});
    return (G + G.adjoint()) / 2;
  }

  /// W = S X - M X diag(lambda), lambda the Rayleigh quotients; the first one's residuals.
  void residuals(EigenReport& report) {
    for (Eigen::Index k = 0; k < width_; ++k) {
      columns_.multiply(S_, X().col(k).data(), y_.data());
      columns_.multiply(M_, X().col(k).data(), z_.data());
      double products[2] = {X().col(k).dot(y_).real(), X().col(k).dot(z_).real()};
      sum_all(products);
      const double lambda = products[0] / products[1];
      W().col(k) = y_ - lambda * z_;
      if (k == 1) next_ = lambda;
      if (k > 0) continue;
      double sums[3] = {W().col(0).squaredNorm(), z_.squaredNorm(),
                        (W().col(0).cwiseAbs2().array() / diagonal_.array()).sum()};
      sum_all(sums);
      report.lambda = lambda;
      report.residual = std::sqrt(sums[0] / sums[1]) / std::max(lambda, 1 / area_);
      report.energy_residual = sums[2] / products[1] / std::max(lambda, 1e-6 / area_);
    }
  }

  void precondition() {
    for (Eigen::Index k = 0; k < width_; ++k) {
      y_ = W().col(k);
      columns_.precondition(pc_.get(), y_.data(), W().col(k).data());
    }
  }

  /// What was reached: the tolerance, or what rounding in S u and M u leaves (rounding_floor() of
  /// solvers/eigenpair/problem.h).
  void conclude(EigenReport& report) {
    report.converged = report.residual <= options_.tolerance && report.energy_residual <= options_.tolerance;
    if (report.converged) return;
    const LocalRows s(S_), m(M_);
    // Neighbours' values on other ranks count as large as the vertex's own.
    constexpr double margin = 8 * std::numeric_limits<double>::epsilon();
    const auto absolute = [&](const LocalRows& rows, Eigen::Index i) {
      double total = 0;
      for (PetscInt e = rows.own.start[i]; e < rows.own.start[i + 1]; ++e)
        total += std::abs(rows.own.value[e]) * std::abs(X()(rows.own.column[e], 0));
      for (PetscInt e = rows.other.start[i]; e < rows.other.start[i + 1]; ++e)
        total += std::abs(rows.other.value[e]) * std::abs(X()(i, 0));
      return total;
    };
    columns_.multiply(M_, X().col(0).data(), z_.data());
    double sums[4] = {0, z_.squaredNorm(), 0, X().col(0).dot(z_).real()};
    for (Eigen::Index i = 0; i < basis_.rows(); ++i) {
      const double r = margin * (absolute(s, i) + std::abs(report.lambda) * absolute(m, i));
      sums[0] += r * r;
      sums[2] += r * r / diagonal_[i];
    }
    sum_all(sums);
    const double floor = std::sqrt(sums[0] / sums[1]) / std::max(report.lambda, 1 / area_);
    const double energy_floor = sums[2] / sums[3] / std::max(report.lambda, 1e-6 / area_);
    report.converged = report.residual <= std::max(floor, options_.tolerance) &&
                       report.energy_residual <= std::max(energy_floor, options_.tolerance);
    report.message = report.converged
                         ? "the residual is limited by rounding, badly shaped triangles are the usual reason"
                         : "the residual asked for was not reached: allow a larger DistributedOptions::tolerance or "
                           "more DistributedOptions::max_iterations";
  }

  Mat S_, M_;
  double area_;
  double next_ = 0;  // the second Rayleigh quotient
  const DistributedOptions& options_;
  Multigrid multigrid_;
  Columns columns_;
  Eigen::Index width_;
  Dense basis_;  // X, W and P
  ComplexVectorX<double> y_, z_;
  VectorX<double> diagonal_;
  petsc::Owned<PC, PCDestroy> pc_;
};

}  // namespace

EigenReport smallest_together(const petsc::OwnedMat& S, const petsc::OwnedMat& M, double area,
                              const std::vector<Index>& numbers, const DistributedOptions& options,
                              ComplexVectorX<double>& u) {
  const Stopwatch watch;
  Together together(S, M, area, numbers, options);
  EigenReport report = together.run(u);
  // |u|_M = 1: the first Ritz vector has that length, to rounding.
  report.seconds = watch.seconds();
  return report;
}

}  // namespace alcap::detail::distributed
