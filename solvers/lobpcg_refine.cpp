// SPDX-License-Identifier: MIT
//
// lobpcg_refine.cpp: LOBPCG for one vector on the finest level, in double with the consistent mass, preconditioned by a
// multigrid cycle in float. The basis is x, the preconditioned residual w, the last step p, and the K neighbours that
// the cascade found, so that a cluster does not slow it. Residuals and products with x are computed anew every step.
#include "solvers/lobpcg_refine.h"

#include <cmath>

namespace alcap::detail {
namespace {

using std::complex;
using Dense = MatrixX<complex<double>>;

/// A vector and its products with S and M.
struct Triple {
  ComplexVector v, S, M;
  explicit Triple(std::int64_t rows) : v(rows), S(rows), M(rows) {}
};

/// Positions in the basis; the neighbours follow.
constexpr int at_x = 0, at_w = 1, at_p = 2, at_y = 3;

template <int K>
class Refinement {
 public:
  Refinement(const FinePencil& pencil, const Hierarchy& hierarchy, Block Y, const RefineOptions& options)
      : pencil_(pencil),
        hierarchy_(hierarchy),
        options_(options),
        rows_(pencil.rows()),
        Y_(std::move(Y)),
        x_(rows_),
        w_(rows_),
        p_(rows_),
        workspace_(hierarchy.workspace<1>()) {}

  Refined run() {
    start();
    Refined result;
    double best = 1e300;
    double before = 1e300;
    int since_best = 0;
    bool fresh = true;  // the products of x are no recurrences
    for (;;) {
      residual();
      result.residual = residual_;
      if (residual_ <= options_.tolerance) {
        result.end = Refined::End::converged;
        if (fresh) break;
        refresh();
        fresh = true;
        continue;
      }
      result.end = lambda_ < -options_.negative ? Refined::End::indefinite : Refined::End::limit;
      if (result.end == Refined::End::indefinite || result.iterations >= options_.max_iterations) break;
      result.end = Refined::End::stalled;
      if (residual_ < 0.7 * best) {
        best = residual_;
        since_best = 0;
      } else if (++since_best >= patience) {
        break;
      }
      choose_neighbours(result.iterations);
      const bool cluster = static_cast<Eigen::Index>(basis_.size()) < size;
      if (residual_ > (cluster ? 0.9 : 1.5) * before && !fresh) {
        // Either x turns towards another member of its cluster, along p: a step without p does not. Or its products
        // have drifted: those of the neighbours are single precision.
        forget_p();
        refresh();
        residual();
      }
      before = residual_;
      if (!step()) break;
      ++result.iterations;
      fresh = false;
    }
    result.next = next_;
    result.u = std::move(x_.v);
    return result;
  }

 private:
  /// Iterations without a gain of 30 % after which it will not come. Between members of a cluster x may turn once or
  /// twice before it settles, and the residual grows for a while.
  static constexpr int patience = 15;
  static constexpr Eigen::Index size = K + 2;

  void start() {
    parallel_for(rows_, [&](std::int64_t i) {
      const float* y = Y_.v.data() + 2 * K * i;
      x_.v[i] = {double{y[0]}, double{y[K]}};
    });
    // Products of the vectors as they are, not as recurrences left them.
    pencil_.apply<K>(Y_.v.data(), Y_.S.data(), Y_.M.data());
    const auto g = grams<K, 2, double>(rows_, {{{Y_.v.data(), Y_.S.data()}, {Y_.v.data(), Y_.M.data()}}});
    for (int which = 0; which < 2; ++which) {
      Dense& G = which == 0 ? S_ : M_;
      G = Dense::Zero(size, size);
      const Dense y = 0.5 * (g[static_cast<std::size_t>(which)] + g[static_cast<std::size_t>(which)].adjoint());
      G.bottomRightCorner(K - 1, K - 1) = y.bottomRightCorner(K - 1, K - 1);
      G.row(at_x).tail(K - 1) = y.row(0).tail(K - 1);
      G.col(at_x).tail(K - 1) = y.col(0).tail(K - 1);
    }
    refresh();
  }

  /// Products of x anew; x gets mass 1.
  void refresh() {
    pencil_.apply<1>(reals(x_.v), reals(x_.S), reals(x_.M));
    const double mass = real_dot(x_.v, x_.M);
    if (!(mass > 0)) throw SolveError("the mass matrix is not positive definite");
    const double scale = 1 / std::sqrt(mass);
    parallel_for(rows_, [&](std::int64_t i) {
      x_.v[i] *= scale;
      x_.S[i] *= scale;
      x_.M[i] *= scale;
    });
    for (Dense* G : {&S_, &M_}) {
      G->row(at_x) *= scale;
      G->col(at_x) *= scale;
    }
    M_(at_x, at_x) = 1;
    S_(at_x, at_x) = real_dot(x_.v, x_.S);
    lambda_ = S_(at_x, at_x).real();
  }

