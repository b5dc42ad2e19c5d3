// SPDX-License-Identifier: MIT
//
// cascade.cpp: smallest eigenpair by a cascade through the multigrid hierarchy of S - sigma M, coarsest level first
// (Knyazev and Neymeyr 2003):
//   1. the lowest K eigenvectors of the coarsest level, densely or by LOBPCG from random vectors;
//   2. on every level between a few steps of block LOBPCG (block_lobpcg.h, Knyazev 2001), preconditioned by the cycle
//      from that level, starting from the prolonged vectors of the level before;
//   3. on the finest a few steps of block descent with the problem's own matrices (block_descent.h);
//   4. one vector in double (single_vector.h). The others of the block stay in its basis, so that clusters of
//      eigenvalues (round spheres have 2n + 1 equal ones) do not slow it down; where members of a cluster lie too close
//      for single precision they are refined too (cluster.h).
//
// Memory beyond the input: the hierarchy (about 160 bytes a row) and four blocks of K single precision vectors, or one
// and three double ones and the members of a cluster, whatever is more.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "solvers/dense/hermitian.h"
#include "solvers/eigenpair/block_descent.h"
#include "solvers/eigenpair/cluster.h"
#include "solvers/eigenpair/patches.h"
#include "solvers/linear/backends.h"
#include "src/base/numbers.h"
#include "src/base/random.h"

namespace alcap::detail {
namespace {

/// The hierarchy's shift in units of -1/area: a tenth of the smallest eigenvalue of a round sphere. Enough to keep the
/// cycle from blowing up the null vectors of a flat surface, too little to be felt elsewhere.
constexpr double relative_shift = 1;
/// Before the finest level cycles are shifted to this part of the smallest eigenvalue of the level before. Without that
/// they shrink an error along the k-th eigenvector by lambda_1 / lambda_k only, which is little where eigenvalues lie
/// close (noisy scans). Nearer to 1 what is wrong with the vectors of coarse levels drowns the rest.
constexpr double cycle_shift = 0.8;
/// Negative eigenvalues up to this part of 1/area are rounding.
constexpr double negligible = 1e-2;
/// Up to here a factorisation is quicker whatever the spectrum, and reaches the last digit.
constexpr Eigen::Index factorised_rows = 512;
/// A coarsest level of so many rows is solved directly, in a few milliseconds.
constexpr Index direct_rows = 96;
/// Steps of block LOBPCG from random vectors on a larger coarsest level, and on the levels between.
constexpr int coarsest_steps = 6;
constexpr int level_steps = 3;
/// At most so many steps of the whole block on the finest level.
constexpr int finest_steps = 6;
/// A block whose eigenvalues all lie within this factor of the first is smaller than the cluster they make.
constexpr double cluster = 1.03;
/// Steps on the finest level go on until the first two eigenvalues change by no more than this, and those that lie this
/// close to the first by no more than that.
constexpr double next_settled = 5e-2;
constexpr double close = 1.0005;
constexpr double close_settled = 1e-5;
/// A block ends where eigenvalues have grown by this factor: what lies beyond converges fast. Blocks of 4 cost little
/// less than blocks of 8, so they are for clear gaps.
constexpr double gap_of_4 = 1.3;
constexpr double clear_gap = 1.1;
/// Refinement that needs more iterations than this would be slower than a factorisation.
constexpr int refine_limit = 100;
/// A level with so many unknowns for each state below the smallest eigenvalue (states_below()) orders states rightly to
/// this part of it.
constexpr double unknowns_of_a_state = 128;
constexpr double level_error = 0.02;
/// Widths of blocks, as vector instructions like them. A coarsest level needs that many rows.
constexpr int narrow_block = 4, usual_block = 8, wide_block = 16;

/// The level's vectors from those of the next coarser one, the first K of the C there.
template <int K, int C>
Buffer<float> prolonged(const Level& level, const Buffer<float>& coarse) {
  Buffer<float> narrow;
  const float* from = coarse.data();
  if constexpr (K != C) {
    const std::int64_t rows = coarse.size() / (2 * C);
    narrow = Buffer<float>(2 * K * rows);
    for (std::int64_t i = 0; i < rows; ++i) {
      std::copy_n(from + 2 * C * i, K, narrow.data() + 2 * K * i);
      std::copy_n(from + 2 * C * i + C, K, narrow.data() + 2 * K * i + K);
    }
    from = narrow.data();
  }
  Buffer<float> fine(2 * K * std::int64_t{level.rows()});
  multiply_rows<K>(level.prolongation, from, fine.data());
  return fine;
}

class Cascade {
 public:
  /// S and M have the same pattern. `transports`: the phases of M are the parallel transports.
  Cascade(const EigenProblem& problem, bool transports, const EigenOptions& options)
      : pencil_{problem.S, problem.M}, options_(options), counted_(asks_for_proof(options, problem.S.rows())) {
    const HermitianMatrix& S = problem.S;
    const HermitianMatrix& M = problem.M;
    Buffer<double> mass(S.rows());
    parallel_for(S.rows(), [&](std::int64_t j) {
      double sum = 0;
      for (Index e = M.outerIndexPtr()[j]; e < M.outerIndexPtr()[j + 1]; ++e)
        sum += std::sqrt(std::norm(M.valuePtr()[e]));
      mass[j] = sum;
    });
    const double total = parallel_sum<double>(S.rows(), [&](std::int64_t j) { return mass[j]; });
    if (!(total > 0)) throw SolveError("the mass matrix M is zero or not positive");
    hierarchy_.build({.S = S, .M = &M, .sigma = -relative_shift / problem.area}, transports ? &M : nullptr,
                     options.cancel);
    pencil_.S_scale = 1 / hierarchy_.unit();
    pencil_.M_scale = static_cast<double>(S.rows()) / total;
    unit_ = pencil_.S_scale / pencil_.M_scale;
    floor_ = unit_ / problem.area;
    masses(mass);
  }

