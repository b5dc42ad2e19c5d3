// SPDX-License-Identifier: MIT
//
// cluster.cpp: members of a cluster in double. Single vectors converge to the space of the cluster as fast as to
// an isolated eigenvector once mates are kept out of their search directions; what is left of the residual then lies
// within that space. How members mix there is a small dense problem, and a well-posed one as soon as the space is good:
// its error is the square of theirs.
#include "solvers/eigenpair/cluster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace alcap::detail {
namespace {

using std::complex;
using Dense = MatrixX<complex<double>>;

template <int K>
class Cluster {
 public:
  Cluster(const RefineProblem& problem, Buffer<float> Y, VectorX<double> theta, const RefineOptions& options)
      : problem_(problem),
        rows_(problem.pencil.rows()),
        Y_(std::move(Y)),
        theta_(std::move(theta)),
        options_(options) {}

  Refined run() {
    Refined first = find_first();
    if (options_.second && first.end == Refined::End::converged) find_second(first);
    const bool enough =
        first.among_equals(options_.sine, options_.floor) ||
        (first.next_good ? first.sine(options_.floor) <= options_.sine : first.residual <= residual_with_estimate);
    if (options_.sine > 0 && options_.second && first.residual > options_.tolerance && !enough) refine_again(first);
    return first;
  }

 private:
  Refined find_first() {
    Refined first = refine<K>(problem_, column(0), Y_, theta_, options_);
    if (first.end != Refined::End::stalled) return first;
    const double mate = first.lambda + mates_apart * std::max(first.lambda, options_.floor);
    const auto count = static_cast<int>((theta_.array() <= mate).cast<Eigen::Index>().sum());
    if (count <= 1 || count == K) return first;
    iterations_ = first.iterations;
    theta_[0] = first.lambda;
    members_.push_back(std::move(first.u));
    members_.front() /= first.length;
    for (int k = 1; k < count; ++k) members_.push_back(column(k));
    for (int round = 0; round < most_rounds; ++round) {
      for (int k = 1; k < count; ++k) refine_member(k, member_steps, options_.tolerance);
      if (!part_members()) break;
      first = refine_member(0, options_.max_iterations, enough_outside * options_.tolerance);
      if (first.residual <= options_.tolerance || first.end == Refined::End::indefinite ||
          iterations_ >= options_.max_iterations)
        break;
    }
    if (first.end != Refined::End::indefinite)
      first.end = first.residual <= options_.tolerance ? Refined::End::converged : Refined::End::stalled;
    first.iterations = iterations_;
    first.next = theta_[1];
    first.next_good = true;
    first.length = 1;
    first.u = std::move(members_.front());
    return first;
  }

  /// The second eigenvalue turned out to lie closer than it seemed, or stays an estimate.
  void refine_again(Refined& first) {
    RefineOptions options = options_;
    options.next_good = first.next_good;
    options.second = false;
    options.max_iterations = std::max(0, options_.max_iterations - first.iterations);
    theta_[0] = first.lambda;
    theta_[1] = first.next;
    const int before = first.iterations;
    first = refine<K>(problem_, std::move(first.u), Y_, theta_, options);
    first.iterations += before;
    first.next_good = options.next_good;
  }

  /// The residual at which the second eigenvalue, whose error is its square over the gap to the third, is well within
  /// what `next` promises.
  [[nodiscard]] double enough_for_second() const {
    const double gap = (theta_[2] - theta_[1]) / std::max(theta_[1], options_.floor);
    return std::clamp(std::sqrt(second_part * next_accuracy * gap), least_second_residual, most_second_residual);
  }

  /// Refines the second vector until its eigenvalue is as good as `next` promises.
  void find_second(Refined& first) {
    if (first.next_good) return;
    members_.clear();
    members_.push_back(std::move(first.u));
    members_.front() /= first.length;
    first.length = 1;
    members_.push_back(column(1));
    theta_[0] = first.lambda;
    iterations_ = first.iterations;
    options_.max_iterations += second_steps;
    refine_member(1, second_steps, enough_for_second());
    const auto [S, M] = products_of_members();
    const Ritz ritz = rayleigh_ritz(0.5 * (S + S.adjoint()), 0.5 * (M + M.adjoint()), 2, dependent);
    first.next_good = ritz.values.size() == 2;
    if (first.next_good) first.next = ritz.values[1];
    first.iterations = iterations_;
    first.u = std::move(members_.front());
  }

  /// Three steps took the residuals of mates from 1e-2 to a few 1e-5 (jittered spheres of 328K triangles); the error of
  /// Ritz values is of the order of their squares. Another round goes on from there.
  static constexpr int member_steps = 3;
  static constexpr int most_rounds = 4;
  /// Of the second eigenpair: part of next_accuracy that its residual may use up, and its bounds. Where the third
  /// eigenvalue is close the vector may be a mixture of both.
  static constexpr double second_part = 0.3;
  static constexpr double least_second_residual = 3e-3, most_second_residual = 3e-2;
  static constexpr int second_steps = 10;
  /// Of the tolerance, apart from mates: the rest is for what mates leave.
  static constexpr double enough_outside = 0.3;
  /// Members that differ by less than 1e-5 of their length, of which this is the square, count as one.
  static constexpr double dependent = 1e-10;

