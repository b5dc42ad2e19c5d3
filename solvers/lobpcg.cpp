// SPDX-License-Identifier: MIT
//
// lobpcg.cpp: smallest eigenpair by a cascade: block LOBPCG (Knyazev 2001) on every level of the multigrid hierarchy of
// S - sigma M, coarsest first, a few steps each, with the cycle from that level as preconditioner; then one vector in
// double on the finest, with the consistent mass. The other vectors of the block stay in its basis, so that clusters of
// eigenvalues (round spheres have 2n + 1 equal ones) do not slow it down.
//
// Memory beyond the input: the hierarchy (about 240 bytes a row) and 36 single precision vectors (K = 4) or 12 double
// ones, whatever is more.
#include <algorithm>
#include <cmath>
#include <string>

#include "alcap/detail/random.h"
#include "solvers/backends.h"
#include "solvers/lobpcg_refine.h"

namespace alcap::detail {
namespace {

/// Shift in units of -1/area, as in lanczos_spectra.cpp: definite also when S is singular.
constexpr double relative_shift = 1e-3;
/// Up to here a factorisation is quicker whatever the spectrum, and reaches the last digit.
constexpr Eigen::Index factorised_rows = 512;
/// Steps of block LOBPCG from random vectors on the coarsest level, on the levels between, and on the finest.
constexpr int coarsest_steps = 6;
constexpr int level_steps = 3;
constexpr int finest_steps = 1;
/// Second eigenvalues within this factor of the first make a cluster; it takes so many more steps on the finest level.
constexpr double cluster = 1.03;
constexpr int cluster_steps = 4;
/// The second eigenvalue is information: at most so many steps more until it changes by no more than this.
constexpr int next_steps = 3;
constexpr double settled = 1e-3;
/// A block ends where eigenvalues have grown by this factor: what lies beyond converges fast.
constexpr double gap = 1.4;
/// Refinement that needs more iterations than this would be slower than a factorisation.
constexpr int refine_limit = 100;

/// The level's vectors from those of the next coarser one, K of the C there.
template <int K, int C>
std::vector<float> prolonged(const Level& level, const std::vector<float>& coarse) {
  std::vector<float> narrow;
  const std::vector<float>* from = &coarse;
  if constexpr (K != C) {
    const auto rows = static_cast<std::int64_t>(coarse.size()) / (2 * C);
    narrow.resize(static_cast<std::size_t>(2 * K * rows));
    for (std::int64_t i = 0; i < rows; ++i) {
      std::copy_n(coarse.data() + 2 * C * i, K, narrow.data() + 2 * K * i);
      std::copy_n(coarse.data() + 2 * C * i + C, K, narrow.data() + 2 * K * i + K);
    }
    from = &narrow;
  }
  std::vector<float> fine(static_cast<std::size_t>(2 * K) * static_cast<std::size_t>(level.rows()));
  for_rows<K>(level.prolongation, from->data(),
              [&](std::int64_t i, const float* sum) { std::copy(sum, sum + 2 * K, fine.data() + 2 * K * i); });
  return fine;
}

class Cascade {
 public:
  Cascade(const HermitianMatrix& S, const HermitianMatrix& M, bool transports, double area, const EigenOptions& options)
      : pencil_{S, M}, options_(options) {
    const auto n = static_cast<double>(S.rows());
    std::vector<double> mass(static_cast<std::size_t>(S.rows()));
    const auto per_row = [&](std::int64_t j) {
      double sum = 0;
      for (Index e = M.outerIndexPtr()[j]; e < M.outerIndexPtr()[j + 1]; ++e) sum += std::abs(M.valuePtr()[e]);
      return sum;
    };
    parallel_for(S.rows(), [&](std::int64_t j) { mass[static_cast<std::size_t>(j)] = per_row(j); });
    const double total =
        parallel_sum<double>(S.rows(), [&](std::int64_t j) { return mass[static_cast<std::size_t>(j)]; });
    const double stiffness = parallel_sum<double>(S.rows(), [&](std::int64_t j) {
      double d = 0;
      for (Index e = S.outerIndexPtr()[j]; e < S.outerIndexPtr()[j + 1]; ++e)
        if (S.innerIndexPtr()[e] == j) d += S.valuePtr()[e].real();
      return d;
    });
    if (!(total > 0) || !(stiffness > 0)) throw SolveError("the matrices are zero or not positive");
    pencil_.S_scale = n / stiffness;
    pencil_.M_scale = n / total;
    unit_ = pencil_.S_scale / pencil_.M_scale;
    floor_ = unit_ / area;
    hierarchy_.build({.S = S, .M = &M, .sigma = -relative_shift / area}, transports ? &M : nullptr);
    masses(mass);
  }

