// SPDX-License-Identifier: MIT
#include "src/design/eigen/pencil.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "alcap/assembly.h"
#include "solvers/dense/hermitian.h"
#include "solvers/eigenpair/lanczos_real.h"
#include "solvers/eigenpair/problem.h"
#include "solvers/linear/backends.h"
#include "src/base/cancel.h"

namespace alcap::detail {
namespace {

using C = Complex<double>;
using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor, Index>;
using Vector = VectorX<double>;

// Shift in units of -1/size, as for the plain problem: S - shift M is positive definite also when S is singular.
constexpr double relative_shift = 1e-3;
// Strokes so heavy that rounding in them hides the rest need more: by this factor, this many times.
constexpr double shift_growth = 30;
constexpr int shift_attempts = 4;
// Solves are refined so often: heavy strokes cancel most of an update, and so does guidance of a large weight.
constexpr int update_refinements = 2, guided_refinements = 1;
// A number of about 1 that rounding in a factorisation could not make positive.
constexpr double clearly_positive = 1e-11;
// Up to so many vertices a dense solve is quicker.
constexpr Eigen::Index dense_vertices = 48;

Rows sparse(const std::vector<RealRow>& rows, Eigen::Index vertices) {
  std::vector<Eigen::Triplet<double, Index>> entries;
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t at = 0; at < rows[r].vertex.size(); ++at) {
      entries.emplace_back(static_cast<Index>(r), 2 * rows[r].vertex[at], rows[r].coefficient[at].real());
      entries.emplace_back(static_cast<Index>(r), 2 * rows[r].vertex[at] + 1, rows[r].coefficient[at].imag());
    }
  Rows R(static_cast<Eigen::Index>(rows.size()), 2 * vertices);
  R.setFromTriplets(entries.begin(), entries.end());
  return R;
}

/// A matrix from an expression. Eigen's constructors leak where memory runs out in the middle of them, assignments do
/// not. Several large matrices are made one after the other, and nothing else asks whether to stop.
template <class Matrix, class Expression>
Matrix made_of(const Expression& expression) {
  check_cancelled();
  Matrix out;
  out = expression;
  return out;
}

SparseMatrix<double> gram(const Rows& R) {
  const auto Rt = made_of<SparseMatrix<double>>(R.transpose());
  return made_of<SparseMatrix<double>>(Rt * R);
}

/// A row over all vertices as a vector of the real view: Re(row* u) = interleaved(row)' interleaved(u).
Vector interleaved(const ComplexVectorX<double>& row) {
  return Eigen::Map<const Vector>(reinterpret_cast<const double*>(row.data()), 2 * row.size());
}

SparseMatrix<C> shifted_by(const SparseMatrix<C>& S, const SparseMatrix<C>& M, double shift) {
  return made_of<SparseMatrix<C>>(S - shift * M);
}

class Pencil {
 public:
  /// `basis`: of the fields to look among; null: all. Kept by address.
  Pencil(const SparseMatrix<C>& S, const SparseMatrix<C>& M, const DesignRows& rows, double size,
         const EigenDesignOptions& options, const SparseMatrix<double>* basis = nullptr)
      : T_(basis),
        S_(S),
        M_(M),
        D_(sparse(rows.across, S.rows())),
        P_(sparse(rows.along, S.rows())),
        Dt_(made_of<SparseMatrix<double>>(D_.transpose())),
        Pt_(made_of<SparseMatrix<double>>(P_.transpose())),
        q_(interleaved(rows.follow)),
        size_(size),
        options_(options) {
    if (T_ == nullptr) return;
    if (guided()) q_ = Vector(T_->transpose() * q_);
    inside_S_ = stiffness();
    inside_M_ = mass();
  }

  RealPair solve() {
    RealPair pair = solve_unproven();
    if (guided())
      judge_guided(pair);
    else
      judge(pair);
    return pair;
  }

 private:
  /// The other measures of a pair, and whether it is the smallest: by the signs of the pivots of the real matrices, as
  /// those of a complex problem whose entries happen to be real.
  void judge(RealPair& pair) const {
    const auto S = made_of<SparseMatrix<C>>(stiffness().cast<C>()), M = made_of<SparseMatrix<C>>(mass().cast<C>());
    const EigenProblem problem{.S = S, .M = M, .area = size_, .transport = nullptr};
    EigenResult result{.u = pair.u.cast<C>(), .report = std::move(pair.report)};
    ComplexVector Su, Mu;
    const PairCheck check = check_distance(problem, result.u, Su, Mu);
    result.report.energy_residual = check.energy;
    result.report.distance = check.distance;
    if (result.report.converged && check.energy > options_.eigen.residual_tolerance()) {
      result.report.converged = false;
      result.report.message = not_reached;
    }
    prove_smallest(problem, options_.eigen, true, result);
    // A replaced vector is real as well, since its largest entry is.
    pair.u = result.u.real();
    pair.report = std::move(result.report);
  }

