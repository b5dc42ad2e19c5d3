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

/// x += p(A) (b - A x), or x = p(A) b. On return d is workspace used up.
template <int K>
void smooth(const Level& level, const ComplexF* b, ComplexF* x, ComplexF* d, ComplexF* r, bool from_zero) {
  const Chebyshev c(level.largest);
  const float* diagonal = level.diagonal.data();
  const float* inverse = level.inverse.data();
  if (from_zero) {
    parallel_for(level.rows(), [=](std::int64_t i) {
      for (int k = 0; k < K; ++k) d[K * i + k] = c.first * inverse[i] * b[K * i + k];
    });
    for_rows<K>(level.off, d, [=](std::int64_t i, const ComplexF* sum) {
      for (int k = 0; k < K; ++k) {
        const ComplexF rest = b[K * i + k] - diagonal[i] * d[K * i + k] - sum[k];
        x[K * i + k] = (1 + c.momentum) * d[K * i + k] + c.second * inverse[i] * rest;
      }
    });
    return;
  }
  for_rows<K>(level.off, x, [=](std::int64_t i, const ComplexF* sum) {
    for (int k = 0; k < K; ++k) {
      r[K * i + k] = b[K * i + k] - diagonal[i] * x[K * i + k] - sum[k];
      d[K * i + k] = c.first * inverse[i] * r[K * i + k];
    }
  });
  for_rows<K>(level.off, d, [=](std::int64_t i, const ComplexF* sum) {
    for (int k = 0; k < K; ++k) {
      const ComplexF rest = r[K * i + k] - diagonal[i] * d[K * i + k] - sum[k];
      x[K * i + k] += (1 + c.momentum) * d[K * i + k] + c.second * inverse[i] * rest;
    }
  });
}

}  // namespace

template <int K>
Hierarchy::Workspace Hierarchy::workspace() const {
  Workspace w;
  for (const Level& level : levels_) {
    const std::size_t size = K * at(level.rows());
    w.x.emplace_back(size);
    w.b.emplace_back(size);
    w.d.emplace_back(2 * size);
  }
  return w;
}

template <int K>
void Hierarchy::visit(std::size_t l, Workspace& w, bool from_zero) const {
  const Level& level = levels_[l];
  const Index n = level.rows();
  ComplexF* x = w.x[l].data();
  ComplexF* b = w.b[l].data();
  ComplexF* d = w.d[l].data();
  ComplexF* r = d + K * at(n);
  if (l + 1 == levels_.size()) {
    if (coarsest_inverse_.empty()) {
      // Too many rows left and no more coupling: the smoother converges fast.
      for (int sweep = 0; sweep < 4; ++sweep) smooth<K>(level, b, x, d, r, from_zero && sweep == 0);
      return;
    }
    for (Index i = 0; i < n; ++i) {
      ComplexF sum[K] = {};
      for (Index j = 0; j < n; ++j) {
        const ComplexF a = coarsest_inverse_[at(i) * at(n) + at(j)];
        for (int k = 0; k < K; ++k) {
          const ComplexF z = b[K * j + k];
          sum[k] += ComplexF(a.real() * z.real() - a.imag() * z.imag(), a.real() * z.imag() + a.imag() * z.real());
        }
      }
      std::copy(sum, sum + K, x + std::int64_t{K} * i);
    }
    return;
  }
  smooth<K>(level, b, x, d, r, from_zero);
  for_rows<K>(level.off, x, [=, &level](std::int64_t i, const ComplexF* sum) {
    for (int k = 0; k < K; ++k) r[K * i + k] = b[K * i + k] - level.diagonal[at(i)] * x[K * i + k] - sum[k];
  });
  ComplexF* coarse_b = w.b[l + 1].data();
  for_rows<K>(level.restriction, r, [=](std::int64_t i, const ComplexF* sum) {
    for (int k = 0; k < K; ++k) coarse_b[K * i + k] = sum[k];
  });
  visit<K>(l + 1, w, true);
  // The second visit makes it a W. The coarsest level is solved exactly at once.
  if (l + 2 < levels_.size()) visit<K>(l + 1, w, false);
  for_rows<K>(level.prolongation, w.x[l + 1].data(), [=](std::int64_t i, const ComplexF* sum) {
    for (int k = 0; k < K; ++k) x[K * i + k] += sum[k];
  });
  smooth<K>(level, b, x, d, r, false);
}

template Hierarchy::Workspace Hierarchy::workspace<1>() const;
template Hierarchy::Workspace Hierarchy::workspace<4>() const;
template void Hierarchy::visit<1>(std::size_t, Workspace&, bool) const;
template void Hierarchy::visit<4>(std::size_t, Workspace&, bool) const;

}  // namespace alcap::detail
