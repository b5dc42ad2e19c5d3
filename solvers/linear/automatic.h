// SPDX-License-Identifier: MIT
//
// automatic.h: the linear backend "auto": a factorisation or multigrid, chosen when the matrix is seen. Internal to
// solvers/.
#pragma once

#include <string>
#include <type_traits>

#include "solvers/linear/backends.h"

namespace alcap::detail {

/// Where multigrid is quicker (docs/performance.md): so many right-hand sides at most, from so many rows on.
inline constexpr int few_right_hand_sides = 12;
inline constexpr Eigen::Index few_from_rows = 10'000;

template <class Scalar>
class AutomaticSolver final : public LinearSolver<Scalar> {
 public:
  explicit AutomaticSolver(const SolverOptions& options) : options_(options) {}

  void set_transport(const SparseMatrix<Scalar>& T) override {
    if (chosen_) chosen_->set_transport(T);
    // An analysis to come may choose multigrid, which uses it.
    if (few_ || T.rows() > factorisable_rows) transport_ = T;
  }

  void analyse(const SparseMatrix<Scalar>& A) override {
    SolverOptions options = options_;
    options.name = choice(A.rows());
    if (!chosen_ || options.name != name_) {
      chosen_ = make_linear_solver<Scalar>(options);
      name_ = options.name;
      if (transport_.rows() > 0) chosen_->set_transport(transport_);
    }
    chosen_->analyse(A);
  }

  void factorise(const SparseMatrix<Scalar>& A) override {
    if (!chosen_) throw SolveError("factorise() before analyse()");
    chosen_->factorise(A);
    SparseMatrix<Scalar>().swap(transport_);  // assigning an empty one would keep the memory
  }

  SolveReport solve(const Eigen::Ref<const MatrixX<Scalar>>& B, Eigen::Ref<MatrixX<Scalar>> X) const override {
    if (!chosen_) throw SolveError("solve() before factorise()");
    return chosen_->solve(B, X);
  }

  [[nodiscard]] std::optional<HalfSolution<Scalar>> half_solve(const SparseMatrix<Scalar>& B) const override {
    return chosen_ ? chosen_->half_solve(B) : std::nullopt;
  }

  [[nodiscard]] std::string name() const override { return chosen_ ? chosen_->name() : options_.name; }

 private:
  /// Real systems go through complex multigrid and gain less.
  [[nodiscard]] std::string choice(Eigen::Index rows) const {
    const bool multigrid = rows > factorisable_rows || (few_ && rows >= few_from_rows);
    return multigrid ? "multigrid" : preferred_factorisation();
  }

  SolverOptions options_;
  bool few_ = !std::is_same_v<Scalar, double> && options_.right_hand_sides > 0 &&
              options_.right_hand_sides <= few_right_hand_sides;
  std::unique_ptr<LinearSolver<Scalar>> chosen_;
  std::string name_;
  SparseMatrix<Scalar> transport_;
};

}  // namespace alcap::detail
