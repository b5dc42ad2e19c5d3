// SPDX-License-Identifier: MIT
#include "src/design/eigen/pencil.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "alcap/assembly.h"
#include "solvers/eigenpair/lanczos_real.h"
#include "solvers/eigenpair/problem.h"
#include "solvers/linear/backends.h"

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
/// not.
template <class Matrix, class Expression>
Matrix made_of(const Expression& expression) {
  Matrix out;
  out = expression;
  return out;
}

SparseMatrix<double> gram(const Rows& R) {
  const auto Rt = made_of<SparseMatrix<double>>(R.transpose());
  return made_of<SparseMatrix<double>>(Rt * R);
}

SparseMatrix<C> shifted_by(const SparseMatrix<C>& S, const SparseMatrix<C>& M, double shift) {
  return made_of<SparseMatrix<C>>(S - shift * M);
}

class Pencil {
 public:
  Pencil(const SparseMatrix<C>& S, const SparseMatrix<C>& M, const DesignRows& rows, double size,
         const EigenDesignOptions& options)
      : S_(S),
        M_(M),
        D_(sparse(rows.across, S.rows())),
        P_(sparse(rows.along, S.rows())),
        Dt_(made_of<SparseMatrix<double>>(D_.transpose())),
        Pt_(made_of<SparseMatrix<double>>(P_.transpose())),
        size_(size),
        options_(options) {}

  RealPair solve() {
    RealPair pair = solve_unproven();
    judge(pair);
    return pair;
  }

 private:
  /// The other measures of a pair, and whether it is the smallest: by the signs of the pivots of the real matrices, as
  /// those of a complex problem whose entries happen to be real.
  void judge(RealPair& pair) const {
    const auto S = made_of<SparseMatrix<C>>(made_of<SparseMatrix<double>>(real_view(S_) + gram(D_)).cast<C>()),
               M = made_of<SparseMatrix<C>>(made_of<SparseMatrix<double>>(real_view(M_) + gram(P_)).cast<C>());
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

  RealPair solve_unproven() {
    if (S_.rows() <= dense_vertices)
      return smallest_dense_real(real_view(S_) + gram(D_), real_view(M_) + gram(P_), size_, options_.eigen);
    RealPencil pencil;
    pencil.rows = 2 * S_.rows();
    pencil.scale = size_;
    pencil.S = [this](const double* x, double* y) { product(S_, D_, Dt_, x, y); };
    pencil.M = [this](const double* x, double* y) { product(M_, P_, Pt_, x, y); };
    const bool low = options_.path == EigenPath::low_rank ||
                     (options_.path == EigenPath::automatic && D_.rows() <= options_.largest_rank);
    if (low)
      prepare_update(pencil);
    else
      prepare_real(pencil);
    return smallest_lanczos_real(pencil, options_.eigen);
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
    const auto stiffness = made_of<SparseMatrix<double>>(real_view(S_) + gram(D_)),
               mass = made_of<SparseMatrix<double>>(real_view(M_) + gram(P_));
    for (int attempt = 1;; ++attempt) {
      pencil.shift = attempt == 1 ? -relative_shift / size_ : shift_growth * pencil.shift;
      const auto A = made_of<SparseMatrix<double>>(stiffness - pencil.shift * mass);
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
      const Eigen::Map<const MatrixX<double>> b(x, 2 * S_.rows(), 1);
      Eigen::Map<MatrixX<double>> result(y, 2 * S_.rows(), 1);
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
    if (!factorise_unshifted()) {
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
    factor_.compute(G);
    if (factor_.info() != Eigen::Success) throw SolveError("the stroke's update is not positive definite");
    pencil.name = complex_->name() + ", " + std::to_string(rank) + " rows";
    pencil.solve = [this, &pencil](const double* x, double* y) {
      const Eigen::Index size = 2 * S_.rows();
      const Eigen::Map<const Vector> b(x, size);
      Eigen::Map<Vector> result(y, size);
      Vector Sx(size), Mx(size);
      result = update(b);
      // Refinement: heavy strokes cancel most of the first solve.
      for (int step = 0; step < 2; ++step) {
        pencil.S(y, Sx.data());
        if (shift_ < 0) {
          pencil.M(y, Mx.data());
          Sx -= shift_ * Mx;
        }
        result += update(b - Sx);
      }
    };
  }

  [[nodiscard]] Vector update(const Vector& b) const {
    Vector x(b.size());
    const Eigen::Map<const MatrixX<C>> bc(reinterpret_cast<const C*>(b.data()), S_.rows(), 1);
    Eigen::Map<MatrixX<C>> xc(reinterpret_cast<C*>(x.data()), S_.rows(), 1);
    (void)complex_->solve(bc, xc);
    x -= Y_ * factor_.solve(Vector(Bt_ * x));
    return x;
  }

  const SparseMatrix<C>& S_;
  const SparseMatrix<C>& M_;
  Rows D_, P_, Bt_;
  SparseMatrix<double> Dt_, Pt_;
  double size_;
  const EigenDesignOptions& options_;
  double shift_ = 0;
  std::unique_ptr<LinearSolver<double>> real_;
  std::unique_ptr<LinearSolver<C>> complex_;
  MatrixX<double> Y_;
  Eigen::LLT<MatrixX<double>> factor_;
};

}  // namespace

EigenResult smallest_with_rows(const SparseMatrix<C>& S, const SparseMatrix<C>& M, const DesignRows& rows, double size,
                               const EigenDesignOptions& options) {
  Pencil pencil(S, M, rows, size, options);
  RealPair pair = pencil.solve();
  EigenResult result;
  result.report = std::move(pair.report);
  result.u = Eigen::Map<const ComplexVectorX<double>>(reinterpret_cast<const C*>(pair.u.data()), S.rows());
  ComplexVectorX<double> Mu(S.rows());
  hermitian_product(M, result.u.data(), Mu.data());
  result.u /= std::sqrt(result.u.dot(Mu).real());
  return result;
}

}  // namespace alcap::detail