  /// Throws nothing when it does not converge: see Refined::end.
  Refined run() {
    std::size_t l = hierarchy_.levels().size() - 1;
    const auto rows = [&] { return hierarchy_.levels()[l].rows(); };
    // A coarsest level too small for the widest block is good for the usual one, which is nearly always enough.
    if (l > 0 && rows() >= usual_block && rows() < wide_block) {
      Refined result = from_coarsest<usual_block>(l);
      if (result.end != Refined::End::narrow) return result;
    }
    while (l > 0 && rows() < wide_block) --l;
    if (rows() >= wide_block) return from_coarsest<wide_block>(l);
    if (rows() >= narrow_block) return from_coarsest<narrow_block>(l);
    return {};
  }

  /// The smallest eigenpair from vectors of patches, the pair found before, and random vectors.
  Refined from_patches(const std::vector<LocalVector>& found, const ComplexVector& before) {
    constexpr int K = wide_block;
    const Level& level = hierarchy_.levels()[0];
    Random random(options_.seed + 1);
    Buffer<float> x(2 * K * std::int64_t{level.rows()});
    for (std::int64_t i = 0; i < x.size(); ++i) x[i] = static_cast<float>(random.uniform(-1, 1));
    const auto set = [&](int k, std::int64_t i, std::complex<double> z) {
      x[2 * K * i + k] = level.near[i] * static_cast<float>(z.real());
      x[2 * K * i + K + k] = level.near[i] * static_cast<float>(z.imag());
    };
    const auto columns = static_cast<int>(std::min<std::size_t>(found.size(), usual_block));
    for (int k = 0; k <= columns; ++k) {
      const bool last = k == columns;
      const ComplexVector& u = last ? before : found[static_cast<std::size_t>(k)].u;
      const double scale = 1 / u.cwiseAbs().maxCoeff();
      for (std::int64_t i = 0; i < level.rows(); ++i) set(k, i, last ? scale * u[i] : 0);
      for (Eigen::Index j = 0; !last && j < u.size(); ++j)
        set(k, found[static_cast<std::size_t>(k)].rows[static_cast<std::size_t>(j)], scale * u[j]);
    }
    FinestBlock<K> block(pencil_, hierarchy_, std::move(x));
    const int steps = descend<K>(block);
    return block.values().size() < K ? Refined{} : last_digits<K>(block, steps);
  }

