// SPDX-License-Identifier: MIT
#include "solvers/eigenpair/patches.h"

#include <algorithm>
#include <utility>

#include "solvers/eigenpair/proof.h"
#include "solvers/linear/backends.h"
#include "src/base/parallel.h"

namespace alcap::detail {
namespace {

/// A mesh of so many rows is one patch. Larger ones are cut into patches of so many, with rings around in which
/// localised vectors fade.
constexpr Eigen::Index whole_rows = 16'000;
constexpr Index core_rows = 4'000;
constexpr int overlap_rings = 10;
/// Patches that are looked at side by side, before what they found lowers the bar for the next.
constexpr std::size_t batch = 16;
/// Vectors within this factor of the lowest are worth keeping.
constexpr double close_to_lowest = 1.1;
/// Vectors that others will refine.
constexpr double local_tolerance = 1e-4;

/// Appends the neighbours of rows[first ...] that `take` accepts.
template <class Take>
void add_ring(const HermitianMatrix& A, std::vector<Index>& rows, std::size_t first, Take&& take) {
  const std::size_t end = rows.size();
  for (std::size_t k = first; k < end; ++k)
    for (HermitianMatrix::InnerIterator it(A, rows[k]); it; ++it)
      if (take(static_cast<Index>(it.row()))) rows.push_back(static_cast<Index>(it.row()));
}

/// The smallest eigenpair of one problem if it lies below sigma.
std::optional<EigenResult> smallest_below(const EigenProblem& problem, const EigenOptions& options, double sigma) {
  const EigenvalueCounter::Count count = EigenvalueCounter(problem).below(sigma, 0);
  if (count.complete) return std::nullopt;
  EigenOptions own = options;
  own.solver = preferred_factorisation();
  own.tolerance = std::max(options.residual_tolerance(), local_tolerance);
  EigenResult result =
      problem.S.rows() <= dense_eigen_rows ? smallest_dense(problem, own) : smallest_lanczos_below(problem, own, sigma);
  if (!(result.report.lambda < sigma)) return std::nullopt;
  return result;
}

std::optional<LocalVector> look_at(const EigenProblem& problem, const EigenOptions& options, double sigma,
                                   const std::vector<Index>& rows) {
  const HermitianMatrix S = block_of(problem.S, rows), M = block_of(problem.M, rows);
  std::optional<EigenResult> result = smallest_below(
      {.S = S, .M = M, .area = problem.area, .transport = same_pattern(S, M) ? &M : nullptr}, options, sigma);
  if (!result) return std::nullopt;
  return LocalVector{.lambda = result->report.lambda, .rows = rows, .u = std::move(result->u)};
}

std::vector<LocalVector> search_whole(const EigenProblem& problem, EigenOptions options, double sigma, std::size_t most,
                                      std::int64_t known) {
  const auto wanted = static_cast<std::int64_t>(most);
  const EigenvalueCounter::Count count = EigenvalueCounter(problem).below(sigma, std::max(wanted, known));
  if (count.complete && count.below <= known) return {};
  options.solver = preferred_factorisation();
  options.tolerance = std::max(options.residual_tolerance(), local_tolerance);
  options.prove_smallest = Prove::never;
  const auto modes = static_cast<int>(std::min<std::int64_t>(wanted, count.below));
  const EigenModes found = find_modes(problem, options, "lanczos", modes);
  std::vector<LocalVector> vectors;
  std::vector<Index> rows(static_cast<std::size_t>(problem.S.rows()));
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = static_cast<Index>(k);
  for (Eigen::Index k = 0; k < found.lambda.size(); ++k)
    vectors.push_back({.lambda = found.lambda[k], .rows = rows, .u = found.U.col(k)});
  return vectors;
}

}  // namespace

HermitianMatrix block_of(const HermitianMatrix& A, const std::vector<Index>& rows) {
  const auto local = [&rows](Index i) {
    const auto at = std::lower_bound(rows.begin(), rows.end(), i);
    return at != rows.end() && *at == i ? static_cast<Index>(at - rows.begin()) : none;
  };
  const auto n = static_cast<Index>(rows.size());
  HermitianMatrix B;  // resized: Eigen's constructors leak where memory runs out in the middle of them
  B.resize(n, n);
  Eigen::Index entries = 0;
  for (const Index j : rows) entries += A.outerIndexPtr()[j + 1] - A.outerIndexPtr()[j];
  B.reserve(entries);
  for (Index j = 0; j < n; ++j) {
    B.startVec(j);
    for (HermitianMatrix::InnerIterator it(A, rows[static_cast<std::size_t>(j)]); it; ++it)
      if (const Index i = local(static_cast<Index>(it.row())); i != none) B.insertBack(i, j) = it.value();
  }
  B.finalize();
  return B;
}

std::vector<std::vector<Index>> patches_of(const HermitianMatrix& A, Index core, int rings) {
  const auto n = static_cast<Index>(A.rows());
  std::vector<Index> patch(static_cast<std::size_t>(n), none);  // of cores, then the last one that saw a row
  std::vector<std::vector<Index>> patches;
  for (Index seed = 0; seed < n; ++seed) {
    if (patch[static_cast<std::size_t>(seed)] != none) continue;
    check_cancelled();
    const auto number = static_cast<Index>(patches.size());
    std::vector<Index>& rows = patches.emplace_back(1, seed);
    patch[static_cast<std::size_t>(seed)] = number;
    const auto free = [&](Index i) {
      if (patch[static_cast<std::size_t>(i)] != none || static_cast<Index>(rows.size()) >= core) return false;
      patch[static_cast<std::size_t>(i)] = number;
      return true;
    };
    for (std::size_t first = 0; first < rows.size();) {
      const std::size_t end = rows.size();
      add_ring(A, rows, first, free);
      first = end;
    }
  }
  std::vector<Index> seen(static_cast<std::size_t>(n), none);
  for (std::size_t p = 0; p < patches.size(); ++p) {
    check_cancelled();
    std::vector<Index>& rows = patches[p];
    for (const Index i : rows) seen[static_cast<std::size_t>(i)] = static_cast<Index>(p);
    std::size_t first = 0;
    for (int ring = 0; ring < rings; ++ring) {
      const std::size_t end = rows.size();
      add_ring(A, rows, first, [&](Index i) {
        return std::exchange(seen[static_cast<std::size_t>(i)], static_cast<Index>(p)) != static_cast<Index>(p);
      });
      first = end;
    }
    std::sort(rows.begin(), rows.end());
  }
  return patches;
}

std::vector<LocalVector> search_patches(const EigenProblem& problem, const EigenOptions& options, double sigma,
                                        std::size_t most, std::int64_t known) {
  const ControlScope scope(options.cancel);
  if (problem.S.rows() <= whole_rows) return search_whole(problem, options, sigma, most, known);
  std::vector<LocalVector> found;
  const std::vector<std::vector<Index>> patches = patches_of(problem.S, core_rows, overlap_rings);
  for (std::size_t begin = 0; begin < patches.size(); begin += batch) {
    const std::size_t count = std::min(batch, patches.size() - begin);
    std::vector<std::optional<LocalVector>> here(count);
    parallel_for(
        static_cast<std::int64_t>(count),
        [&](std::int64_t k) {
          const auto at = static_cast<std::size_t>(k);
          here[at] = look_at(problem, options, sigma, patches[begin + at]);
        },
        1);
    for (std::optional<LocalVector>& vector : here)
      if (vector) found.push_back(std::move(*vector));
    std::stable_sort(found.begin(), found.end(),
                     [](const LocalVector& a, const LocalVector& b) { return a.lambda < b.lambda; });
    if (found.size() > most) found.resize(most);
    if (found.empty()) continue;
    const double lowest = found.front().lambda;
    const double bar = lowest + (close_to_lowest - 1) * std::max(lowest, 1 / problem.area);
    sigma = std::min(sigma, bar);
    std::erase_if(found, [bar](const LocalVector& vector) { return vector.lambda > bar; });
  }
  return found;
}

}  // namespace alcap::detail
