// SPDX-License-Identifier: MIT
//
// aligned.cpp: the harmonic field with the features held, then renormalise and diffuse, one component at a time.
#include "alcap/aligned.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "alcap/energies.h"
#include "src/base/cancel.h"
#include "src/base/parallel.h"
#include "src/base/random.h"
#include "src/design/aligned/constraints.h"
#include "src/design/weight_range.h"
#include "src/field/component_blocks.h"

namespace alcap {
namespace {

using C = Complex<double>;
using detail::AlignedConstraints;
using detail::EdgeRow;

// Each tau is this part of the one before.
constexpr double tau_factor = 0.25;
// Only the last tau must settle; the others bring the zeros near, by longer steps than it could.
constexpr int coarse_steps = 100;
// Inverse iterations for lambda_1: one digit is enough to start from.
constexpr int lambda_iterations = 6;
// Values of the harmonic field below this part of the largest are not known yet: an iterative solver's error is 1e-10
// of it. First steps let them grow with their square, so that what is known spreads and what is rounding dies, for as
// long as each leaves less than this part of them unknown.
constexpr double known = 1e-4;
constexpr double filling = 0.9;
// Accuracy of the solves inside, relative.
constexpr double solve_tolerance = 1e-10;

/// What is left to solve for in one component: its free vertices.
struct Block {
  std::vector<Index> free;
  SparseMatrix<C> L, M;         // with the soft rows in L
  ComplexVectorX<double> load;  // L u = load is the harmonic field
  double constant = 0;          // of twice the energy
  double edge = 0;              // length of an edge if all triangles were alike
};

/// The rows and columns of A that `local` numbers, for columns in `free`.
SparseMatrix<C> free_part(const SparseMatrix<C>& A, const std::vector<Index>& free, const std::vector<Index>& local) {
  const auto size = static_cast<Index>(free.size());
  SparseMatrix<C> B(size, size);
  Index total = 0;
  for (Index j = 0; j < size; ++j) {
    B.outerIndexPtr()[j] = total;
    for (SparseMatrix<C>::InnerIterator it(A, free[static_cast<std::size_t>(j)]); it; ++it)
      total += local[static_cast<std::size_t>(it.row())] == none ? 0 : 1;
  }
  B.outerIndexPtr()[size] = total;
  B.resizeNonZeros(total);
  Index slot = 0;
  for (const Index v : free)
    for (SparseMatrix<C>::InnerIterator it(A, v); it; ++it) {
      const Index row = local[static_cast<std::size_t>(it.row())];
      if (row == none) continue;
      B.innerIndexPtr()[slot] = row;
      B.valuePtr()[slot++] = it.value();
    }
  return B;
}

/// The whole problem, before it is cut into components.
class Problem {
 public:
  Problem(const ConnectedSurface& surface, const AlignedConstraints& constraints, int n)
      : surface_(surface), constraints_(constraints) {
    StiffnessMass matrices = energy_matrices(surface, n);
    L_.swap(matrices.S);
    M_.swap(matrices.M);
    load_ = ComplexVectorX<double>::Zero(surface.mesh().vertices());
    local_.assign(static_cast<std::size_t>(surface.mesh().vertices()), none);
    vertices_ = detail::vertices_of_components(surface.topology());
    areas_ = detail::areas_of_components(surface.geometry(), surface.topology());
    constant_.assign(vertices_.size(), 0.0);
    for (const EdgeRow& row : constraints.rows) add(row);
    for (const std::vector<Index>& piece : vertices_) {
      Index next = 0;
      for (const Index v : piece)
        if (constraints.held[static_cast<std::size_t>(v)] == 0) local_[static_cast<std::size_t>(v)] = next++;
    }
  }

  [[nodiscard]] const std::vector<Index>& vertices(std::size_t c) const { return vertices_[c]; }
  [[nodiscard]] double area(std::size_t c) const { return areas_[c]; }