  /// The same where a row over all vertices belongs to the pencil, which is in no sparse matrix. It leaves S - sigma M
  /// without eigenvalues below 0 when the matrices alone have none and 1 - q' (S - sigma M)^-1 q is positive
  /// (Haynsworth 1968).
  void judge_guided(RealPair& pair) const {
    const SparseMatrix<double> S = stiffness(), M = mass();
    const auto Sc = made_of<SparseMatrix<C>>(S.cast<C>()), Mc = made_of<SparseMatrix<C>>(M.cast<C>());
    const EigenProblem problem{.S = Sc, .M = Mc, .area = size_, .transport = nullptr};
    Vector Su(pair.u.size()), Mu(pair.u.size());
    all_S(pair.u.data(), Su.data());
    all_M(pair.u.data(), Mu.data());
    EigenReport& report = pair.report;
    const PairCheck check = check_residual(problem, report.lambda, (Su - report.lambda * Mu).cast<C>());
    report.energy_residual = check.energy;
    report.distance = check.distance;
    if (report.converged && check.energy > options_.eigen.residual_tolerance()) {
      report.converged = false;
      report.message = not_reached;
    }
    EigenResult result{.u = pair.u.cast<C>(), .report = std::move(report)};
    prove_smallest_with(
        problem, options_.eigen, [&](double sigma) { return row_leaves_definite(S, M, sigma); }, result);
    pair.report = std::move(result.report);
  }

  [[nodiscard]] std::optional<bool> row_leaves_definite(const SparseMatrix<double>& S, const SparseMatrix<double>& M,
                                                        double sigma) const {
    const auto A = made_of<SparseMatrix<double>>(S - sigma * M);
    const auto solver =
        make_linear_solver<double>({.name = preferred_factorisation(), .cancel = options_.eigen.cancel});
    try {
      solver->analyse(A);
      solver->factorise(A);
    } catch (const SolveError&) {
      return std::nullopt;
    }
    MatrixX<double> Y(q_.size(), 1);
    (void)solver->solve(q_, Y);
    return 1 - q_.dot(Y.col(0)) > clearly_positive;
  }

  [[nodiscard]] bool guided() const { return q_.size() > 0; }

  RealPair solve_dense() const {
    if (!guided()) return smallest_dense_real(stiffness(), mass(), size_, options_.eigen);
    const MatrixX<double> S = MatrixX<double>(stiffness()) - q_ * q_.transpose();
    return smallest_dense_real(S.sparseView(0, 0), mass(), size_, options_.eigen);
  }

  RealPair solve_unproven() {
    if (S_.rows() <= dense_vertices) return solve_dense();
    RealPencil pencil;
    pencil.rows = unknowns();
    pencil.scale = size_;
    pencil.S = [this](const double* x, double* y) { all_S(x, y); };
    pencil.M = [this](const double* x, double* y) { all_M(x, y); };
    const bool low = T_ == nullptr && (options_.path == EigenPath::low_rank ||
                                       (options_.path == EigenPath::automatic && D_.rows() <= options_.largest_rank));
    if (low)
      prepare_update(pencil);
    else
      prepare_real(pencil);
    if (guided()) add_guidance(pencil);
    refine(pencil, std::max(low ? update_refinements : 0, guided() ? guided_refinements : 0));
    return smallest_lanczos_real(pencil, options_.eigen);
  }

  /// Of the real problem.
  [[nodiscard]] Eigen::Index unknowns() const { return T_ == nullptr ? 2 * S_.rows() : T_->cols(); }
  [[nodiscard]] SparseMatrix<double> stiffness() const { return inside(real_view(S_) + gram(D_)); }
  [[nodiscard]] SparseMatrix<double> mass() const { return inside(real_view(M_) + gram(P_)); }
  template <class Expression>
  [[nodiscard]] SparseMatrix<double> inside(const Expression& all) const {
    if (T_ == nullptr) return made_of<SparseMatrix<double>>(all);
    const auto whole = made_of<SparseMatrix<double>>(all);
    return made_of<SparseMatrix<double>>(T_->transpose() * whole * *T_);
  }

