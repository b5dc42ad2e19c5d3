// SPDX-License-Identifier: MIT
//
// real_systems.h: real symmetric systems for backends that only know complex Hermitian ones: with zero imaginary part.
// Internal to solvers/.
#pragma once

#include <complex>
#include <memory>
#include <string>
#include <utility>

#include "solvers/linear/backends.h"

namespace alcap::detail {

class RealSystems final : public LinearSolver<double> {
 public:
  using C = std::complex<double>;
  explicit RealSystems(std::unique_ptr<LinearSolver<C>> solver) : solver_(std::move(solver)) {}
  void set_transport(const SparseMatrix<double>& T) override { solver_->set_transport(T.cast<C>()); }
  void analyse(const SparseMatrix<double>& A) override {
    guarded(solver_->name(), more_memory, [&] { solver_->analyse(A.cast<C>()); });
  }
  void factorise(const SparseMatrix<double>& A) override {
    guarded(solver_->name(), more_memory, [&] { solver_->factorise(A.cast<C>()); });
  }
  SolveReport solve(const Eigen::Ref<const MatrixX<double>>& B, Eigen::Ref<MatrixX<double>> X) const override {
    SolveReport report;
    guarded(solver_->name() + " solve", more_memory, [&] {
      MatrixX<C> x(X.rows(), X.cols());
      report = solver_->solve(B.cast<C>(), x);
      X = x.real();
    });
    return report;
  }
  [[nodiscard]] std::string name() const override { return solver_->name(); }

 private:
  std::unique_ptr<LinearSolver<C>> solver_;
};

}  // namespace alcap::detail
