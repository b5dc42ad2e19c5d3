// SPDX-License-Identifier: MIT
//
// hierarchy.cpp: from a matrix to all its levels.
#include "solvers/multigrid/hierarchy.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "solvers/dense/hermitian.h"
#include "solvers/linear/backends.h"

namespace alcap::detail {
namespace {

/// The coarsest level is inverted densely up to this size; that costs about a millisecond.
constexpr Index dense_rows = 96;
/// Coarsening that keeps more than this part of the rows has come to its end.
constexpr double stalled = 0.8;
/// Of the unit diagonal: the first attempt to make a coarsest matrix positive definite again, and what it grows by.
constexpr double first_lift = 1e-7;
constexpr double lift_growth = 10;

/// Where the rows of A start without their diagonal entries; memory for as many entries.
Rows off_diagonal_rows(const SparseMatrix<std::complex<double>>& A) {
  const auto n = static_cast<Index>(A.rows());
  const Index* const start = A.outerIndexPtr();
  const Index* const row = A.innerIndexPtr();
  Rows off;
  off.start = Buffer<std::int64_t>(std::int64_t{n} + 1);
  parallel_for(n, [&](std::int64_t i) {
    std::int64_t count = 0;
    for (Index e = start[i]; e < start[i + 1]; ++e) count += row[e] != i;
    off.start[i] = count;
  });
  off.start[n] = 0;
  const std::int64_t total = parallel_exclusive_scan(off.start.data(), std::int64_t{n} + 1);
  off.column = Buffer<Index>(total);
  off.value = Buffer<ComplexF>(total);
  return off;
}

/// Fills level.off (and level.guide) with the entries of A as they are, level.guide_near with the roots of the guide's
/// diagonal; returns the diagonal of A.
Buffer<double> copy_entries(const Operand& A, const SparseMatrix<std::complex<double>>* transport, Level& level) {
  const Index n = level.rows();
  const Index* const start = A.S.outerIndexPtr();
  const Index* const row = A.S.innerIndexPtr();
  Rows& off = level.off;
  Buffer<double> diagonal(n);
  // Row i of A is the conjugate of column i.
  parallel_for(n, [&](std::int64_t i) {
    std::int64_t to = off.start[i];
    double sum = 0;
    double lumped = 0;
    for (Index e = start[i]; e < start[i + 1]; ++e) {
      const std::complex<double> a = std::conj(A.value(e));
      if (row[e] == i) {
        sum += a.real();
        continue;
      }
      const ComplexF kept(static_cast<float>(a.real()), static_cast<float>(a.imag()));
      if (transport != nullptr) {
        const std::complex<double> t = std::conj(transport->valuePtr()[e]);
        const double against = a.real() * t.real() + a.imag() * t.imag();
        // w |u_i - t u_j|^2 with w = -against / |t| < 0: without it the diagonal is larger by |w|.
        if (against > 0) lumped += against / std::sqrt(std::norm(t));
        level.guide[to] = against < 0 ? kept : 0;
      }
      off.column[to] = row[e];
      off.value[to++] = kept;
    }
    diagonal[i] = sum;
    if (transport != nullptr) level.guide_near[i] = static_cast<float>(std::sqrt(sum + lumped));
  });
  return diagonal;
}

/// value_ij := scale value_ij / (near_i near_j).
void scale_entries(const Rows& pattern, float scale, const Buffer<float>& near, Buffer<ComplexF>& value) {
  parallel_for(pattern.rows(), [&](std::int64_t i) {
    const float own = scale / near[i];
    for (std::int64_t e = pattern.start[i]; e < pattern.start[i + 1]; ++e) value[e] *= own / near[pattern.column[e]];
  });
}

/// The finest level: A in single precision, N^-1 A N^-1 / unit with N^2 = diag(A) / unit, `unit` the mean diagonal.
/// With a transport its guide has couplings against that lumped into the diagonal; they stay as zeros, so that the
/// pattern is that of A.
Level finest(const Operand& A, const SparseMatrix<std::complex<double>>* transport, double& unit) {
  const auto n = static_cast<Index>(A.S.rows());
  Level level;
  level.off = off_diagonal_rows(A.S);
  if (transport != nullptr) {
    level.guide = Buffer<ComplexF>(level.off.nonzeros());
    level.guide_near = Buffer<float>(n);
  }
  level.near = Buffer<float>(n);
  const Buffer<double> diagonal = copy_entries(A, transport, level);
  for (Index i = 0; i < n; ++i) {
    if (diagonal[i] > 0 && std::isfinite(diagonal[i])) continue;
    throw SolveError("multigrid: the matrix is not positive definite (its diagonal is not positive at column " +
                     std::to_string(i) + ")");
  }
  unit = parallel_sum<double>(n, [&](std::int64_t i) { return diagonal[i]; }) / static_cast<double>(n);
  parallel_for(n, [&](std::int64_t i) { level.near[i] = static_cast<float>(std::sqrt(diagonal[i] / unit)); });
  const auto scale = static_cast<float>(1 / unit);
  scale_entries(level.off, scale, level.near, level.off.value);
  if (transport != nullptr) {
    parallel_for(n, [&](std::int64_t i) { level.guide_near[i] /= std::sqrt(static_cast<float>(unit)); });
    scale_entries(level.off, scale, level.guide_near, level.guide);
  }
  return level;
}

/// By how much the couplings of row i, along the near-null vector, exceed the diagonal: 0 without couplings of the
/// wrong sign (obtuse angles).
float excess(const Level& level, std::int64_t i) {
  float sum = 0;
  for (std::int64_t e = level.off.start[i]; e < level.off.start[i + 1]; ++e)
    sum += std::sqrt(std::norm(level.off.value[e])) * level.near[level.off.column[e]];
  return std::max(0.0F, sum / level.near[i] - 1);
}

/// The largest eigenvalue by the power method, from a rough vector with lengths weight(i).
template <class Weight>
double power_method(const Level& level, Weight&& weight) {
  constexpr int steps = 6;
  const Index n = level.rows();
  Buffer<ComplexF> x(n), y(n);
  parallel_for(n, [&](std::int64_t i) {
    // Any fixed rough vector: two hashes of the row number.
    const auto h = static_cast<std::uint32_t>(i) * 2654435769U;
    x[i] = weight(i) * ComplexF(static_cast<float>(h >> 16) / 65536.0F - 0.5F,
                                static_cast<float>((h * 747796405U) >> 16) / 65536.0F - 0.5F);
  });
  for (int step = 0; step < steps; ++step) {
    const auto* const from = reinterpret_cast<const float*>(x.data());
    combine_rows<1>(level.off, from, 1, from, 0, nullptr, 1, reinterpret_cast<float*>(y.data()));
    std::swap(x, y);
  }
  const auto square = [n](const Buffer<ComplexF>& v) {
    return parallel_sum<double>(n, [&](std::int64_t i) { return double{std::norm(v[i])}; });
  };
  const double before = square(y);
  return before > 0 ? std::sqrt(square(x) / before) : 1;
}

/// A bound of the spectrum of a level, give or take a percent.
float largest_eigenvalue(const Level& level) {
  // The power method comes from below: after so many steps by less than this factor.
  constexpr double margin = 1.12;
  double largest = power_method(level, [](std::int64_t) { return 1.0F; });
  // The largest eigenvectors live on the worst slivers, which a vector that is as large everywhere does not find.
  constexpr float little = 0.1F;
  const float worst = parallel_reduce(
      std::int64_t{level.rows()}, 0.0F,
      [&](std::int64_t begin, std::int64_t end) {
        float most = 0;
        for (std::int64_t i = begin; i < end; ++i) most = std::max(most, excess(level, i));
        return most;
      },
      [](float a, float b) { return std::max(a, b); });
  if (worst > little) {
    largest = std::max(largest, power_method(level, [&](std::int64_t i) {
                         const float part = excess(level, i) / worst;
                         return part * part;
                       }));
  }
  return static_cast<float>(margin * largest);
}

}  // namespace

void Hierarchy::build(const Operand& A, const SparseMatrix<std::complex<double>>* transport,
                      const std::function<bool()>& cancel) {
  levels_.clear();
  levels_.push_back(finest(A, transport, unit_));
  for (;;) {
    check_cancelled(cancel);
    Level& fine = levels_.back();
    fine.largest = largest_eigenvalue(fine);
    if (fine.rows() <= dense_rows) break;
    const Aggregates aggregates = aggregate(fine);
    if (aggregates.count == 0 || static_cast<double>(aggregates.count) > stalled * static_cast<double>(fine.rows()))
      break;
    smooth_prolongation(fine, aggregates);
    Level coarse = galerkin(fine);
    fine.guide = {};
    fine.guide_near = {};
    if (coarse.rows() == 0) {
      fine.prolongation = {};
      fine.restriction = {};
      break;
    }
    levels_.push_back(std::move(coarse));
  }
  invert_coarsest();
}

void Hierarchy::shift(std::vector<Buffer<float>>& masses, float sigma) {
  // Levels whose diagonal would lose more than this part of it do not resolve the vectors in question.
  constexpr float most = 0.5F;
  // Row and column factors; an empty one is 1.
  const auto rescale = [](Rows& A, const Buffer<float>& rows, const Buffer<float>& columns) {
    parallel_for(A.rows(), [&](std::int64_t i) {
      const float own = rows.size() == 0 ? 1 : rows[i];
      for (std::int64_t e = A.start[i]; e < A.start[i + 1]; ++e)
        A.value[e] *= own * (columns.size() == 0 ? 1 : columns[A.column[e]]);
    });
  };
  Buffer<float> root;  // of the new diagonal, on the level before
  for (std::size_t l = 0; l + 1 < levels_.size(); ++l) {
    Level& coarse = levels_[l + 1];
    float* const mass = masses[l + 1].data();
    const float largest = parallel_reduce(
        std::int64_t{coarse.rows()}, 0.0F,
        [=](std::int64_t begin, std::int64_t end) { return *std::max_element(mass + begin, mass + end); },
        [](float a, float b) { return std::max(a, b); });
    const bool resolved = sigma * largest <= most;
    Buffer<float> next, inverse;
    if (resolved) {
      next = Buffer<float>(coarse.rows());
      inverse = Buffer<float>(coarse.rows());
      parallel_for(coarse.rows(), [&](std::int64_t i) {
        next[i] = std::sqrt(1 - sigma * mass[i]);
        inverse[i] = 1 / next[i];
        mass[i] *= inverse[i] * inverse[i];
      });
      rescale(coarse.off, inverse, inverse);
    }
    rescale(levels_[l].prolongation, root, inverse);
    rescale(levels_[l].restriction, inverse, root);
    root = std::move(next);
    if (!resolved) break;
  }
  invert_coarsest();
}

void Hierarchy::invert_coarsest() {
  coarsest_inverse_ = {};
  const Level& level = levels_.back();
  const Index n = level.rows();
  if (n > dense_rows) return;
  MatrixX<std::complex<double>> A = MatrixX<std::complex<double>>::Identity(n, n);
  for (Index i = 0; i < n; ++i)
    for (std::int64_t e = level.off.start[i]; e < level.off.start[i + 1]; ++e)
      A(i, level.off.column[e]) = level.off.value[e];
  // Single precision may have made a nearly singular operator a little indefinite: lift it as much as needed.
  for (double lift = first_lift;; lift *= lift_growth) {
    if (const auto found = hermitian_inverse(A)) {
      const MatrixX<std::complex<double>>& inverse = *found;
      coarsest_inverse_ = Buffer<ComplexF>(std::int64_t{n} * n);
      for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < n; ++j) {
          // The Hermitian part: the cycle must be symmetric to its last bit for conjugate gradients.
          coarsest_inverse_[std::int64_t{i} * n + j] = ComplexF(0.5 * (inverse(i, j) + std::conj(inverse(j, i))));
        }
      return;
    }
    A.diagonal().array() += lift;
  }
}

std::int64_t Hierarchy::nonzeros() const {
  std::int64_t sum = 0;
  for (const Level& l : levels_) sum += l.rows() + l.off.nonzeros() + 2 * l.prolongation.nonzeros();
  return sum;
}

}  // namespace alcap::detail