  void all_M(const double* x, double* y) const {
    if (T_ == nullptr)
      product(M_, P_, Pt_, x, y);
    else
      Eigen::Map<Vector>(y, unknowns()) = inside_M_ * Eigen::Map<const Vector>(x, unknowns());
  }
  void all_S(const double* x, double* y) const {
    if (T_ == nullptr)
      product(S_, D_, Dt_, x, y);
    else
      Eigen::Map<Vector>(y, unknowns()) = inside_S_ * Eigen::Map<const Vector>(x, unknowns());
    if (!guided()) return;
    const Eigen::Map<const Vector> in(x, q_.size());
    Eigen::Map<Vector>(y, q_.size()) -= q_.dot(in) * q_;
  }
  /// From a solve with the sparse part of S - shift M to one with all of it (Sherman and Morrison 1950).
  void add_guidance(RealPencil& pencil) {
    solved_q_.resize(q_.size());
    pencil.solve(q_.data(), solved_q_.data());
    pencil.solve = [this, part = 1 - q_.dot(solved_q_), direct = std::move(pencil.solve)](const double* x, double* y) {
      direct(x, y);
      Eigen::Map<Vector> result(y, q_.size());
      result += q_.dot(result) / part * solved_q_;
    };
  }

  void refine(RealPencil& pencil, int steps) const {
    if (steps == 0) return;
    pencil.solve = [this, steps, shift = pencil.shift, direct = std::move(pencil.solve)](const double* x, double* y) {
      const Eigen::Index size = unknowns();
      const Eigen::Map<const Vector> b(x, size);
      Eigen::Map<Vector> result(y, size);
      Vector rest(size), Mx(size), change(size);
      direct(x, y);
      for (int step = 0; step < steps; ++step) {
        all_S(y, rest.data());
        if (shift < 0) {
          all_M(y, Mx.data());
          rest -= shift * Mx;
        }
        rest = b - rest;
        direct(rest.data(), change.data());
        result += change;
      }
    };
  }

  static void product(const SparseMatrix<C>& A, const Rows& R, const SparseMatrix<double>& Rt, const double* x,
                      double* y) {
    hermitian_product(A, reinterpret_cast<const C*>(x), reinterpret_cast<C*>(y));
    const Eigen::Map<const Vector> in(x, 2 * A.rows());
    Eigen::Map<Vector>(y, 2 * A.rows()) += Rt * Vector(R * in);
  }

  [[nodiscard]] SolverOptions solver_options() const {
    return {.name = options_.eigen.solver,
            .tolerance = std::max(1e-2 * options_.eigen.residual_tolerance(), 1e-13),
            .cancel = options_.eigen.cancel};
  }

  void prepare_real(RealPencil& pencil) {
    real_ = make_linear_solver<double>(solver_options());
    const SparseMatrix<double> S = stiffness(), M = mass();
    for (int attempt = 1;; ++attempt) {
      pencil.shift = attempt == 1 ? -relative_shift / size_ : shift_growth * pencil.shift;
      const auto A = made_of<SparseMatrix<double>>(S - pencil.shift * M);
      if (attempt == 1) real_->analyse(A);
      try {
        real_->factorise(A);
        break;
      } catch (const SolveError&) {
        if (attempt == shift_attempts) throw;
      }
    }
    pencil.name = real_->name();
    pencil.solve = [this](const double* x, double* y) {
      const Eigen::Map<const MatrixX<double>> b(x, unknowns(), 1);
      Eigen::Map<MatrixX<double>> result(y, unknowns(), 1);
      (void)real_->solve(b, result);
    };
  }

  // Without a shift the rows of the mass need no update. That is safe where the plain problem is clearly regular.
  bool factorise_unshifted() {
    double energy = 0;
    try {
      complex_->factorise(S_);
      // A few inverse iterations tell whether the smallest eigenvalue is something or nothing. Iterative backends only
      // find out here.
      MatrixX<C> x = MatrixX<C>::Ones(S_.rows(), 1), Mx(S_.rows(), 1);
      for (int round = 0; round < 4; ++round) {
        hermitian_product(M_, x.data(), Mx.data());
        Mx /= std::sqrt(x.col(0).dot(Mx.col(0)).real());
        (void)complex_->solve(Mx, x);
        energy = 1 / std::sqrt(x.col(0).dot(M_ * x.col(0)).real());
      }
    } catch (const SolveError&) {
      return false;
    }
    return energy * plain_size() > 1e-2;
  }

  // The mass of a unit field without rows: the area, up to the curvature.
  [[nodiscard]] double plain_size() const {
    double sum = 0;
    for (Eigen::Index k = 0; k < M_.nonZeros(); ++k) sum += std::abs(M_.valuePtr()[k]);
    return sum;
  }

