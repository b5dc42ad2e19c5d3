// SPDX-License-Identifier: MIT
//
// mg_cycle.cpp: the W-cycle with a Chebyshev smoother of degree 2: no sequential dependence, so it runs in parallel and
// its result does not depend on threads.
#include <algorithm>

#include "solvers/mg_hierarchy.h"

namespace alcap::detail {
namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// The smoother damps [largest / 6, largest]; below that is the coarse level's.
constexpr float smoothing_range = 6;

/// Coefficients of two Chebyshev steps: d0 = first D^-1 r, d1 = momentum d0 + second D^-1 (r - A d0), x += d0 + d1.
struct Chebyshev {
  explicit Chebyshev(float largest) {
    const float smallest = largest / smoothing_range;
    const float middle = (largest + smallest) / 2;
    const float half = (largest - smallest) / 2;
    const float sigma = middle / half;
    const float rho0 = 1 / sigma;
    const float rho1 = 1 / (2 * sigma - rho0);
    first = 1 / middle;
    momentum = rho1 * rho0;
    second = 2 * rho1 / half;
  }
  float first, momentum, second;
};

/// x += p(A) (b - A x), or x = p(A) b. On return d and r are used up.
template <int K>
void smooth(const Level& level, const float* b, float* x, float* d, float* r, bool from_zero) {
  constexpr int width = 2 * K;
  const Chebyshev c(level.largest);
  const float* diagonal = level.diagonal.data();
  const float* inverse = level.inverse.data();
  if (from_zero) {
    parallel_for(level.rows(), [=](std::int64_t i) {
      for (int k = 0; k < width; ++k) d[width * i + k] = c.first * inverse[i] * b[width * i + k];
    });
    for_rows<K>(level.off, d, [=](std::int64_t i, const float* sum) {
      const float scale = c.second * inverse[i];
      for (int k = 0; k < width; ++k) {
        const float rest = b[width * i + k] - diagonal[i] * d[width * i + k] - sum[k];
        x[width * i + k] = (1 + c.momentum) * d[width * i + k] + scale * rest;
      }
    });
    return;
  }
  for_rows<K>(level.off, x, [=](std::int64_t i, const float* sum) {
    const float scale = c.first * inverse[i];
    for (int k = 0; k < width; ++k) {
      const float rest = b[width * i + k] - diagonal[i] * x[width * i + k] - sum[k];
      r[width * i + k] = rest;
      d[width * i + k] = scale * rest;
    }
  });
  for_rows<K>(level.off, d, [=](std::int64_t i, const float* sum) {
    const float scale = c.second * inverse[i];
    for (int k = 0; k < width; ++k) {
      const float rest = r[width * i + k] - diagonal[i] * d[width * i + k] - sum[k];
      x[width * i + k] += (1 + c.momentum) * d[width * i + k] + scale * rest;
    }
  });
}

/// x = A^-1 b with the dense inverse.
template <int K>
void solve_densely(const std::vector<ComplexF>& inverse, Index n, const float* b, float* x) {
  const auto* value = reinterpret_cast<const float*>(inverse.data());
  for (Index i = 0; i < n; ++i) {
    float sum[2 * K] = {};
    for (Index j = 0; j < n; ++j) {
      const float ar = value[2 * (std::int64_t{i} * n + j)];
      const float ai = value[2 * (std::int64_t{i} * n + j) + 1];
      const float* z = b + 2 * K * std::int64_t{j};
      for (int k = 0; k < K; ++k) sum[k] += ar * z[k] - ai * z[K + k];
      for (int k = 0; k < K; ++k) sum[K + k] += ar * z[K + k] + ai * z[k];
    }
    std::copy(sum, sum + 2 * K, x + 2 * K * std::int64_t{i});
  }
}

}  // namespace

template <int K>
Hierarchy::Workspace Hierarchy::workspace(std::size_t first) const {
  Workspace w;
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    const std::size_t size = l < first ? 0 : 2 * K * at(levels_[l].rows());
    w.x.emplace_back(size);
    w.b.emplace_back(size);
    w.d.emplace_back(2 * size);
  }
  return w;
}

template <int K>
void Hierarchy::visit(std::size_t l, Workspace& w, bool from_zero) const {
  constexpr int width = 2 * K;
  const Level& level = levels_[l];
  float* x = w.x[l].data();
  float* b = w.b[l].data();
  float* d = w.d[l].data();
  float* r = d + w.x[l].size();
  if (l + 1 == levels_.size()) {
    if (!coarsest_inverse_.empty()) {
      solve_densely<K>(coarsest_inverse_, level.rows(), b, x);
      return;
    }
    // Too many rows left and no more coupling: the smoother converges fast.
    for (int sweep = 0; sweep < 4; ++sweep) smooth<K>(level, b, x, d, r, from_zero && sweep == 0);
    return;
  }
  smooth<K>(level, b, x, d, r, from_zero);
  const float* diagonal = level.diagonal.data();
  for_rows<K>(level.off, x, [=](std::int64_t i, const float* sum) {
    for (int k = 0; k < width; ++k) r[width * i + k] = b[width * i + k] - diagonal[i] * x[width * i + k] - sum[k];
  });
  float* coarse_b = w.b[l + 1].data();
  for_rows<K>(level.restriction, r, [=](std::int64_t i, const float* sum) {
    for (int k = 0; k < width; ++k) coarse_b[width * i + k] = sum[k];
  });
  visit<K>(l + 1, w, true);
  // The second visit makes it a W. The coarsest level is solved exactly at once.
  if (l + 2 < levels_.size()) visit<K>(l + 1, w, false);
  for_rows<K>(level.prolongation, w.x[l + 1].data(), [=](std::int64_t i, const float* sum) {
    for (int k = 0; k < width; ++k) x[width * i + k] += sum[k];
  });
  smooth<K>(level, b, x, d, r, false);
}

#define ALCAP_INSTANTIATE(K)                                                \
  template Hierarchy::Workspace Hierarchy::workspace<K>(std::size_t) const; \
  template void Hierarchy::visit<K>(std::size_t, Workspace&, bool) const;
ALCAP_INSTANTIATE(1)
ALCAP_INSTANTIATE(4)
ALCAP_INSTANTIATE(8)
ALCAP_INSTANTIATE(16)
#undef ALCAP_INSTANTIATE

}  // namespace alcap::detail
