// SPDX-License-Identifier: MIT
//
// modes.cpp: the smallest eigenpairs: Lanczos (1950) for (S - sigma M)^-1 M with full orthogonalisation, thick restarts
// (Wu and Simon 2000) and locking, or subspace iteration. One start vector sees one vector of a multiple eigenvalue;
// the others are found by further searches, orthogonal to what is locked, until inertia says that none is missing.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "solvers/dense/hermitian.h"
#include "solvers/dense/ritz.h"
#include "solvers/eigenpair/problem.h"
#include "solvers/eigenpair/proof.h"
#include "solvers/linear/backends.h"
#include "src/base/numbers.h"

namespace alcap {
namespace detail {
namespace {

using std::complex;
using Dense = MatrixX<complex<double>>;

/// Eigenvalues this close, relative to max(lambda, 1/area), make a cluster.
constexpr double cluster_width = 1e-6;
/// Basis vectors beyond those wanted, and at least; after a restart half of them stay.
constexpr Eigen::Index basis_beyond = 20, smallest_basis = 30;
/// Directions that carry less than this of the block are rounding of double precision.
constexpr double dependent_modes = 1e-14;
/// A new basis vector with less than this left of it is in the span already.
constexpr double exhausted = 1e-12;
/// Searches for eigenvalues that are missing.
constexpr int most_searches = 12;
/// Steps of subspace iteration on vectors whose Ritz estimates promised too much.
constexpr int most_polishes = 5;
/// Without a proof: this many more are looked for behind the ones found, orthogonal to them.
constexpr Eigen::Index guard = 1;

class Modes {
 public:
  Modes(const EigenProblem& problem, const EigenOptions& options, Eigen::Index wanted)
      : problem_(problem), options_(options), rows_(problem.S.rows()), wanted_(wanted) {}

  EigenModes run(const std::string& method) {
    EigenModes result;
    if (method == "dense") {
      densely(result);
    } else {
      EigenOptions inner = options_;
      if (method == "lobpcg") inner.solver = "multigrid";
      inverse_ = shift_invert(problem_, inner);
      const bool subspace = method == "inverse-iteration";
      result.solver =
          std::string(subspace ? "subspace iteration, " : "shift-invert Lanczos, ") + inverse_.solver->name();
      if (subspace) {
        iterate_subspace();
        prove(result);
      } else {
        search_all(result);
      }
    }
    conclude(result);
    return result;
  }

 private:
  [[nodiscard]] double scale(double lambda) const { return std::max(std::abs(lambda), 1 / problem_.area); }

  [[nodiscard]] Dense times(const HermitianMatrix& A, const Dense& X) const {
    Dense product(rows_, X.cols());
    for (Eigen::Index c = 0; c < X.cols(); ++c) hermitian_product(A, X.col(c).data(), product.col(c).data());
    return product;
  }

  void densely(EigenModes& result) {
    auto pairs = generalised_eigenpairs<complex<double>>(Dense(problem_.S), Dense(problem_.M));
    if (!pairs) throw_mass(problem_.M);
    X_ = pairs->vectors.leftCols(wanted_);
    values_ = pairs->values.head(wanted_);
    result.solver = "dense";
    result.smallest = Smallest::proven;
  }

  /// X := the Ritz vectors of its span; drops what is dependent.
  void ritz() {
    const Dense S = X_.adjoint() * times(problem_.S, X_), M = X_.adjoint() * times(problem_.M, X_);
    const Ritz ritz = rayleigh_ritz(0.5 * (S + S.adjoint()), 0.5 * (M + M.adjoint()), X_.cols(), dependent_modes);
    if (ritz.values.size() == 0 && X_.allFinite()) throw_mass(problem_.M);
    if (ritz.values.size() == 0 || !ritz.coefficients.allFinite())
      throw SolveError("the search for modes broke down; try another EigenOptions::method");
    X_ = X_ * ritz.coefficients;
    values_ = ritz.values;
  }

  /// The largest residual of the first `count` vectors.
  [[nodiscard]] double worst(Eigen::Index count) const {
    ComplexVector u, Su, Mu;
    double residual = 0;
    for (Eigen::Index k = 0; k < std::min(count, X_.cols()); ++k) {
      u = X_.col(k);
      const PairCheck check = check_pair(problem_, u, Su, Mu);
      residual = std::max({residual, check.residual, check.energy});
    }
    return residual;
  }