  [[nodiscard]] double unit() const { return unit_; }
  /// Whether states may have been lost on coarse levels, none of which had the unknowns for them.
  [[nodiscard]] bool unresolved(double lambda) const {
    return !counted_ && !patches_done_ && states_below(lambda, 1 / floor_) > dense_states;
  }

 private:
  /// Lumped masses of all levels in their scaled unknowns: row sums along the near-null vectors.
  void masses(const Buffer<double>& finest) {
    const std::vector<Level>& levels = hierarchy_.levels();
    for (const Level& level : levels) masses_.emplace_back(level.rows());
    parallel_for(levels[0].rows(), [&](std::int64_t i) {
      const double near = levels[0].near[i];
      masses_[0][i] = static_cast<float>(finest[i] * pencil_.M_scale / (near * near));
    });
    for (std::size_t l = 1; l < levels.size(); ++l) {
      const Level& fine = levels[l - 1];
      const Rows& R = fine.restriction;
      parallel_for(levels[l].rows(), [&](std::int64_t c) {
        float sum = 0;
        for (std::int64_t e = R.start[c]; e < R.start[c + 1]; ++e)
          sum += std::sqrt(std::norm(R.value[e])) * masses_[l - 1][R.column[e]] * fine.near[R.column[e]];
        masses_[l][c] = sum / levels[l].near[c];
      });
    }
  }

  /// Shifts the cycles, `smallest` being the smallest eigenvalue of the shifted level 1.
  void shift(double smallest) {
    const double sigma = cycle_shift * std::max(0.0, smallest + shifted_ - 2 * floor_) - shifted_;
    if (sigma <= 0) return;
    hierarchy_.shift(masses_, static_cast<float>(sigma));
    shifted_ += sigma;
  }

  /// The K lowest eigenvectors of a small level, all at once: D^-1/2 times those of D^-1/2 A D^-1/2, D its masses.
  template <int K>
  Buffer<float> densely(std::size_t l, VectorX<double>& values) const {
    const Level& level = hierarchy_.levels()[l];
    const Index n = level.rows();
    VectorX<double> root(n);
    for (Index i = 0; i < n; ++i) root[i] = 1 / std::sqrt(std::max(masses_[l][i], std::numeric_limits<float>::min()));
    MatrixX<std::complex<double>> A = MatrixX<std::complex<double>>::Identity(n, n);
    for (Index i = 0; i < n; ++i)
      for (std::int64_t e = level.off.start[i]; e < level.off.start[i + 1]; ++e)
        A(i, level.off.column[e]) = std::complex<double>(level.off.value[e]);
    const Eigenpairs<std::complex<double>> pairs =
        hermitian_eigenpairs<std::complex<double>>(root.asDiagonal() * A * root.asDiagonal());
    values = pairs.values.head(K);
    Buffer<float> x(2 * K * std::int64_t{n});
    for (Index i = 0; i < n; ++i)
      for (int k = 0; k < K; ++k) {
        const std::complex<double> z = root[i] * pairs.vectors(i, k);
        x[2 * K * std::int64_t{i} + k] = static_cast<float>(z.real());
        x[2 * K * std::int64_t{i} + K + k] = static_cast<float>(z.imag());
      }
    return x;
  }

  /// Step 1, on level l, the coarsest that is used. Then down from there with the first 4, 8 or 16 of its vectors.
  template <int K>
  Refined from_coarsest(std::size_t l) {
    VectorX<double> values;
    Buffer<float> x;
    if (hierarchy_.levels()[l].rows() <= direct_rows) {
      x = densely<K>(l, values);
    } else {
      Random random(options_.seed);
      x = Buffer<float>(2 * K * std::int64_t{hierarchy_.levels()[l].rows()});
      for (std::int64_t k = 0; k < x.size(); ++k) x[k] = static_cast<float>(random.uniform(-1, 1));
      x = on_level<K>(l, std::move(x), coarsest_steps, values);
    }
    if (values.size() < K) return {};
    if (l == 0) return finest<K>(std::move(x), values);
    // The coarsest level knows the spectrum roughly: a block that turns out too small is done again.
    const auto enough = [&](int k) {
      return k < K && values[k] >= (k == narrow_block ? gap_of_4 : clear_gap) * values[0];
    };
    Refined result = too_narrow();
    if (K == narrow_block || enough(narrow_block)) result = down<narrow_block, K>(l, x, values);
    if constexpr (K >= usual_block) {
      if (result.end == Refined::End::narrow && (K == usual_block || enough(usual_block)))
        result = down<usual_block, K>(l, x, values);
    }
    if constexpr (K >= wide_block) {
      if (result.end == Refined::End::narrow) result = down<wide_block, K>(l, x, values);
    }
    return result;
  }

