// SPDX-License-Identifier: MIT
//
// single_vector.cpp: LOBPCG (Knyazev 2001, algorithm 4.1) for one vector on the finest level, in double with the
// consistent mass, preconditioned by a multigrid cycle T in float. A step minimises the Rayleigh quotient
//   lambda(v) = v^H S v / v^H M v   over v in span {x, w, p, y_2 ... y_K},
//   w = T r - x (x^H M T r) / (x^H M x),   r = S x - lambda M x,   p = the last step,
// where y_k are the neighbours that the cascade found: with them in the basis a cluster does not slow it. The minimum
// is the first Ritz vector of the basis (Rayleigh-Ritz), from the Gram matrices B^H S B and B^H M B of (x, w, p, y).
//
// Products with S and M are used where they are computed and never stored: a step reads the matrices twice, once for
// the residual of x and once for w, which is less traffic than recurrences of products, and has no drift.
#include "solvers/eigenpair/single_vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "solvers/linear/backends.h"

namespace alcap::detail {
namespace {

using std::complex;
using Dense = MatrixX<complex<double>>;

/// Positions in the basis; the neighbours follow.
constexpr int at_x = 0, at_w = 1, at_p = 2, at_y = 3;

/// Eigenvalues of single precision vectors are not told apart below this: an error of 6e-8 in high frequencies,
/// squared, times their height.
constexpr double rounding = 3e-7;
/// As long as the residual is large everything helps.
constexpr double large = 1e-2;
/// No progress: no gain of 30 % in so many iterations. Where there are no mates, nothing but patience helps: the
/// worst triangles of a large scan take some iterations each, in which the residual hardly falls.
constexpr double progress = 0.7;
constexpr int patience = 2, longest = 40;
/// A residual of which less than this part lies outside its mates is a mixture of them.
constexpr double mixture = 0.1;
/// Directions that carry less than this of the basis are rounding of double precision.
constexpr double dependent = 1e-13;
/// Ritz values are equal when they differ by less than this part of the tolerance: a tenth of what is asked for. x has
/// a part in their space worth following when it is longer than this.
constexpr double equal_values = 0.1;
constexpr double least_overlap = 0.1;
/// The inverse of the mass is at most this times that of the lumped one, for linear elements.
constexpr double of_lumped = 4;
/// Products of p with itself by differences have 10 digits left when p is not shorter than this beside x, squared.
constexpr double long_enough = 1e-6;

template <int K>
class Refinement {
 public:
  Refinement(const RefineProblem& problem, ComplexVector x, const Buffer<float>& Y, const VectorX<double>& theta,
             const RefineOptions& options)
      : pencil_(problem.pencil),
        hierarchy_(problem.hierarchy),
        near_(problem.hierarchy.levels()[0].near),
        mass_(problem.mass),
        options_(options),
        rows_(pencil_.rows()),
        Y_(Y),
        x_(std::move(x)),
        w_(rows_),
        p_(rows_),
        workspace_(hierarchy_.workspace<1>()),
        S_(Dense::Zero(size, size)),
        M_(Dense::Zero(size, size)),
        lambda_(theta[0]),
        next_(theta[1]) {
    parallel_for(rows_, [&](std::int64_t i) { p_[i] = 0; });
    for (int k = 1; k < K; ++k) {
      S_(at_y + k - 1, at_y + k - 1) = theta[k];
      M_(at_y + k - 1, at_y + k - 1) = 1;
    }
  }