  [[nodiscard]] Block block(std::size_t c) const {
    Block b;
    b.constant = constant_[c];
    b.edge = std::sqrt(2 / std::sqrt(3.0) * areas_[c] / static_cast<double>(vertices_[c].size()));
    for (const Index v : vertices_[c])
      if (free(v)) b.free.push_back(v);
    b.L = free_part(L_, b.free, local_);
    b.M = free_part(M_, b.free, local_);
    b.load.resize(static_cast<Eigen::Index>(b.free.size()));
    for (std::size_t k = 0; k < b.free.size(); ++k) b.load[static_cast<Eigen::Index>(k)] = load_[b.free[k]];
    for (const Index v : vertices_[c]) {
      if (free(v)) continue;
      const C g = constraints_.value[v];
      b.constant -= 2 * (std::conj(g) * load_[v]).real();
      for (SparseMatrix<C>::InnerIterator it(L_, v); it; ++it) {
        const auto i = static_cast<Index>(it.row());
        if (free(i))
          b.load[local_[static_cast<std::size_t>(i)]] -= it.value() * g;
        else
          b.constant += (std::conj(constraints_.value[i]) * it.value() * g).real();
      }
    }
    return b;
  }

  /// The smoothest field of a component without constraints, of root mean square length 1.
  [[nodiscard]] EigenResult smoothest(std::size_t c, const EigenOptions& options) const {
    EigenResult result = smallest_eigenpair(diagonal_block(L_, vertices_[c], local_),
                                            diagonal_block(M_, vertices_[c], local_), areas_[c], options);
    result.u *= std::sqrt(areas_[c]);
    return result;
  }

 private:
  [[nodiscard]] bool free(Index v) const { return local_[static_cast<std::size_t>(v)] != none; }

  // S alone is int |grad u|^2; half the weight, because strokes weigh against 2 S.
  void add(const EdgeRow& row) {
    const double w = row.weight / 2;
    const std::pair<Index, C> entries[2] = {{row.i, row.a}, {row.j, row.b}};
    for (const auto& [r, cr] : entries) {
      load_[r] += w * std::conj(cr) * row.target;
      for (const auto& [s, cs] : entries) L_.coeffRef(r, s) += w * std::conj(cr) * cs;
    }
    const Index c = surface_.topology().vertex_component[static_cast<std::size_t>(row.i)];
    constant_[static_cast<std::size_t>(c)] += w * std::norm(row.target);
  }

  const ConnectedSurface& surface_;
  const AlignedConstraints& constraints_;
  SparseMatrix<C> L_, M_;
  ComplexVectorX<double> load_;
  std::vector<Index> local_;
  std::vector<std::vector<Index>> vertices_;
  std::vector<double> areas_, constant_;
};

/// The steps on one block.
class Relaxation {
 public:
  Relaxation(const Block& block, const AlignedOptions& options, AlignedPiece& piece)
      : block_(block), options_(options), piece_(piece), size_(block.L.rows()) {
    solver_ = make_linear_solver<C>({.name = options.eigen.solver, .tolerance = solve_tolerance});
    solver_->set_transport(block.M);
    solver_->analyse(block.L);
  }

  /// The harmonic field and lambda_1.
  void harmonic() {
    solver_->factorise(block_.L);
    solve(block_.L, block_.load);
    if (!options_.linear) find_lambda();
    piece_.settled = options_.linear;
  }

  void relax() {
    const double finest = options_.finest * block_.edge * block_.edge;
    for (double tau = std::max(finest, 1 / piece_.lambda);; tau = std::max(finest, tau * tau_factor)) {
      const bool last = tau <= finest;
      SparseMatrix<C> A;  // assigned: Eigen's constructors leak where memory runs out in the middle of them
      A = block_.M;
      parallel_for(A.nonZeros(), [&](std::int64_t k) { A.valuePtr()[k] += tau * block_.L.valuePtr()[k]; });
      solver_->set_transport(block_.M);
      solver_->factorise(A);
      if (piece_.steps.empty()) fill(A, tau);
      const double settled = options_.settled_degrees * std::min(1.0, tau * piece_.lambda);
      for (int k = 0; (last || k < coarse_steps) && left(); ++k) {
        step(A, tau, 0);
        piece_.settled = last && piece_.steps.back().largest_degrees <= settled;
        if (piece_.steps.back().largest_degrees <= settled) break;
      }
      if (last || !left()) return;
    }
  }