  /// Throws nothing when it does not converge: see Refined::end.
  Refined run() {
    // The coarsest level that has room for the largest block.
    std::size_t l = hierarchy_.levels().size() - 1;
    while (l > 0 && hierarchy_.levels()[l].rows() < 32) --l;
    const Index rows = hierarchy_.levels()[l].rows();
    if (rows >= 16) return from_coarsest<16>(l);
    if (rows >= 4) return from_coarsest<4>(l);
    return {};
  }

  [[nodiscard]] double unit() const { return unit_; }

 private:
  /// Lumped masses of all levels: the row sums along the transports.
  void masses(const std::vector<double>& finest) {
    const std::vector<Level>& levels = hierarchy_.levels();
    masses_.resize(levels.size());
    masses_[0].resize(finest.size());
    for (std::size_t i = 0; i < finest.size(); ++i) masses_[0][i] = static_cast<float>(finest[i] * pencil_.M_scale);
    for (std::size_t l = 1; l < levels.size(); ++l) {
      masses_[l].resize(static_cast<std::size_t>(levels[l].rows()));
      const Rows& R = levels[l - 1].restriction;
      parallel_for(levels[l].rows(), [&](std::int64_t c) {
        float sum = 0;
        for (std::int64_t e = R.start[static_cast<std::size_t>(c)]; e < R.start[static_cast<std::size_t>(c) + 1]; ++e) {
          const auto at = static_cast<std::size_t>(e);
          sum += std::abs(R.value[at]) * masses_[l - 1][static_cast<std::size_t>(R.column[at])];
        }
        masses_[l][static_cast<std::size_t>(c)] = sum;
      });
    }
  }

  template <int K>
  Refined from_coarsest(std::size_t l) {
    Random random(options_.seed);
    std::vector<float> x(static_cast<std::size_t>(2 * K) * static_cast<std::size_t>(hierarchy_.levels()[l].rows()));
    for (float& z : x) z = static_cast<float>(random.uniform(-1, 1));
    if (l == 0) return finest<K>(std::move(x), coarsest_steps);
    VectorX<double> values;
    x = on_level<K>(l, std::move(x), coarsest_steps, values);
    if (values.size() < K) return {};
    // The coarsest level knows the spectrum roughly: a block that turns out too small is done again.
    const auto enough = [&](int k) { return k < K && values[k] >= gap * values[0]; };
    Refined result;
    result.end = Refined::End::narrow;
    if (K == 4 || enough(4)) result = down<4, K>(l, x);
    if constexpr (K >= 8) {
      if (result.end == Refined::End::narrow && (K == 8 || enough(8))) result = down<8, K>(l, x);
    }
    if constexpr (K >= 16) {
      if (result.end == Refined::End::narrow) result = down<16, K>(l, x);
    }
    return result;
  }

  template <int K, int C>
  Refined down(std::size_t l, const std::vector<float>& coarsest) {
    std::vector<float> x = prolonged<K, C>(hierarchy_.levels()[l - 1], coarsest);
    VectorX<double> values;
    for (--l; l > 0; --l) {
      x = on_level<K>(l, std::move(x), level_steps, values);
      if (values.size() < K) return {};
      x = prolonged<K, K>(hierarchy_.levels()[l - 1], x);
    }
    return finest<K>(std::move(x), finest_steps);
  }

  template <int K>
  std::vector<float> on_level(std::size_t l, std::vector<float> x, int steps, VectorX<double>& values) {
    const LevelPencil pencil{hierarchy_.levels()[l], masses_[l]};
    BlockSolver<K, LevelPencil, float> solver(pencil, hierarchy_.levels()[l].rows(), std::move(x));
    iterate<K>(solver, l, steps);
    values = solver.values();
    return std::move(solver.vectors().v);
  }

