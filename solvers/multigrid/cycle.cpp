// SPDX-License-Identifier: MIT
//
// cycle.cpp: the W-cycle with a Chebyshev smoother of degree 2: no sequential dependence, so it runs in parallel and
// its result does not depend on threads. With a unit diagonal every step is y = p u + q v + s A x, one pass.
#include <algorithm>

#include "solvers/multigrid/hierarchy.h"

namespace alcap::detail {
namespace {

/// The smoother damps [largest / 6, largest]; below that is the coarse level's.
constexpr float smoothing_range = 6;
/// On a coarsest level too large for a dense inverse.
constexpr int coarsest_sweeps = 4;

/// Two Chebyshev steps for a unit diagonal: x += (one + two) r - two A_off r, with r = b - A x.
struct Chebyshev {
  explicit Chebyshev(float largest) {
    const float smallest = largest / smoothing_range;
    const float middle = (largest + smallest) / 2;
    const float half = (largest - smallest) / 2;
    const float sigma = middle / half;
    const float rho0 = 1 / sigma;
    const float rho1 = 1 / (2 * sigma - rho0);
    // d0 = first r, d1 = momentum d0 + second (r - A d0), x += d0 + d1.
    const float first = 1 / middle;
    const float momentum = rho1 * rho0;
    const float second = 2 * rho1 / half;
    off = second * first;
    own = (1 + momentum) * first + second - off;
  }
  float own;  ///< of r
  float off;  ///< of A_off r, subtracted
};

/// r = b - A x.
template <int K>
void residual(const Level& level, const float* x, const float* b, float* r) {
  combine_rows<K>(level.off, x, 1, b, -1, x, -1, r);
}

/// x += p(A) (b - A x), or x = p(A) b. `r` is used up.
template <int K>
void smooth(const Level& level, const float* b, float* x, float* r, bool from_zero) {
  const Chebyshev c(level.largest);
  if (from_zero) {
    combine_rows<K>(level.off, b, c.own, b, 0, nullptr, -c.off, x);
    return;
  }
  residual<K>(level, x, b, r);
  combine_rows<K>(level.off, r, 1, x, c.own, r, -c.off, x);
}

/// x = A^-1 b with the dense inverse.
template <int K>
void solve_densely(const Buffer<ComplexF>& inverse, Index n, const float* b, float* x) {
  const auto* const value = reinterpret_cast<const float*>(inverse.data());
  for (Index i = 0; i < n; ++i) {
    float sum[2 * K] = {};
    for (Index j = 0; j < n; ++j) {
      const float ar = value[2 * (std::int64_t{i} * n + j)];
      const float ai = value[2 * (std::int64_t{i} * n + j) + 1];
      const float* const z = b + 2 * K * std::int64_t{j};
      for (int k = 0; k < K; ++k) sum[k] += ar * z[k] - ai * z[K + k];
      for (int k = 0; k < K; ++k) sum[K + k] += ar * z[K + k] + ai * z[k];
    }
    std::copy(sum, sum + 2 * K, x + 2 * K * std::int64_t{i});
  }
}

template <int K>
void visit(const std::vector<Level>& levels, const Buffer<ComplexF>& inverse, std::size_t l, Hierarchy::Workspace& w,
           bool from_zero) {
  const Level& level = levels[l];
  float* const x = w.x[l].data();
  float* const b = w.b[l].data();
  float* const r = w.r[l].data();
  if (l + 1 == levels.size()) {
    if (inverse.size() > 0) {
      solve_densely<K>(inverse, level.rows(), b, x);
      return;
    }
    // Too many rows left and no more coupling: the smoother converges fast.
    for (int sweep = 0; sweep < coarsest_sweeps; ++sweep) smooth<K>(level, b, x, r, from_zero && sweep == 0);
    return;
  }
  smooth<K>(level, b, x, r, from_zero);
  residual<K>(level, x, b, r);
  multiply_rows<K>(level.restriction, r, w.b[l + 1].data());
  visit<K>(levels, inverse, l + 1, w, true);
  // The second visit makes it a W. The coarsest level is solved exactly at once.
  if (l + 2 < levels.size()) visit<K>(levels, inverse, l + 1, w, false);
  combine_rows<K>(level.prolongation, w.x[l + 1].data(), 1, x, 0, nullptr, 1, x);
  smooth<K>(level, b, x, r, false);
}

}  // namespace

template <int K>
Hierarchy::Workspace Hierarchy::workspace(std::size_t first) const {
  Workspace w;
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    const std::int64_t size = l < first ? 0 : 2 * K * std::int64_t{levels_[l].rows()};
    w.x.emplace_back(size);
    w.b.emplace_back(size);
    w.r.emplace_back(size);
  }
  return w;
}

template <int K>
void Hierarchy::cycle(Workspace& w, std::size_t level, bool from_zero) const {
  visit<K>(levels_, coarsest_inverse_, level, w, from_zero);
}

#define ALCAP_INSTANTIATE(K)                                                \
  template Hierarchy::Workspace Hierarchy::workspace<K>(std::size_t) const; \
  template void Hierarchy::cycle<K>(Workspace&, std::size_t, bool) const;
ALCAP_INSTANTIATE(1)
ALCAP_INSTANTIATE(4)
ALCAP_INSTANTIATE(8)
ALCAP_INSTANTIATE(16)
#undef ALCAP_INSTANTIATE

}  // namespace alcap::detail