  /// Column k of Y.
  [[nodiscard]] ComplexVector column(int k) const {
    ComplexVector z(rows_);
    parallel_for(rows_, [&](std::int64_t i) {
      const float* const y = Y_.data() + 2 * K * i + k;
      z[i] = {double{y[0]}, double{y[K]}};
    });
    return z;
  }

  /// Column k of Y becomes z.
  void set_column(int k, const ComplexVector& z) {
    parallel_for(rows_, [&](std::int64_t i) {
      float* const y = Y_.data() + 2 * K * i + k;
      y[0] = static_cast<float>(z[i].real());
      y[K] = static_cast<float>(z[i].imag());
    });
  }

  /// Some steps for member k, which stays here: the result is without its vector. Member 0 stands in its place among
  /// the neighbours meanwhile.
  Refined refine_member(int k, int steps, double outside) {
    if (k > 0) set_column(k, members_[0]);
    std::swap(theta_[0], theta_[k]);
    RefineOptions options = options_;
    options.member = true;
    options.outside = outside;
    options.max_iterations = std::min(steps, options_.max_iterations - iterations_);
    ComplexVector& z = members_[static_cast<std::size_t>(k)];
    Refined result = refine<K>(problem_, std::move(z), Y_, theta_, options);
    z = std::move(result.u);
    z /= result.length;
    theta_[0] = theta_[k];
    theta_[k] = result.lambda;
    set_column(k, z);
    iterations_ += result.iterations;
    return result;
  }

  /// Z^H S Z and Z^H M Z of the members Z.
  [[nodiscard]] std::array<Dense, 2> products_of_members() const {
    const auto count = static_cast<Eigen::Index>(members_.size());
    Dense S(count, count), M(count, count);
    constexpr std::size_t width = 4 * K;
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto add = [this](std::int64_t first, std::int64_t rows, const complex<double>* Sz,
                              const complex<double>* Mz, std::array<double, width>& sum) {
        for (std::size_t l = 0; l < members_.size(); ++l)
          for (std::int64_t j = 0; j < rows; ++j) {
            const complex<double> z = std::conj(members_[l][first + j]);
            const complex<double> s = z * Sz[j], m = z * Mz[j];
            sum[4 * l] += s.real();
            sum[4 * l + 1] += s.imag();
            sum[4 * l + 2] += m.real();
            sum[4 * l + 3] += m.imag();
          }
      };
      const std::array<double, width> sums =
          problem_.pencil.template sums<width>(members_[static_cast<std::size_t>(k)].data(), add);
      for (Eigen::Index l = 0; l < count; ++l) {
        const double* const sum = sums.data() + 4 * l;
        S(l, k) = {sum[0], sum[1]};
        M(l, k) = {sum[2], sum[3]};
      }
    }
    return {S, M};
  }

  /// Members become the Ritz vectors of their space; false when they are dependent.
  bool part_members() {
    const auto count = static_cast<Eigen::Index>(members_.size());
    const auto [S, M] = products_of_members();
    const Ritz ritz = rayleigh_ritz(0.5 * (S + S.adjoint()), 0.5 * (M + M.adjoint()), count, dependent);
    if (ritz.values.size() < count || !ritz.coefficients.allFinite()) return false;
    parallel_for(rows_, [&](std::int64_t i) {
      complex<double> row[K];
      for (Eigen::Index k = 0; k < count; ++k) row[k] = members_[static_cast<std::size_t>(k)][i];
      for (Eigen::Index k = 0; k < count; ++k) {
        complex<double> sum = 0;
        for (Eigen::Index l = 0; l < count; ++l) sum += ritz.coefficients(l, k) * row[l];
        members_[static_cast<std::size_t>(k)][i] = sum;
      }
    });
    for (Eigen::Index k = 0; k < count; ++k) {
      set_column(static_cast<int>(k), members_[static_cast<std::size_t>(k)]);
      theta_[k] = ritz.values[k];
    }
    return true;
  }

  const RefineProblem& problem_;
  std::int64_t rows_;
  Buffer<float> Y_;
  VectorX<double> theta_;
  RefineOptions options_;
  std::vector<ComplexVector> members_;  // of M-length 1
  int iterations_ = 0;
};

}  // namespace

template <int K>
Refined refine_first(const RefineProblem& problem, Buffer<float> Y, VectorX<double> theta,
                     const RefineOptions& options) {
  return Cluster<K>(problem, std::move(Y), std::move(theta), options).run();
}
template Refined refine_first<4>(const RefineProblem&, Buffer<float>, VectorX<double>, const RefineOptions&);
template Refined refine_first<8>(const RefineProblem&, Buffer<float>, VectorX<double>, const RefineOptions&);
template Refined refine_first<16>(const RefineProblem&, Buffer<float>, VectorX<double>, const RefineOptions&);

}  // namespace alcap::detail