  Refined run() {
    Refined result;
    constexpr double none = std::numeric_limits<double>::infinity();
    double best = none;
    int since_best = 0;
    with_mates_ = !options_.member;
    for (;; ++result.iterations) {
      check_cancelled(options_.cancel);
      residual();
      choose_neighbours();
      const double outside = without_neighbours();
      if (residual_ <= options_.tolerance || small_angle() || (options_.member && outside <= options_.outside)) {
        result.end = Refined::End::converged;
        break;
      }
      result.end = lambda_ < -options_.negative ? Refined::End::indefinite : Refined::End::limit;
      if (result.end == Refined::End::indefinite || result.iterations >= options_.max_iterations) break;
      result.end = Refined::End::stalled;
      // What is left is a mixture of mates, which more iterations will not part.
      if (outside < mixture * residual_ && residual_ < large) break;
      const double left = options_.member ? outside : residual_;
      if (left < progress * best) {
        best = left;
        since_best = 0;
      } else if (++since_best >= (alone() ? longest : patience)) {
        if (!with_mates_ || alone()) break;
        with_mates_ = false;
        best = none;
        since_best = 0;
        forget_p();
        choose_neighbours();
        without_neighbours();
      }
      if (!step()) break;
    }
    result.residual = residual_;
    result.lambda = lambda_;
    result.length = std::sqrt(M_(at_x, at_x).real());
    result.distance = distance_;
    result.next = next_;
    result.u = std::move(x_);
    return result;
  }

 private:
  [[nodiscard]] bool small_angle() const {
    if (options_.sine == 0 || options_.member) return false;
    Refined now;
    now.lambda = lambda_;
    now.distance = distance_;
    if (now.among_equals(options_.sine, options_.floor)) return true;
    // Where the second vector is refined afterwards the estimate is looked at again.
    if (!options_.second && !options_.next_good && residual_ > residual_with_estimate) return false;
    now.next = next_;
    now.next_good = options_.next_good;
    return now.sine(options_.floor) <= options_.sine;
  }

  /// Of the whole basis: x, w, p and K - 1 neighbours.
  static constexpr Eigen::Index size = K + 2;

  /// The residual, its norm, lambda, and the products of x with itself, p and its neighbours.
  void residual() {
    float* const b = workspace_.b[0].data();
    std::fill_n(removed_, K, false);
    // The Rayleigh quotient is only known behind the pass: the residual is that of the Ritz value, which is the same
    // but for rounding and, at the start, for the single precision of the neighbours.
    const double lambda = lambda_;
    constexpr std::size_t width = 9 + 4 * K;
    const std::array<double, width> sums =
        pencil_.template sums<width>(x_.data(), [&](std::int64_t first, std::int64_t count, const complex<double>* Sx,
                                                    const complex<double>* Mx, std::array<double, width>& sum) {
          for (std::int64_t j = 0; j < count; ++j) {
            const std::int64_t i = first + j;
            const complex<double> x = x_[i], s = Sx[j], m = Mx[j];
            const complex<double> r = s - lambda * m;
            b[2 * i] = static_cast<float>(r.real()) / near_[i];
            b[2 * i + 1] = static_cast<float>(r.imag()) / near_[i];
            sum[0] += r.real() * r.real() + r.imag() * r.imag();
            sum[1] += m.real() * m.real() + m.imag() * m.imag();
            sum[2] += x.real() * s.real() + x.imag() * s.imag();
            sum[3] += x.real() * m.real() + x.imag() * m.imag();
            sum[4] += double{b[2 * i] * b[2 * i] + b[2 * i + 1] * b[2 * i + 1]} / double{mass_[i]};
            add_products(p_[i], s, m, sum.data() + 5);
          }
          add_neighbours(first, count, Sx, Mx, sum.data() + 9);
        });
    if (!(sums[3] > 0)) throw SolveError("the mass matrix M is not positive definite");
    residual_unit_ = std::sqrt(sums[1]) * std::max(lambda_, options_.floor);
    residual_ = std::sqrt(sums[0]) / residual_unit_;
    lambda_ = sums[2] / sums[3];
    S_(at_x, at_x) = sums[2];
    M_(at_x, at_x) = sums[3];
    distance_ = std::sqrt(of_lumped * sums[4] / sums[3]);
    set_products(at_p, at_x, sums.data() + 5);
    set_neighbours(at_x, sums.data() + 9);
    if (p_used_) products_of_p();
  }