  template <int K>
  Refined finest(std::vector<float> x, int steps) {
    BlockSolver<K, FinePencil, double> solver(pencil_, pencil_.rows(), std::move(x));
    if (solver.values().size() < K) return {};
    iterate<K>(solver, 0, steps);
    double second = 0;
    for (int extra = 0; extra < next_steps && !(std::abs(solver.values()[1] - second) <= settled * second); ++extra) {
      second = solver.values()[1];
      iterate<K>(solver, 0, 1);
      ++steps;
    }
    if (K < 16 && solver.values()[K - 1] <= cluster * solver.values()[0]) {
      Refined result;
      result.end = Refined::End::narrow;
      return result;
    }
    if (solver.values()[1] <= cluster * solver.values()[0]) {
      // Here single precision must tell the members apart: the refinement could only turn x from one to another, and
      // bring back the errors of the others with every turn.
      const int more = std::clamp(options_.max_iterations - steps, 0, cluster_steps);
      iterate<K>(solver, 0, more);
      steps += more;
    }
    const RefineOptions refinement{.tolerance = options_.tolerance,
                                   .floor = floor_,
                                   .negative = 10 * relative_shift * floor_,
                                   .max_iterations = std::min(refine_limit, options_.max_iterations - steps)};
    Refined result = refine<K>(pencil_, hierarchy_, std::move(solver.vectors()), refinement);
    result.iterations += steps;
    return result;
  }

  template <int K, class Solver>
  void iterate(Solver& solver, std::size_t l, int steps) {
    if (solver.values().size() < K) return;
    auto workspace = hierarchy_.workspace<K>(l);
    for (int s = 0; s < steps; ++s) {
      solver.step([&](const std::vector<float>& r, std::vector<float>& w) {
        std::copy(r.begin(), r.end(), workspace.b[l].begin());
        hierarchy_.cycle<K>(workspace, l);
        std::copy(workspace.x[l].begin(), workspace.x[l].end(), w.begin());
      });
    }
  }

  FinePencil pencil_;
  const EigenOptions& options_;
  double unit_ = 1;   // eigenvalues of the pencil per eigenvalue of the problem
  double floor_ = 0;  // 1/area in the pencil's unit
  Hierarchy hierarchy_;
  std::vector<std::vector<float>> masses_;
};

/// What the pencil needs: compressed, the same pattern.
bool same_pattern(const HermitianMatrix& A, const HermitianMatrix& B) {
  return A.isCompressed() && B.isCompressed() && A.nonZeros() == B.nonZeros() &&
         std::equal(A.outerIndexPtr(), A.outerIndexPtr() + A.cols() + 1, B.outerIndexPtr()) &&
         std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), B.innerIndexPtr());
}

/// The way out when the cascade does not arrive: a factorisation.
EigenResult directly(const EigenProblem& problem, EigenOptions options, const std::string& why) {
  if (options.solver == "auto" || options.solver == "multigrid") options.solver = linear_solvers().front();
  // A basis of a Krylov space needs room.
  constexpr Eigen::Index tiny = 48;
  EigenResult result = problem.S.rows() <= tiny ? smallest_dense(problem, options) : smallest_lanczos(problem, options);
  result.report.message = why + (why.empty() || result.report.message.empty() ? "" : "; ") + result.report.message;
  return result;
}

}  // namespace

EigenResult smallest_lobpcg(const EigenProblem& problem, const EigenOptions& options) {
  if (problem.S.rows() <= factorised_rows) return directly(problem, options, "");
  HermitianMatrix S, M;
  const bool same = same_pattern(problem.S, problem.M);
  if (!same) {
    S = problem.S + 0.0 * problem.M;
    M = 0.0 * problem.S + problem.M;
    S.makeCompressed();
    M.makeCompressed();
  }
  Refined refined;
  double unit = 1;
  try {
    Cascade cascade(same ? problem.S : S, same ? problem.M : M, same, problem.area, options);
    unit = cascade.unit();
    refined = cascade.run();
  } catch (const SolveError&) {
    // Not positive somewhere: what exactly, the factorisation will say.
    return directly(problem, options, "");
  }
  if (refined.u.size() == 0 || refined.end == Refined::End::indefinite)
    return directly(problem, options, "the problem is unfit for multigrid: factorised instead");
  EigenResult result;
  result.u = std::move(refined.u);
  result.report.iterations = refined.iterations;
  result.report.solver = "LOBPCG, multigrid";
  result.report.next = refined.next / unit;
  conclude(problem, options, result);
  if (!result.report.converged && refined.iterations < options.max_iterations) {
    return directly(problem, options,
                    "LOBPCG stopped at a residual of " + std::to_string(result.report.residual) + " after " +
                        std::to_string(refined.iterations) + " iterations: factorised instead");
  }
  return result;
}

}  // namespace alcap::detail