  /// Whether a cluster may go on beyond a block that could be wider.
  template <int K>
  static bool narrow(const VectorX<double>& values) {
    return K < wide_block && values[K - 1] <= cluster * values[0];
  }

  static Refined too_narrow() {
    Refined result;
    result.end = Refined::End::narrow;
    return result;
  }

  /// Step 2, with the first K of the C vectors of level l; then the finest level.
  template <int K, int C>
  Refined down(std::size_t l, const Buffer<float>& coarsest, VectorX<double> values) {
    Buffer<float> x = prolonged<K, C>(hierarchy_.levels()[l - 1], coarsest);
    for (--l; l > 0; --l) {
      x = on_level<K>(l, std::move(x), level_steps, values);
      if (values.size() < K) return {};
      if (!patches_done_ && resolves(l, values[0]) && !add_local_vectors<K>(l, x, values)) return too_narrow();
      if (narrow<K>(values)) return too_narrow();
      x = prolonged<K, K>(hierarchy_.levels()[l - 1], x);
    }
    return finest<K>(std::move(x), values);
  }

  /// Whether more states than a block has may compete for the first place, and this level has the unknowns for them.
  [[nodiscard]] bool resolves(std::size_t l, double smallest) const {
    const double states = states_below(smallest, 1 / floor_);
    return !counted_ && states > dense_states &&
           static_cast<double>(hierarchy_.levels()[l].rows()) >= unknowns_of_a_state * states;
  }