  void step_subspace() {
    check_cancelled(options_.cancel);
    Dense Y(rows_, X_.cols());
    static_cast<void>(inverse_.solver->solve(times(problem_.M, X_), Y));
    iterations_ += static_cast<int>(X_.cols());
    for (Eigen::Index c = 0; c < Y.cols(); ++c) Y.col(c).normalize();
    X_ = std::move(Y);
    ritz();
  }

  void iterate_subspace() {
    const Eigen::Index block = std::min(rows_, wanted_ + std::max<Eigen::Index>(4, wanted_ / 2));
    X_.resize(rows_, block);
    for (Eigen::Index c = 0; c < block; ++c)
      X_.col(c) = start_vector(rows_, options_.seed + static_cast<std::uint64_t>(c));
    while (iterations_ < options_.max_iterations) {
      step_subspace();
      if (worst(wanted_) <= options_.residual_tolerance()) break;
    }
  }

  /// y minus its parts along the columns of B, twice is enough (Parlett 1998); MB = M B.
  static void orthogonalise(ComplexVector& y, const Dense& B, const Dense& MB, Eigen::Index count) {
    for (int round = 0; round < 2 && count > 0; ++round) y -= B.leftCols(count) * (MB.leftCols(count).adjoint() * y);
  }

  /// `count` eigenvectors orthogonal to X, appended to it.
  void search(Eigen::Index count, std::uint64_t seed) {
    const Eigen::Index room = rows_ - X_.cols();
    count = std::min(count, room);
    if (count <= 0) return;
    const Eigen::Index size = std::min(room, std::max(smallest_basis, count + basis_beyond));
    const Dense MX = times(problem_.M, X_);
    Dense V(rows_, size + 1), MV(rows_, size + 1), H = Dense::Zero(size + 1, size + 1);
    ComplexVector v = start_vector(rows_, seed), Mv(rows_);
    Eigen::Index k = 0;
    double next_length = 0;
    const auto append = [&] {
      orthogonalise(v, X_, MX, X_.cols());
      orthogonalise(v, V, MV, k);
      hermitian_product(problem_.M, v.data(), Mv.data());
      next_length = std::sqrt(std::max(0.0, v.dot(Mv).real()));
      if (!(next_length > 0)) return false;
      V.col(k) = v / next_length;
      MV.col(k) = Mv / next_length;
      return true;
    };
    if (!append()) return;
    Eigenpairs<complex<double>> pairs;
    for (;;) {
      check_cancelled(options_.cancel);
      // Column k of Op V.
      Dense x(rows_, 1);
      static_cast<void>(inverse_.solver->solve(MV.col(k), x));
      ++iterations_;
      v = x.col(0);
      const double before = std::sqrt(std::max(0.0, v.dot(times(problem_.M, x).col(0)).real()));
      ++k;
      H.col(k - 1).head(k) = MV.leftCols(k).adjoint() * v;
      H.row(k - 1).head(k) = H.col(k - 1).head(k).adjoint();
      const bool more = append() && next_length > exhausted * before;
      pairs = hermitian_eigenpairs<complex<double>>(H.topLeftCorner(k, k));
      const Eigen::Index found = std::min(count, k);
      double left = 0;  // of the last wanted Ritz pair, relative
      for (Eigen::Index i = 0; i < found; ++i)
        left = std::max(left, next_length * std::abs(pairs.vectors(k - 1, k - 1 - i)) / pairs.values[k - 1 - i]);
      const bool done = k >= count && left <= 0.1 * options_.residual_tolerance();
      if (done || !more || iterations_ >= options_.max_iterations || k == room) break;
      if (k < size) continue;
      // Thick restart: the better half of the Ritz vectors and the next basis vector.
      const Eigen::Index keep = std::min(k - 1, std::max(count + basis_beyond / 2, size / 2));
      const Dense best = pairs.vectors.rightCols(keep);
      const ComplexVector last = V.col(k), M_last = MV.col(k);
      V.leftCols(keep) = (V.leftCols(k) * best).eval();
      MV.leftCols(keep) = (MV.leftCols(k) * best).eval();
      V.col(keep) = last;
      MV.col(keep) = M_last;
      H.setZero();
      H.diagonal().head(keep) = pairs.values.tail(keep).cast<complex<double>>();
      k = keep;
    }
    const Eigen::Index found = std::min(count, k);
    const Eigen::Index old = X_.cols();
    X_.conservativeResize(rows_, old + found);
    X_.rightCols(found) = V.leftCols(k) * pairs.vectors.rightCols(found);
    ritz();
  }