  void prepare_update(RealPencil& pencil) {
    complex_ = make_linear_solver<C>(solver_options());
    if (same_pattern(S_, M_)) complex_->set_transport(M_);
    complex_->analyse(S_);
    if (guided() || !factorise_unshifted()) {
      pencil.shift = -relative_shift / size_;
      complex_->factorise(shifted_by(S_, M_, pencil.shift));
    }
    shift_ = pencil.shift;
    // B: D and, with a shift, the rows of the mass. Y = A^-1 B', G = I + B Y.
    const Eigen::Index vertices = S_.rows(), across = D_.rows();
    const Eigen::Index rank = across + (shift_ < 0 ? P_.rows() : 0);
    MatrixX<double> B = MatrixX<double>::Zero(2 * vertices, rank);
    B.leftCols(across) = Dt_.toDense();
    if (shift_ < 0) B.rightCols(P_.rows()) = std::sqrt(-shift_) * Pt_.toDense();
    Y_.resize(2 * vertices, rank);
    const Eigen::Map<const MatrixX<C>> Bc(reinterpret_cast<const C*>(B.data()), vertices, rank);
    Eigen::Map<MatrixX<C>> Yc(reinterpret_cast<C*>(Y_.data()), vertices, rank);
    (void)complex_->solve(Bc, Yc);
    Bt_ = B.transpose().sparseView(0, 0);
    MatrixX<double> G = Bt_ * Y_;
    G.diagonal().array() += 1;
    std::optional<MatrixX<double>> factor = cholesky_factor(G);
    if (!factor)
      throw SolveError(
          "the update for the strokes is not positive definite; EigenDesignOptions::largest_rank 0 does without it");
    factor_ = std::move(*factor);
    pencil.name = complex_->name() + ", " + std::to_string(rank) + " rows";
    pencil.solve = [this](const double* x, double* y) {
      Eigen::Map<Vector>(y, 2 * S_.rows()) = update(Eigen::Map<const Vector>(x, 2 * S_.rows()));
    };
  }

  [[nodiscard]] Vector update(const Vector& b) const {
    Vector x(b.size());
    const Eigen::Map<const MatrixX<C>> bc(reinterpret_cast<const C*>(b.data()), S_.rows(), 1);
    Eigen::Map<MatrixX<C>> xc(reinterpret_cast<C*>(x.data()), S_.rows(), 1);
    (void)complex_->solve(bc, xc);
    x -= Y_ * cholesky_solve(factor_, Bt_ * x);
    return x;
  }

  const SparseMatrix<double>* T_;
  const SparseMatrix<C>& S_;
  const SparseMatrix<C>& M_;
  SparseMatrix<double> inside_S_, inside_M_;  // with T
  Rows D_, P_, Bt_;
  SparseMatrix<double> Dt_, Pt_;
  Vector q_;  // its square is taken from S; empty without guidance
  double size_;
  const EigenDesignOptions& options_;
  double shift_ = 0;
  std::unique_ptr<LinearSolver<double>> real_;
  std::unique_ptr<LinearSolver<C>> complex_;
  MatrixX<double> Y_;
  MatrixX<double> factor_;  // of 1 + B' Y: its lower triangle
  Vector solved_q_;
};

}  // namespace

namespace {

EigenResult field_of(RealPair pair, const Vector& u, const SparseMatrix<C>& M) {
  EigenResult result;
  result.report = std::move(pair.report);
  result.u = Eigen::Map<const ComplexVectorX<double>>(reinterpret_cast<const C*>(u.data()), M.rows());
  ComplexVectorX<double> Mu(M.rows());
  hermitian_product(M, result.u.data(), Mu.data());
  result.u /= std::sqrt(result.u.dot(Mu).real());
  return result;
}

}  // namespace

EigenResult smallest_with_rows(const SparseMatrix<C>& S, const SparseMatrix<C>& M, const DesignRows& rows, double size,
                               const EigenDesignOptions& options) {
  RealPair pair = Pencil(S, M, rows, size, options).solve();
  const Vector u = pair.u;
  return field_of(std::move(pair), u, M);
}

EigenResult smallest_with_rows_in(const SparseMatrix<double>& T, const SparseMatrix<C>& S, const SparseMatrix<C>& M,
                                  const DesignRows& rows, double size, const EigenDesignOptions& options) {
  RealPair pair = Pencil(S, M, rows, size, options, &T).solve();
  const Vector u = T * pair.u;
  return field_of(std::move(pair), u, M);
}

}  // namespace alcap::detail