  /// A and the masses of a level.
  [[nodiscard]] std::pair<HermitianMatrix, HermitianMatrix> matrices_of(std::size_t l) const {
    const Level& level = hierarchy_.levels()[l];
    const auto n = static_cast<Index>(level.rows());
    HermitianMatrix S(n, n), M(n, n);
    S.reserve(level.off.nonzeros() + n);
    M.reserve(n);
    for (Index j = 0; j < n; ++j) {
      S.startVec(j);
      M.startVec(j);
      M.insertBack(j, j) = masses_[l][j];
      // Row j is the conjugate of column j; its columns need not be sorted.
      std::vector<std::pair<Index, std::complex<double>>> column{{j, 1.0}};
      for (std::int64_t e = level.off.start[j]; e < level.off.start[j + 1]; ++e)
        column.emplace_back(level.off.column[e], std::conj(std::complex<double>(level.off.value[e])));
      std::sort(column.begin(), column.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
      for (const auto& [i, value] : column) S.insertBack(i, j) = value;
    }
    S.finalize();
    M.finalize();
    return {std::move(S), std::move(M)};
  }

  /// Whether most of a local vector lies in the span of the columns of x, which are orthonormal by the masses.
  template <int K>
  static bool contained(const LocalVector& local, const Buffer<float>& x, const Buffer<float>& mass) {
    constexpr double most = 0.8;
    double inside = 0;
    for (int k = 0; k < K; ++k) {
      std::complex<double> overlap = 0;
      for (std::size_t j = 0; j < local.rows.size(); ++j) {
        const std::int64_t i = local.rows[j];
        const std::complex<double> z{double{x[2 * K * i + k]}, -double{x[2 * K * i + K + k]}};
        overlap += double{mass[i]} * z * local.u[static_cast<Eigen::Index>(j)];
      }
      inside += std::norm(overlap);
    }
    return inside > most;
  }

  /// Column k of x becomes a local vector.
  template <int K>
  static void put(const LocalVector& local, int k, Buffer<float>& x) {
    const std::int64_t rows = x.size() / (2 * K);
    for (std::int64_t i = 0; i < rows; ++i) x[2 * K * i + k] = x[2 * K * i + K + k] = 0;
    for (std::size_t j = 0; j < local.rows.size(); ++j) {
      const std::complex<double> z = local.u[static_cast<Eigen::Index>(j)];
      x[2 * K * std::int64_t{local.rows[j]} + k] = static_cast<float>(z.real());
      x[2 * K * std::int64_t{local.rows[j]} + K + k] = static_cast<float>(z.imag());
    }
  }

  /// Step 2 once more on level l, with what its patches have below the smallest value of the block in place of the
  /// block's last vectors. False when that is more than fits.
  template <int K>
  bool add_local_vectors(std::size_t l, Buffer<float>& x, VectorX<double>& values) {
    const auto [S, M] = matrices_of(l);
    // States of the level are ordered by its own errors as well: all that come near are taken.
    const double sigma = values[0] + level_error * std::max(values[0], floor_);
    const std::int64_t known = (values.array() < sigma).cast<std::int64_t>().sum();
    std::vector<LocalVector> found =
        search_patches({.S = S, .M = M, .area = 1 / floor_}, options_, sigma, wide_block - 2, known);
    const Buffer<float>& mass = masses_[l];
    std::erase_if(found, [&](const LocalVector& local) { return contained<K>(local, x, mass); });
    if (K < wide_block && found.size() > K / 2) return false;
    patches_done_ = true;
    if (found.empty()) return true;
    for (std::size_t f = 0; f < found.size(); ++f) put<K>(found[f], K - 1 - static_cast<int>(f), x);
    x = on_level<K>(l, std::move(x), level_steps, values);
    return true;
  }

  /// A few steps of block LOBPCG, preconditioned by one cycle each.
  template <int K>
  Buffer<float> on_level(std::size_t l, Buffer<float> x, int steps, VectorX<double>& values) {
    const LevelPencil pencil{hierarchy_.levels()[l], masses_[l]};
    BlockSolver<K, LevelPencil> solver(pencil, hierarchy_.levels()[l].rows(), std::move(x));
    auto workspace = hierarchy_.workspace<K>(l);
    for (int s = 0; s < steps && solver.values().size() == K; ++s) {
      check_cancelled(options_.cancel);
      solver.step([&](const float* r, float* w) {
        std::copy(r, r + workspace.b[l].size(), workspace.b[l].data());
        hierarchy_.cycle<K>(workspace, l);
        std::copy(workspace.x[l].data(), workspace.x[l].data() + workspace.x[l].size(), w);
      });
    }
    values = solver.values();
    return std::move(solver.vectors().v);
  }

  /// Step 3: block descent until the smallest eigenvalues are told apart; how many steps it took.
  template <int K>
  int descend(FinestBlock<K>& block) {
    int steps = 0;
    const int most = std::min(finest_steps, options_.max_iterations);
    for (bool settled = false; !settled && steps < most && block.values().size() == K; ++steps) {
      check_cancelled(options_.cancel);
      const VectorX<double> before = block.values();
      if (!block.step()) break;
      const VectorX<double>& now = block.values();
      // What is told apart here need not be in double (cluster.h).
      const Eigen::Index members = (now.array() <= close * now[0]).cast<Eigen::Index>().sum();
      const double change = (before - now).head(std::max<Eigen::Index>(2, members)).cwiseAbs().maxCoeff();
      settled = change <= (members > 1 ? close_settled : next_settled) * std::max(now[0], floor_);
    }
    return steps;
  }

  /// Steps 3 and 4.
  template <int K>
  Refined finest(Buffer<float> x, const VectorX<double>& values) {
    if (values.size() < K) return {};
    shift(values[0]);
    FinestBlock<K> block(pencil_, hierarchy_, std::move(x));
    const int steps = descend<K>(block);
    if (block.values().size() < K) return {};
    if (narrow<K>(block.values())) return too_narrow();
    return last_digits<K>(block, steps);
  }

  /// Step 4, after so many steps on the finest level.
  template <int K>
  Refined last_digits(FinestBlock<K>& block, int steps) {
    const RefineOptions refinement{.tolerance = options_.residual_tolerance(),
                                   .sine = options_.by_angle() ? sine_tolerance(options_) : 0,
                                   .floor = floor_,
                                   .negative = negligible * floor_,
                                   .max_iterations = std::min(refine_limit, options_.max_iterations - steps),
                                   .second = asks_for_proof(options_, pencil_.rows()),
                                   .cancel = options_.cancel};
    const VectorX<double> theta = block.values();
    Refined result = refine_first<K>({pencil_, hierarchy_, masses_[0]}, block.take(), theta, refinement);
    result.iterations += steps;
    return result;
  }

  FinePencil pencil_;
  const EigenOptions& options_;
  double unit_ = 1;   // eigenvalues of the pencil per eigenvalue of the problem
  double floor_ = 0;  // 1/area in the pencil's unit
  Hierarchy hierarchy_;
  bool counted_ = false;       // a proof will follow
  bool patches_done_ = false;  // on some level
  double shifted_ = 0;         // of its coarser levels, in the pencil's unit
  std::vector<Buffer<float>> masses_;
};

/// Step 5: `refined` becomes what patches led to where that is lower.
void look_for_lower(const EigenProblem& problem, const EigenOptions& options, Cascade& cascade, Refined& refined) {
  const double lambda = refined.lambda / cascade.unit(), scale = std::max(lambda, 1 / problem.area);
  const std::vector<LocalVector> found = search_patches(problem, options, lambda - bound_margin * scale, usual_block);
  if (found.empty()) return;
  Refined lower = cascade.from_patches(found, refined.u);
  const int before = refined.iterations;
  if (lower.end == Refined::End::converged && lower.lambda < refined.lambda) refined = std::move(lower);
  refined.iterations += before;
}

/// What to do where it is too large for that unasked.
std::string ask_for_a_factor() { return "EigenOptions::solver '" + preferred_factorisation() + "' asks for it"; }

/// The way out when the cascade does not arrive: a factorisation.
EigenResult factorised(const EigenProblem& problem, EigenOptions options, const std::string& why) {
  if (options.solver == "auto" || options.solver == "multigrid") options.solver = preferred_factorisation();
  EigenResult result =
      problem.S.rows() <= dense_eigen_rows ? smallest_dense(problem, options) : smallest_lanczos(problem, options);
  result.report.message = why + (why.empty() || result.report.message.empty() ? "" : "; ") + result.report.message;
  return result;
}

}  // namespace

EigenResult smallest_lobpcg(const EigenProblem& problem, const EigenOptions& options) {
  if (problem.S.rows() <= factorised_rows) return factorised(problem, options, "");
  HermitianMatrix S, M;
  const bool same = problem.transport != nullptr;
  if (!same) {
    S = problem.S + 0.0 * problem.M;
    M = 0.0 * problem.S + problem.M;
    S.makeCompressed();
    M.makeCompressed();
  }
  Refined refined;
  double unit = 1;
  try {
    Cascade cascade({.S = same ? problem.S : S, .M = same ? problem.M : M, .area = problem.area}, same, options);
    unit = cascade.unit();
    refined = cascade.run();
    if (refined.end == Refined::End::converged && cascade.unresolved(refined.lambda))
      look_for_lower(problem, options, cascade, refined);
  } catch (const SolveError& e) {
    // Not positive somewhere: what exactly, the factorisation will say.
    if (problem.S.rows() > factorisable_rows) throw;
    return factorised(problem, options, std::string(e.what()) + ": factorised instead");
  }
  if (refined.u.size() == 0 || refined.end == Refined::End::indefinite) {
    if (problem.S.rows() > factorisable_rows)
      throw SolveError("the problem is unfit for multigrid, and too large to be factorised unasked; " +
                       ask_for_a_factor());
    return factorised(problem, options, "the problem is unfit for multigrid: factorised instead");
  }
  EigenResult result;
  result.u = std::move(refined.u);
  result.report.iterations = refined.iterations;
  result.report.solver = "LOBPCG, multigrid";
  // The second Ritz value is no less than the second eigenvalue, however good it is.
  if (refined.next_good || options.by_angle()) result.report.next = refined.next / unit;
  conclude(problem, options, result);
  if (result.report.converged || refined.iterations >= options.max_iterations) return result;
  const std::string why = "LOBPCG stopped at a residual of " + rounded_text(result.report.residual) + " after " +
                          std::to_string(refined.iterations) + " iterations: ";
  if (problem.S.rows() <= factorisable_rows) return factorised(problem, options, why + "factorised instead");
  result.report.message = why + "too large to be factorised unasked; " + ask_for_a_factor();
  return result;
}

}  // namespace alcap::detail