  void polish() {
    for (int round = 0; round < most_polishes && worst(wanted_) > options_.residual_tolerance(); ++round)
      step_subspace();
  }

  void search_all(EigenModes& result) {
    X_.resize(rows_, 0);
    search(wanted_ + guard, options_.seed);
    if (X_.cols() == 0) throw_mass(problem_.M);  // a start vector has no positive length
    for (int round = 1; round <= most_searches; ++round) {
      polish();
      std::int64_t missing = prove(result);
      if (result.smallest == Smallest::not_checked) {
        // Copies of multiple eigenvalues: until a search finds nothing among those wanted.
        const double last = values_[std::min(wanted_, X_.cols()) - 1];
        const Eigen::Index before = below(last + cluster_width * scale(last));
        if (X_.cols() >= rows_ || round == most_searches) return;
        search(guard, options_.seed + static_cast<std::uint64_t>(round));
        if (X_.cols() >= wanted_ && below(last + cluster_width * scale(last)) == before) return;
        continue;
      }
      if (missing <= 0) return;
      search(static_cast<Eigen::Index>(missing) + guard, options_.seed + static_cast<std::uint64_t>(round));
    }
  }

  /// Of the values found.
  [[nodiscard]] Eigen::Index below(double sigma) const { return (values_.array() < sigma).cast<Eigen::Index>().sum(); }

  /// Counts what lies below the last one wanted; how many are missing there.
  std::int64_t prove(EigenModes& result) {
    if (!asks_for_proof(options_, rows_)) return 0;
    if (X_.cols() < wanted_) return wanted_ - X_.cols();
    if (!counter_) counter_.emplace(problem_);
    const double last = values_[wanted_ - 1];
    const double sigma = last - std::max(bound_margin, 4 * worst(wanted_)) * scale(last);
    const EigenvalueCounter::Count count = counter_->below(sigma);
    if (!count.reliable) {
      result.message = "rounding does not allow a count of eigenvalues";
      return 0;
    }
    const std::int64_t missing = count.below - below(sigma);
    result.smallest = missing == 0 ? Smallest::proven : Smallest::refuted;
    return missing;
  }

  void conclude(EigenModes& result) {
    const Eigen::Index count = std::min(wanted_, X_.cols());
    result.U.resize(rows_, count);
    result.lambda.resize(count);
    result.residual.resize(count);
    result.converged = count == wanted_;
    ComplexVector u, Su, Mu;
    for (Eigen::Index k = 0; k < count; ++k) {
      u = X_.col(k);
      fix_phase(u);
      const PairCheck check = check_pair(problem_, u, Su, Mu);
      result.U.col(k) = u;
      result.lambda[k] = check.lambda;
      result.residual[k] = check.residual;
      if (!check.within(options_.residual_tolerance())) {
        const PairCheck floor = rounding_floor(problem_, u, check.lambda);
        if (check.residual > std::max(options_.residual_tolerance(), floor.residual)) result.converged = false;
      }
      const bool same = k > 0 && result.lambda[k] - result.lambda[k - 1] <= cluster_width * scale(result.lambda[k]);
      result.cluster.push_back(k == 0 ? 0 : result.cluster.back() + (same ? 0 : 1));
    }
    result.iterations = iterations_;
    if (!result.converged && result.message.empty()) result.message = not_reached;
    if (result.smallest == Smallest::refuted) result.message = "eigenvalues are missing, and were not found";
  }

  const EigenProblem& problem_;
  const EigenOptions& options_;
  Eigen::Index rows_, wanted_;
  ShiftInverted inverse_;
  std::optional<EigenvalueCounter> counter_;
  Dense X_;                 // Ritz vectors
  VectorX<double> values_;  // their values, ascending
  int iterations_ = 0;
};

}  // namespace

EigenModes find_modes(const EigenProblem& problem, const EigenOptions& options, const std::string& method, int count) {
  return Modes(problem, options, count).run(method);
}

}  // namespace detail
}  // namespace alcap