  /// p is the new x without its part of the old one, p = x - old_part old_x: its products follow from those of the two,
  /// p^H S y = x^H S y - conj(old_part) old_x^H S y. Anything else would carry the single precision of the products
  /// among neighbours into those of an ever shorter p.
  void products_of_p() {
    for (int k = at_y; k < size; ++k) {
      S_(at_p, k) = S_(at_x, k) - std::conj(old_part_) * old_S_(0, k);
      M_(at_p, k) = M_(at_x, k) - std::conj(old_part_) * old_M_(0, k);
      S_(k, at_p) = std::conj(S_(at_p, k));
      M_(k, at_p) = std::conj(M_(at_p, k));
    }
    // For the same reason p's products with itself, as long as they are no small differences.
    if (M_(at_p, at_p).real() > long_enough * M_(at_x, at_x).real()) {
      const double square = std::norm(old_part_);
      S_(at_p, at_p) = square * old_S_(0, at_x) + 2 * S_(at_x, at_p).real() - S_(at_x, at_x);
      M_(at_p, at_p) = square * old_M_(0, at_x) + 2 * M_(at_x, at_p).real() - M_(at_x, at_x);
    }
  }

  /// Whether neighbour k has an eigenvalue beyond that of x by more than this part of it.
  [[nodiscard]] bool apart(int k, double part) const {
    return S_(k, k).real() > (lambda_ + part * std::max(lambda_, options_.floor)) * M_(k, k).real();
  }

  /// Whether x has no mates.
  [[nodiscard]] bool alone() const {
    for (int k = at_y; k < size; ++k)
      if (!apart(k, mates_apart)) return false;
    return true;
  }

  /// x, w, p and the neighbours, with or without the mates of x.
  void choose_neighbours() {
    basis_ = {at_x, at_w, at_p};
    for (int k = at_y; k < size; ++k)
      if ((residual_ > large && !options_.member) || apart(k, with_mates_ ? rounding : mates_apart))
        basis_.push_back(k);
  }

  [[nodiscard]] bool used(int k) const { return std::find(basis_.begin(), basis_.end(), k) != basis_.end(); }

  void forget_p() {
    p_used_ = false;
    for (Dense* G : {&S_, &M_}) {
      G->row(at_p).setZero();
      G->col(at_p).setZero();
    }
  }

  /// Takes the parts along neighbours that were let go out of the residual; returns what is left, as residual_. The
  /// cycle would answer to these with the neighbours as coarse levels know them, and basis() would leave what is wrong
  /// with them in w: x could come to rest where that cancels the answer to all else. The lumped mass is good enough.
  double without_neighbours() {
    float re[K] = {}, im[K] = {};
    bool any = false;
    for (int k = 1; k < K; ++k) {
      const int at = at_y + k - 1;
      if (used(at) || removed_[k]) continue;
      removed_[k] = true;
      const complex<double> part = S_(at, at_x) - lambda_ * M_(at, at_x);
      re[k] = static_cast<float>(part.real());
      im[k] = static_cast<float>(part.imag());
      any = true;
    }
    if (!any) return residual_;
    float* const b = workspace_.b[0].data();
    const double square = parallel_sum<double>(rows_, [&](std::int64_t i) {
      const float* const y = Y_.data() + 2 * K * i;
      float sum_re = 0;
      float sum_im = 0;
      for (int k = 0; k < K; ++k) {
        sum_re += re[k] * y[k] - im[k] * y[K + k];
        sum_im += re[k] * y[K + k] + im[k] * y[k];
      }
      const float m = near_[i] * mass_[i];
      b[2 * i] -= m * sum_re;
      b[2 * i + 1] -= m * sum_im;
      return double{near_[i]} * near_[i] * (double{b[2 * i]} * b[2 * i] + double{b[2 * i + 1]} * b[2 * i + 1]);
    });
    return std::sqrt(square) / residual_unit_;
  }