  [[nodiscard]] const MatrixX<C>& u() const { return u_; }

 private:
  [[nodiscard]] bool left() const { return static_cast<int>(piece_.steps.size()) < options_.max_steps; }

  void solve(const SparseMatrix<C>& A, const ComplexVectorX<double>& b) {
    MatrixX<C> x = MatrixX<C>::Zero(size_, 1);
    (void)solver_->solve(b, x);
    if (!x.allFinite())
      throw SolveError(
          "aligned field: the linear solver returned values that are not finite; try another EigenOptions::solver");
    piece_.residual = b.isZero(0) ? 0 : residual<C>(A, x, b);
    piece_.solver = solver_->name();
    u_.swap(x);
  }

  void find_lambda() {
    detail::Random random(1);
    MatrixX<C> x(size_, 1), Mx(size_, 1);
    for (Eigen::Index k = 0; k < size_; ++k) x(k, 0) = {random.uniform(-1, 1), random.uniform(-1, 1)};
    double size = size_of(x, Mx);
    for (int k = 0; k < lambda_iterations; ++k) {
      Mx /= size;
      (void)solver_->solve(Mx, x);
      size = size_of(x, Mx);
    }
    piece_.lambda = 1 / size;
    if (!(piece_.lambda > 0 && std::isfinite(piece_.lambda)))
      throw SolveError(
          "aligned field: the smallest eigenvalue of a piece is not positive; try another EigenOptions::solver, or "
          "Repair::mollify: badly shaped triangles are the usual reason");
  }

  /// |x|_M, and M x.
  [[nodiscard]] double size_of(const MatrixX<C>& x, MatrixX<C>& Mx) const {
    hermitian_product(block_.M, x.data(), Mx.data());
    return std::sqrt(std::max(0.0, x.col(0).dot(Mx.col(0)).real()));
  }

  void fill(const SparseMatrix<C>& A, double tau) {
    const double least = known * std::max(1.0, u_.cwiseAbs().maxCoeff());
    for (auto before = static_cast<double>(size_ + 1); left();) {
      const auto unknown = static_cast<double>((u_.cwiseAbs().array() < least).count());
      if (unknown == 0 || unknown > filling * before) return;
      before = unknown;
      step(A, tau, least);
    }
  }

  /// u / |u|, shorter where |u| is below `least`.
  [[nodiscard]] ComplexVectorX<double> directions(double least) const {
    ComplexVectorX<double> v(size_);
    parallel_for(size_, [&](std::int64_t k) {
      const double size = std::abs(u_(k, 0));
      const double part = size < least ? size / least * (size / least) : 1;
      v[k] = size > 0 ? u_(k, 0) / size * part : C(0);
    });
    return v;
  }

  void step(const SparseMatrix<C>& A, double tau, double least) {
    detail::check_cancelled();
    const ComplexVectorX<double> v = directions(least);
    ComplexVectorX<double> Lv(size_), b(size_);
    hermitian_product(block_.L, v.data(), Lv.data());
    hermitian_product(block_.M, v.data(), b.data());
    AlignedStep report{.tau = tau, .energy = (v.dot(Lv).real() - 2 * v.dot(block_.load).real() + block_.constant) / 2};
    b += tau * block_.load;
    const MatrixX<C> before = u_;
    solve(A, b);
    const double degrees = 180 / pi<double> / options_.n;
    report.largest_degrees = (u_ - before).cwiseAbs().maxCoeff() * degrees;
    report.rms_degrees = (u_ - before).norm() / std::sqrt(static_cast<double>(size_)) * degrees;
    piece_.steps.push_back(report);
  }