  /// The residual, its norm, and the products of x with itself and its neighbours, which would drift as recurrences.
  void residual() {
    float* b = workspace_.b[0].data();
    const double lambda = lambda_;
    constexpr std::size_t width = 4 + 4 * K;
    using Sums = std::array<double, width>;
    const Sums sums = parallel_reduce(
        rows_, Sums{},
        [&](std::int64_t begin, std::int64_t end) {
          Sums sum{};
          for (std::int64_t i = begin; i < end; ++i) {
            const complex<double> x = x_.v[i];
            const complex<double> s = x_.S[i];
            const complex<double> m = x_.M[i];
            const complex<double> r = s - lambda * m;
            b[2 * i] = static_cast<float>(r.real());
            b[2 * i + 1] = static_cast<float>(r.imag());
            sum[0] += std::norm(r);
            sum[1] += std::norm(m);
            sum[2] += x.real() * s.real() + x.imag() * s.imag();
            sum[3] += x.real() * m.real() + x.imag() * m.imag();
            add_neighbours(Y_.v.data() + 2 * K * i, s, m, sum.data() + 4);
          }
          return sum;
        },
        add<width>);
    residual_ = std::sqrt(sums[0] / sums[1]) / std::max(lambda_, options_.floor);
    S_(at_x, at_x) = sums[2];
    M_(at_x, at_x) = sums[3];
    set_neighbours(at_x, sums.data() + 4);
  }

  /// x, w, p and the neighbours; after a few iterations without those whose eigenvalue the tolerance hardly tells from
  /// that of x: they would bring in more rounding (theirs is single precision) than they take out.
  void choose_neighbours(int iteration) {
    constexpr int settled = 3;
    // The eigenvalues of single precision vectors: an error of 6e-8 in high frequencies, squared, times their height.
    constexpr double rounding = 3e-7;
    const double apart = lambda_ + std::max(10 * options_.tolerance, rounding) * std::max(lambda_, options_.floor);
    basis_ = {at_x, at_w, at_p};
    for (int k = 1; k < K; ++k) {
      const int at = at_y + k - 1;
      const double theta = S_(at, at).real() / M_(at, at).real();
      if (iteration < settled || theta > apart) basis_.push_back(at);
    }
  }

  void forget_p() {
    p_used_ = false;
    for (Dense* G : {&S_, &M_}) {
      G->row(at_p).setZero();
      G->col(at_p).setZero();
    }
  }

  bool step() {
    hierarchy_.cycle<1>(workspace_);
    const float* z = workspace_.x[0].data();
    // Without its part along x, which the cycle blows up when S is nearly singular: what is left would drown in it.
    const complex<double> along = parallel_sum<complex<double>>(rows_, [&](std::int64_t i) {
      return std::conj(x_.M[i]) * complex<double>(double{z[2 * i]}, double{z[2 * i + 1]});
    });
    parallel_for(rows_, [&](std::int64_t i) {
      w_.v[i] = complex<double>(double{z[2 * i]}, double{z[2 * i + 1]}) - along * x_.v[i];
    });
    pencil_.apply<1>(reals(w_.v), reals(w_.S), reals(w_.M));
    products_of_w();
    // Without p the basis is smaller: its row is zero then and rayleigh_ritz drops it.
    const auto used = static_cast<Eigen::Index>(basis_.size());
    const Ritz ritz = rayleigh_ritz(S_(basis_, basis_), M_(basis_, basis_), used, 1e-13);
    if (ritz.values.size() == 0 || !ritz.coefficients.allFinite()) return false;
    if (used == size && ritz.values.size() > 1) next_ = ritz.values[1];
    // Among eigenvalues that the tolerance does not tell apart x turns no more than it must: rounding would turn it at
    // random, and each turn brings back the errors of the others.
    const double same = ritz.values[0] + 0.1 * options_.tolerance * std::max(std::abs(ritz.values[0]), options_.floor);
    const Eigen::Index equal = (ritz.values.array() <= same).cast<Eigen::Index>().sum();
    const ComplexVector overlap = ritz.coefficients.leftCols(equal).adjoint() * M_(basis_, at_x);
    ComplexVector c = ComplexVector::Zero(size);
    c(basis_) = ritz.coefficients.col(0);
    if (overlap.norm() > 0.1) c(basis_) = ritz.coefficients.leftCols(equal) * overlap / overlap.norm();
    Dense T = Dense::Identity(size, size);
    T.col(at_x) = c;
    T.col(at_p) = c;
    T(at_x, at_p) = 0;
    T.col(at_w).setZero();
    S_ = T.adjoint() * S_ * T;
    M_ = T.adjoint() * M_ * T;
    lambda_ = ritz.values[0];
    update(c);
    return true;
  }