  /// w is the cycle's answer without its part along x, which the cycle blows up when S is nearly singular: what is left
  /// would drown in it. The lumped mass is good enough for that.
  void direction() {
    hierarchy_.cycle<1>(workspace_);
    const float* const z = workspace_.x[0].data();
    using Sums = std::array<double, 3>;
    const Sums sums = parallel_reduce(
        rows_, Sums{},
        [&](std::int64_t begin, std::int64_t end) {
          Sums sum{};
          for (std::int64_t i = begin; i < end; ++i) {
            const complex<double> x = x_[i];
            // x as a scaled vector is near x; z is scaled already.
            const double m = double{mass_[i]} * double{near_[i]};
            sum[0] += m * (x.real() * double{z[2 * i]} + x.imag() * double{z[2 * i + 1]});
            sum[1] += m * (x.real() * double{z[2 * i + 1]} - x.imag() * double{z[2 * i]});
            sum[2] += m * double{near_[i]} * (x.real() * x.real() + x.imag() * x.imag());
          }
          return sum;
        },
        add);
    const double re = sums[0] / sums[2], im = sums[1] / sums[2];
    parallel_for(rows_, [&](std::int64_t i) {
      const double scale = 1 / double{near_[i]};
      const complex<double> x = x_[i];
      w_[i] = {scale * double{z[2 * i]} - (re * x.real() - im * x.imag()),
               scale * double{z[2 * i + 1]} - (re * x.imag() + im * x.real())};
    });
  }

  /// The basis in terms of x, w, p and all neighbours: w and p without their parts along neighbours that were let go,
  /// or x would turn towards these through them.
  [[nodiscard]] Dense basis() const {
    Dense B = Dense::Zero(size, static_cast<Eigen::Index>(basis_.size()));
    for (std::size_t b = 0; b < basis_.size(); ++b) B(basis_[b], static_cast<Eigen::Index>(b)) = 1;
    for (int k = at_y; k < size; ++k) {
      if (used(k)) continue;
      for (const int v : {at_w, at_p}) B(k, v) = -M_(k, v) / M_(k, k);
    }
    return B;
  }

  /// One step of LOBPCG; false when the basis has nothing new.
  bool step() {
    direction();
    products_of_w();
    // Without p the basis is smaller: its row is zero then and rayleigh_ritz drops it.
    const auto count = static_cast<Eigen::Index>(basis_.size());
    const Dense B = basis();
    const Ritz ritz = rayleigh_ritz(B.adjoint() * S_ * B, B.adjoint() * M_ * B, count, dependent);
    if (ritz.values.size() == 0 || !ritz.coefficients.allFinite()) return false;
    if (count == size && ritz.values.size() > 1) next_ = ritz.values[1];
    // Among eigenvalues that the tolerance does not tell apart x turns no more than it must: rounding would turn it at
    // random, and each turn brings back the errors of the others.
    const double same =
        ritz.values[0] + equal_values * options_.tolerance * std::max(std::abs(ritz.values[0]), options_.floor);
    const Eigen::Index equal = (ritz.values.array() <= same).cast<Eigen::Index>().sum();
    const ComplexVector overlap = ritz.coefficients.leftCols(equal).adjoint() * (B.adjoint() * M_.col(at_x));
    ComplexVector c = B * ritz.coefficients.col(0);
    if (overlap.norm() > least_overlap) c = B * (ritz.coefficients.leftCols(equal) * overlap / overlap.norm());
    lambda_ = ritz.values[0];
    advance_products(c);
    update(c);
    return true;
  }

  /// The Gram matrices after x := (x, w, p, y) c and p := x without its part of the old x; w is used up.
  void advance_products(const ComplexVector& c) {
    old_S_ = S_.row(at_x);
    old_M_ = M_.row(at_x);
    old_part_ = c[at_x];
    p_used_ = true;
    Dense T = Dense::Identity(size, size);
    T.col(at_x) = c;
    T.col(at_p) = c;
    T(at_x, at_p) = 0;
    T.col(at_w).setZero();
    S_ = T.adjoint() * S_ * T;
    M_ = T.adjoint() * M_ * T;
  }