  const Block& block_;
  const AlignedOptions& options_;
  AlignedPiece& piece_;
  Eigen::Index size_;
  std::unique_ptr<LinearSolver<C>> solver_;
  MatrixX<C> u_;
};

void check(const ConnectedSurface& surface, const FeatureGraph& features, const AlignedOptions& options) {
  if (options.n < 1) throw OptionError("n", options.n, "the degree of a field is at least 1");
  detail::check_features(surface.mesh(), features, options.n);
  if (!detail::fit_weight_or_zero(options.weight))
    throw OptionError("weight", options.weight, detail::weight_or_zero_rule);
  if (options.max_steps < 0) throw OptionError("max_steps", options.max_steps, "must not be negative");
  if (!(options.settled_degrees > 0)) throw OptionError("settled_degrees", options.settled_degrees, "must be positive");
  if (!(options.finest >= 1) || !std::isfinite(options.finest))
    throw OptionError("finest", options.finest, "must be at least 1: zeros stick to faces below");
}

void solve_piece(const Problem& problem, std::size_t c, const AlignedOptions& options, AlignedPiece& piece,
                 ComplexVectorX<double>& u) {
  const std::vector<Index>& vertices = problem.vertices(c);
  if (piece.held == 0 && piece.rows == 0) {
    EigenOptions eigen = options.eigen;
    eigen.degree = options.n;
    EigenResult smooth = problem.smoothest(c, eigen);
    for (std::size_t k = 0; k < vertices.size(); ++k) u[vertices[k]] = smooth.u[static_cast<Eigen::Index>(k)];
    piece.settled = true;
    piece.residual = smooth.report.residual;
    piece.solver = smooth.report.solver;
    piece.eigen = std::move(smooth.report);
    return;
  }
  const Block block = problem.block(c);
  piece.settled = true;
  if (block.free.empty()) return;
  Relaxation relaxation(block, options, piece);
  relaxation.harmonic();
  if (!options.linear) relaxation.relax();
  for (std::size_t k = 0; k < block.free.size(); ++k)
    u[block.free[k]] = relaxation.u()(static_cast<Eigen::Index>(k), 0);
}

void count_constraints(const ConnectedSurface& surface, const AlignedConstraints& constraints,
                       std::vector<AlignedPiece>& pieces) {
  const auto piece_of = [&](Index v) -> AlignedPiece& {
    return pieces[static_cast<std::size_t>(surface.topology().vertex_component[static_cast<std::size_t>(v)])];
  };
  for (Index v = 0; v < surface.mesh().vertices(); ++v)
    if (constraints.held[static_cast<std::size_t>(v)] != 0) ++piece_of(v).held;
  for (const EdgeRow& row : constraints.rows) ++piece_of(row.i).rows;
}

AlignedResult solve(const ConnectedSurface& surface, const FeatureGraph& features, const AlignedOptions& options) {
  detail::report_phase("assembly");
  AlignedConstraints constraints = detail::find_constraints(surface, features, options);
  const Problem problem(surface, constraints, options.n);
  AlignedResult result;
  result.field.n = options.n;
  result.field.u = constraints.value;
  result.pieces.resize(surface.topology().components.size());
  count_constraints(surface, constraints, result.pieces);
  detail::report_phase("diffuse");
  parallel_for(
      static_cast<std::int64_t>(result.pieces.size()),
      [&](std::int64_t i) {
        const auto c = static_cast<std::size_t>(i);
        solve_piece(problem, c, options, result.pieces[c], result.field.u);
      },
      1);
  for (const VertexConstraint& fixed : options.fixed) {
    const double off = std::abs(std::arg(result.field.u[fixed.vertex] * std::conj(fixed.value)));
    result.fixed_degrees = std::max(result.fixed_degrees, off / options.n * 180 / pi<double>);
  }
  result.free_corners = std::move(constraints.free_corners);
  if (surface.in_space()) result.field.frames = surface.frames();
  return result;
}

}  // namespace

AlignedResult aligned_field(const ConnectedSurface& surface, const FeatureGraph& features,
                            const AlignedOptions& options) {
  check(surface, features, options);
  return controlled(options.control, [&] {
    const detail::ControlScope eigen(options.eigen.cancel);
    return solve(surface, features, options);
  });
}

}  // namespace alcap
