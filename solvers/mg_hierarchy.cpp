// SPDX-License-Identifier: MIT
//
// mg_hierarchy.cpp: from a matrix to all its levels.
#include "solvers/mg_hierarchy.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

namespace alcap::detail {
namespace {

/// The coarsest level is inverted densely up to this size; that costs a few milliseconds.
constexpr Index dense_rows = 200;
/// Coarsening that keeps more than this part of the rows has come to its end.
constexpr double stalled = 0.8;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// The finest level: A in single precision, couplings against the transport lumped into the diagonal.
Level finest(const Operand& A, const SparseMatrix<std::complex<double>>* transport) {
  const auto n = static_cast<Index>(A.S.rows());
  const Index* start = A.S.outerIndexPtr();
  const Index* row = A.S.innerIndexPtr();
  Level level;
  level.diagonal.resize(at(n));
  level.off.start.assign(at(n) + 1, 0);
  // Row i of A is the conjugate of column i. Calls entry(column, value) for what is kept, returns the diagonal.
  const auto read = [&](Index i, auto&& entry) {
    double diagonal = 0;
    for (std::int64_t e = start[i]; e < start[i + 1]; ++e) {
      const Index j = row[e];
      const std::complex<double> a = std::conj(A.value(e));
      if (j == i) {
        diagonal += a.real();
        continue;
      }
      if (transport != nullptr) {
        const std::complex<double> t = std::conj(transport->valuePtr()[e]);
        const double against = a.real() * t.real() + a.imag() * t.imag();
        if (!(against < 0)) {
          // w |u_i - t u_j|^2 with w = -against / |t| < 0: without it the diagonal is larger by |w|.
          if (against > 0) diagonal += against / std::abs(t);
          continue;
        }
      }
      const ComplexF rounded(static_cast<float>(a.real()), static_cast<float>(a.imag()));
      // The diagonal stays what the rounded entries say, or the energy of smooth vectors is biased.
      diagonal += std::abs(std::complex<double>(rounded)) - std::abs(a);
      entry(j, rounded);
    }
    return diagonal;
  };
  parallel_for(n, [&](std::int64_t i) {
    std::int64_t count = 0;
    static_cast<void>(read(static_cast<Index>(i), [&count](Index, ComplexF) { ++count; }));
    level.off.start[at(i)] = count;
  });
  const std::int64_t total = parallel_exclusive_scan(level.off.start.data(), n);
  level.off.start[at(n)] = total;
  level.off.column.resize(at(total));
  level.off.value.resize(at(total));
  parallel_for(n, [&](std::int64_t i) {
    std::int64_t to = level.off.start[at(i)];
    const double diagonal = read(static_cast<Index>(i), [&](Index j, ComplexF a) {
      level.off.column[at(to)] = j;
      level.off.value[at(to++)] = a;
    });
    level.diagonal[at(i)] = static_cast<float>(diagonal);
  });
  for (Index i = 0; i < n; ++i) {
    if (level.diagonal[at(i)] > 0 && std::isfinite(level.diagonal[at(i)])) continue;
    throw SolveError("multigrid: the matrix is not positive definite (its diagonal is not positive at column " +
                     std::to_string(i) + ")");
  }
  return level;
}

/// Inverse diagonal, and the largest eigenvalue of D^-1 A by the power method, never above Gershgorin's bound.
void prepare_smoother(Level& level) {
  const Index n = level.rows();
  level.inverse.resize(at(n));
  parallel_for(n, [&](std::int64_t i) { level.inverse[at(i)] = 1 / level.diagonal[at(i)]; });
  const float gershgorin = parallel_reduce(
      n, 0.0F,
      [&](std::int64_t begin, std::int64_t end) {
        float most = 0;
        for (std::int64_t i = begin; i < end; ++i) {
          float sum = 0;
          for (std::int64_t e = level.off.start[at(i)]; e < level.off.start[at(i) + 1]; ++e) {
            sum += std::abs(level.off.value[at(e)]);
          }
          most = std::max(most, 1 + sum * level.inverse[at(i)]);
        }
        return most;
      },
      [](float a, float b) { return std::max(a, b); });
  std::vector<ComplexF> x(at(n));
  std::vector<ComplexF> y(at(n));
  parallel_for(n, [&](std::int64_t i) {
    // Any fixed rough vector: two hashes of the row number.
    const auto h = static_cast<std::uint32_t>(i) * 2654435769U;
    x[at(i)] = {static_cast<float>(h >> 16) / 65536.0F - 0.5F,
                static_cast<float>((h * 747796405U) >> 16) / 65536.0F - 0.5F};
  });
  double estimate = 1;
  for (int step = 0; step < 8; ++step) {
    const auto norm = [&](const std::vector<ComplexF>& v) {
      return std::sqrt(
          parallel_sum<double>(n, [&](std::int64_t i) { return double{std::norm(v[at(i)])} * level.diagonal[at(i)]; }));
    };
    for_rows<1>(level.off, reinterpret_cast<const float*>(x.data()), [&](std::int64_t i, const float* sum) {
      y[at(i)] = x[at(i)] + level.inverse[at(i)] * ComplexF(sum[0], sum[1]);
    });
    const double before = norm(x);
    const double after = norm(y);
    if (!(before > 0) || !(after > 0)) break;
    estimate = after / before;
    const auto scale = static_cast<float>(1 / after);
    parallel_for(n, [&](std::int64_t i) { x[at(i)] = scale * y[at(i)]; });
  }
  // The power method comes from below: 1.1 covers what 8 steps leave out.
  level.largest = std::min(gershgorin, static_cast<float>(1.1 * estimate));
}

}  // namespace

void Hierarchy::build(const Operand& A, const SparseMatrix<std::complex<double>>* transport) {
  levels_.clear();
  levels_.push_back(finest(A, transport));
  for (;;) {
    Level& fine = levels_.back();
    prepare_smoother(fine);
    if (fine.rows() <= dense_rows) break;
    const Aggregates aggregates = aggregate(fine);
    if (aggregates.count == 0 || aggregates.count > stalled * fine.rows()) break;
    smooth_prolongation(fine, aggregates);
    Level coarse = galerkin(fine);
    const bool bad = std::any_of(coarse.diagonal.begin(), coarse.diagonal.end(), [](float d) { return !(d > 0); });
    if (bad) {
      fine.prolongation = {};
      fine.restriction = {};
      break;
    }
    levels_.push_back(std::move(coarse));
  }
  invert_coarsest();
}

void Hierarchy::invert_coarsest() {
  coarsest_inverse_.clear();
  const Level& level = levels_.back();
  const Index n = level.rows();
  if (n > dense_rows) return;
  MatrixX<std::complex<double>> A = MatrixX<std::complex<double>>::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    A(i, i) = level.diagonal[at(i)];
    for (std::int64_t e = level.off.start[at(i)]; e < level.off.start[at(i) + 1]; ++e) {
      A(i, level.off.column[at(e)]) = level.off.value[at(e)];
    }
  }
  // Single precision may have made a nearly singular operator a little indefinite: lift it as much as needed.
  double lift = 1e-7 * A.diagonal().real().maxCoeff();
  for (;; lift *= 10) {
    const Eigen::LLT<MatrixX<std::complex<double>>> llt(A);
    if (llt.info() == Eigen::Success) {
      const MatrixX<std::complex<double>> inverse = llt.solve(MatrixX<std::complex<double>>::Identity(n, n));
      coarsest_inverse_.resize(at(n) * at(n));
      for (Index i = 0; i < n; ++i) {
        for (Index j = 0; j < n; ++j) {
          // The Hermitian part: the cycle must be symmetric to its last bit for conjugate gradients.
          coarsest_inverse_[at(i) * at(n) + at(j)] = ComplexF(0.5 * (inverse(i, j) + std::conj(inverse(j, i))));
        }
      }
      return;
    }
    A.diagonal().array() += lift;
  }
}

std::int64_t Hierarchy::nonzeros() const {
  std::int64_t sum = 0;
  for (const Level& l : levels_) {
    sum += l.rows() + static_cast<std::int64_t>(l.off.column.size() + 2 * l.prolongation.column.size());
  }
  return sum;
}

}  // namespace alcap::detail
