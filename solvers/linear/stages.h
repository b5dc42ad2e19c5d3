// SPDX-License-Identifier: MIT
//
// stages.h: what linear backends share: analyse, factorise and solve come in this order, on matrices of one pattern,
// and are timed. Internal to solvers/.
#pragma once

#include <bit>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include "solvers/linear/backends.h"
#include "src/base/parallel.h"

namespace alcap::detail {

/// The size of a sparse matrix and a hash of where its entries are.
struct Pattern {
  Eigen::Index rows = 0;
  Eigen::Index nonzeros = 0;
  std::uint64_t places = 0;

  Pattern() = default;
  template <class Scalar>
  explicit Pattern(const SparseMatrix<Scalar>& A) : rows(A.rows()), nonzeros(A.nonZeros()) {
    const Index* const start = A.outerIndexPtr();
    const Index* const count = A.innerNonZeroPtr();  // null when compressed
    const Index* const row = A.innerIndexPtr();
    // A sum, so that it does not depend on threads.
    places = parallel_reduce(
        std::int64_t{A.outerSize()}, std::uint64_t{0},
        [=](std::int64_t begin, std::int64_t end) {
          std::uint64_t sum = 0;
          for (std::int64_t j = begin; j < end; ++j) {
            const Index last = count == nullptr ? start[j + 1] : start[j] + count[j];
            for (Index k = start[j]; k < last; ++k)
              sum += mixed(std::rotl(static_cast<std::uint64_t>(j), 32) + static_cast<std::uint64_t>(row[k]));
          }
          return sum;
        },
        [](std::uint64_t a, std::uint64_t b) { return a + b; });
  }

  bool operator==(const Pattern&) const = default;

 private:
  /// The finaliser of MurmurHash3 (Appleby 2011).
  static std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ (x >> 33U)) * 0xff51afd7ed558ccdU;
    x = (x ^ (x >> 33U)) * 0xc4ceb9fe1a85ec53U;
    return x ^ (x >> 33U);
  }
};

class Stages {
 public:
  /// `title` begins the messages.
  Stages(std::string title, std::function<bool()> cancel) : title_(std::move(title)), cancel_(std::move(cancel)) {}

  /// Until analysed() there is nothing to factorise.
  template <class Scalar>
  void begin_analysis(const SparseMatrix<Scalar>& A) {
    require_square(A);
    check_cancelled(cancel_);
    timer_ = {};
    pattern_ = {};
    ready_ = false;
  }
  template <class Scalar>
  void analysed(const SparseMatrix<Scalar>& A) {
    pattern_ = Pattern(A);
    report_ = {};
    report_.analyse_seconds = timer_.seconds();
  }

  /// Until factorised() there is nothing to solve with. Throws SolveError for another pattern than the one analysed.
  template <class Scalar>
  void begin_factorisation(const SparseMatrix<Scalar>& A) {
    if (pattern_.rows == 0) throw SolveError(title_ + ": factorise() before analyse()");
    if (A.rows() != A.cols() || Pattern(A) != pattern_)
      throw SolveError(title_ + ": the matrix has another pattern than the one analysed");
    check_cancelled(cancel_);
    timer_ = {};
    ready_ = false;
  }
  void factorised(std::int64_t factor_nonzeros) {
    report_.factor_nonzeros = factor_nonzeros;
    report_.factorise_seconds = timer_.seconds();
    ready_ = true;
  }

  /// The report that a solve goes on to fill in.
  template <class Scalar>
  [[nodiscard]] SolveReport begin_solve(const Eigen::Ref<const MatrixX<Scalar>>& B,
                                        const Eigen::Ref<MatrixX<Scalar>>& X, std::string solver) const {
    if (!ready_) throw SolveError(title_ + ": solve() before factorise()");
    require_sizes(B, X, rows());
    check_cancelled(cancel_);
    SolveReport report = report_;
    report.solver = std::move(solver);
    return report;
  }

  [[nodiscard]] Eigen::Index rows() const { return pattern_.rows; }
  [[nodiscard]] bool ready() const { return ready_; }
  [[nodiscard]] const std::function<bool()>& cancel() const { return cancel_; }

 private:
  std::string title_;
  std::function<bool()> cancel_;
  Stopwatch timer_;
  Pattern pattern_;
  bool ready_ = false;
  SolveReport report_;  // times of analysis and factorisation
};

}  // namespace alcap::detail