  void products_of_w() {
    constexpr std::size_t width = 4 * (3 + K);
    using Sums = std::array<double, width>;
    const Sums sums = parallel_reduce(
        rows_, Sums{},
        [&](std::int64_t begin, std::int64_t end) {
          Sums sum{};
          for (std::int64_t i = begin; i < end; ++i) {
            const complex<double> s = w_.S[i];
            const complex<double> m = w_.M[i];
            double* out = sum.data();
            for (const complex<double> v : {x_.v[i], w_.v[i], p_used_ ? p_.v[i] : complex<double>(0)}) {
              out[0] += v.real() * s.real() + v.imag() * s.imag();
              out[1] += v.real() * s.imag() - v.imag() * s.real();
              out[2] += v.real() * m.real() + v.imag() * m.imag();
              out[3] += v.real() * m.imag() - v.imag() * m.real();
              out += 4;
            }
            add_neighbours(Y_.v.data() + 2 * K * i, s, m, out);
          }
          return sum;
        },
        add<width>);
    for (const int v : {at_x, at_w, at_p}) {
      const double* in = sums.data() + 4 * v;
      set(S_, v, at_w, in[0], in[1]);
      set(M_, v, at_w, in[2], in[3]);
    }
    set_neighbours(at_w, sums.data() + 12);
  }

  template <std::size_t N>
  static std::array<double, N> add(std::array<double, N> total, const std::array<double, N>& part) {
    for (std::size_t k = 0; k < N; ++k) total[k] += part[k];
    return total;
  }

  /// Adds conj(y_k) s and conj(y_k) m.
  static void add_neighbours(const float* y, complex<double> s, complex<double> m, double* out) {
    for (int k = 0; k < K; ++k) out[k] += double{y[k]} * s.real() + double{y[K + k]} * s.imag();
    for (int k = 0; k < K; ++k) out[K + k] += double{y[k]} * s.imag() - double{y[K + k]} * s.real();
    for (int k = 0; k < K; ++k) out[2 * K + k] += double{y[k]} * m.real() + double{y[K + k]} * m.imag();
    for (int k = 0; k < K; ++k) out[3 * K + k] += double{y[k]} * m.imag() - double{y[K + k]} * m.real();
  }

  void set_neighbours(int column, const double* in) {
    for (int k = 1; k < K; ++k) {
      set(S_, at_y + k - 1, column, in[k], in[K + k]);
      set(M_, at_y + k - 1, column, in[2 * K + k], in[3 * K + k]);
    }
  }

  static void set(Dense& G, int row, int column, double re, double im) {
    G(row, column) = {re, row == column ? 0 : im};
    G(column, row) = std::conj(G(row, column));
  }

  /// x and p become combinations of the basis.
  void update(const ComplexVector& c) {
    const complex<double> cx = c[at_x];
    const complex<double> cw = c[at_w];
    const complex<double> cp = c[at_p];
    double re[K] = {};  // of the neighbours; the first, the start itself, has none
    double im[K] = {};
    for (int k = 1; k < K; ++k) {
      re[k] = c[at_y + k - 1].real();
      im[k] = c[at_y + k - 1].imag();
    }
    const auto times = [](complex<double> a, complex<double> b) {
      return complex<double>(a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real());
    };
    const auto combine = [&](ComplexVector& x, const ComplexVector& w, ComplexVector& p, const std::vector<float>& Y) {
      parallel_for(rows_, [&](std::int64_t i) {
        const float* y = Y.data() + 2 * K * i;
        double r = 0;
        double s = 0;
        for (int k = 0; k < K; ++k) {
          r += re[k] * double{y[k]} - im[k] * double{y[K + k]};
          s += re[k] * double{y[K + k]} + im[k] * double{y[k]};
        }
        complex<double> direction = times(cw, w[i]) + complex<double>(r, s);
        if (p_used_) direction += times(cp, p[i]);
        p[i] = direction;
        x[i] = times(cx, x[i]) + direction;
      });
    };
    combine(x_.v, w_.v, p_.v, Y_.v);
    combine(x_.S, w_.S, p_.S, Y_.S);
    combine(x_.M, w_.M, p_.M, Y_.M);
    p_used_ = true;
  }

  static double* reals(ComplexVector& v) { return reinterpret_cast<double*>(v.data()); }

  static double real_dot(const ComplexVector& a, const ComplexVector& b) {
    return parallel_sum<double>(a.size(),
                                [&](std::int64_t i) { return a[i].real() * b[i].real() + a[i].imag() * b[i].imag(); });
  }

  const FinePencil& pencil_;
  const Hierarchy& hierarchy_;
  const RefineOptions& options_;
  std::int64_t rows_;
  Block Y_;
  Triple x_, w_, p_;
  bool p_used_ = false;
  std::vector<int> basis_;  // positions in use
  Hierarchy::Workspace workspace_;
  Dense S_, M_;  // Gram matrices of (x, w, p, neighbours)
  double lambda_ = 0;
  double next_ = 0;
  double residual_ = 1;
};

}  // namespace

template <int K>
Refined refine(const FinePencil& pencil, const Hierarchy& hierarchy, Block Y, const RefineOptions& options) {
  return Refinement<K>(pencil, hierarchy, std::move(Y), options).run();
}
template Refined refine<4>(const FinePencil&, const Hierarchy&, Block, const RefineOptions&);
template Refined refine<8>(const FinePencil&, const Hierarchy&, Block, const RefineOptions&);
template Refined refine<16>(const FinePencil&, const Hierarchy&, Block, const RefineOptions&);

}  // namespace alcap::detail