  /// Products of w with the basis.
  void products_of_w() {
    constexpr std::size_t width = 12 + 4 * K;
    const std::array<double, width> sums =
        pencil_.template sums<width>(w_.data(), [&](std::int64_t first, std::int64_t count, const complex<double>* Sw,
                                                    const complex<double>* Mw, std::array<double, width>& sum) {
          for (std::int64_t j = 0; j < count; ++j) {
            add_products(x_[first + j], Sw[j], Mw[j], sum.data());
            add_products(w_[first + j], Sw[j], Mw[j], sum.data() + 4);
            add_products(p_[first + j], Sw[j], Mw[j], sum.data() + 8);
          }
          add_neighbours(first, count, Sw, Mw, sum.data() + 12);
        });
    for (const int v : {at_x, at_w, at_p}) set_products(v, at_w, sums.data() + 4 * v);
    set_neighbours(at_w, sums.data() + 12);
  }

  static std::array<double, 3> add(std::array<double, 3> total, const std::array<double, 3>& part) {
    for (std::size_t k = 0; k < 3; ++k) total[k] += part[k];
    return total;
  }

  /// Adds conj(v) s and conj(v) m.
  static void add_products(complex<double> v, complex<double> s, complex<double> m, double* out) {
    out[0] += v.real() * s.real() + v.imag() * s.imag();
    out[1] += v.real() * s.imag() - v.imag() * s.real();
    out[2] += v.real() * m.real() + v.imag() * m.imag();
    out[3] += v.real() * m.imag() - v.imag() * m.real();
  }

  void set_products(int row, int column, const double* in) {
    set(S_, row, column, in[0], in[1]);
    set(M_, row, column, in[2], in[3]);
  }

  /// Adds y_k^H s and y_k^H m over some rows.
  void add_neighbours(std::int64_t first, std::int64_t count, const complex<double>* s, const complex<double>* m,
                      double* out) const {
    vector_kernels<K>().products(Y_.data() + 2 * K * first, as_pairs(s), as_pairs(m), count, out);
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
    double of_y[2 * K] = {};  // the first neighbour, the start itself, has no part
    for (int k = 1; k < K; ++k) {
      of_y[k] = c[at_y + k - 1].real();
      of_y[K + k] = c[at_y + k - 1].imag();
    }
    static_assert(at_x == 0 && at_w == 1 && at_p == 2);
    parallel_ranges(rows_, mg_grain, [&](std::int64_t begin, std::int64_t end) {
      vector_kernels<K>().advance(as_pairs(c.data()), of_y, Y_.data() + 2 * K * begin, as_pairs(w_.data() + begin),
                                  end - begin, as_pairs(p_.data() + begin), as_pairs(x_.data() + begin));
    });
  }

  const FinePencil& pencil_;
  const Hierarchy& hierarchy_;
  const Buffer<float>& near_;
  const Buffer<float>& mass_;
  const RefineOptions& options_;
  std::int64_t rows_;
  const Buffer<float>& Y_;
  ComplexVector x_, w_, p_;  // the iterate, its preconditioned residual, the last step
  std::vector<int> basis_;   // positions in use
  Hierarchy::Workspace workspace_;
  Dense S_, M_;          // Gram matrices of (x, w, p, neighbours)
  Dense old_S_, old_M_;  // products of the x before, with all
  complex<double> old_part_ = 0;
  bool removed_[K] = {};  // neighbours whose parts are out of the residual
  bool p_used_ = false;
  bool with_mates_ = true;
  double lambda_ = 0;
  double next_ = 0;
  double residual_ = 1;
  double distance_ = 0;
  double residual_unit_ = 1;
};

}  // namespace

template <int K>
Refined refine(const RefineProblem& problem, ComplexVector x, const Buffer<float>& Y, const VectorX<double>& theta,
               const RefineOptions& options) {
  return Refinement<K>(problem, std::move(x), Y, theta, options).run();
}
template Refined refine<4>(const RefineProblem&, ComplexVector, const Buffer<float>&, const VectorX<double>&,
                           const RefineOptions&);
template Refined refine<8>(const RefineProblem&, ComplexVector, const Buffer<float>&, const VectorX<double>&,
                           const RefineOptions&);
template Refined refine<16>(const RefineProblem&, ComplexVector, const Buffer<float>&, const VectorX<double>&,
                            const RefineOptions&);

}  // namespace alcap::detail
