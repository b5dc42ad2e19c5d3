// SPDX-License-Identifier: MIT
//
// proof.cpp: what makes an eigenpair the smallest one. With (lambda, u) known to be an eigenpair, no other eigenvalue
// below sigma > lambda proves it; where the next one is too close, none below a sigma just under lambda does.
#include "solvers/eigenpair/proof.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "alcap/memory.h"
#include "solvers/eigenpair/patches.h"
#include "solvers/linear/backends.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"

namespace alcap {
namespace detail {
namespace {

/// Unasked a proof is made where it takes no longer than the solve did: so many rows at most, and of these so many
/// operations per row and iteration, or so many in all (a twentieth of a second).
constexpr Eigen::Index automatic_rows = 200'000;
constexpr double automatic_per_iteration = 4000, automatic_flops = 1e9;
/// Iterations that a solve by LOBPCG takes, where they are not known yet.
constexpr double usual_iterations = 20;
/// Of the memory that the system could still give.
constexpr double memory_part = 0.5;
/// Growth of entries up to which a count is believed: six of sixteen digits are left, and sigma keeps its distance from
/// eigenvalues.
constexpr double most_growth = 1e8;
/// A vanishing pivot is another one after the shift has moved by this part, doubled each time.
constexpr double nudge = 2.5e-13;
constexpr int nudges = 3;
/// Rounding units in an entry of a factor: the pivots that it is summed over, on average.
constexpr double rounded_operations = 32;
/// A bound further below the eigenvalue says little.
constexpr double largest_margin = 0.1;
/// A pair found by the other method is the smallest in the first attempt, but for a start vector without a part of it.
constexpr int attempts = 3;
/// An independent search stops early: eigenvalues are good to the square.
constexpr double search_tolerance = 1e-6;
/// How often it may miss what it is said not to have missed, and how many steps it makes before its first restart.
constexpr double search_risk = 1e-3;
constexpr int search_steps = 40;

double scale_of(const EigenProblem& problem, double lambda) { return std::max(std::abs(lambda), 1 / problem.area); }

enum class Verdict { proven, refuted, undecided };

/// Whether a count takes no longer than so many iterations of LOBPCG.
bool cheap_beside(const EigenvalueCounter& counter, Eigen::Index rows, double iterations) {
  const double solve = automatic_per_iteration * static_cast<double>(rows) * iterations;
  return counter.fronts().flops() <= std::max(automatic_flops, solve);
}

class Proof {
 public:
  Proof(const EigenProblem& problem, EigenResult& result, std::shared_ptr<const EigenvalueCounter> counter)
      : problem_(problem),
        result_(result),
        counted_(counter ? std::move(counter) : std::make_shared<const EigenvalueCounter>(problem)),
        counter_(*counted_) {}

  [[nodiscard]] bool fits(std::optional<double> memory) const {
    const double available = memory.value_or(memory_part * static_cast<double>(available_memory_bytes()));
    return (available == 0 && !memory) || counter_.fronts().bytes() <= available;
  }
  /// Beside the solve. What LOBPCG needs is known; other methods factorise themselves.
  [[nodiscard]] bool cheap() const {
    if (result_.report.solver.find("LOBPCG") != 0) return true;
    return cheap_beside(counter_, problem_.S.rows(), result_.report.iterations);
  }

  [[nodiscard]] const EigenvalueCounter& counter() const { return counter_; }

  /// Whether the pair at hand is the smallest; sets the bound and the next one.
  Verdict decide(std::optional<double> candidate, bool upper_bound) {
    EigenReport& report = result_.report;
    const double scale = scale_of(problem_, report.lambda);
    if (candidate && !upper_bound &&
        counter_.below(*candidate + next_accuracy * scale_of(problem_, *candidate), 1).complete)
      candidate.reset();
    const double least = std::max(bound_margin * scale, counter_.uncertainty(result_.u, report.lambda));
    if (!(least <= largest_margin * scale)) {
      report.smallest_note = "rounding, which badly shaped triangles enlarge, does not allow a proof";
      return Verdict::undecided;
    }
    std::optional<double> below_next;
    if (candidate) below_next = *candidate - next_accuracy * scale_of(problem_, *candidate);
    const double gap = below_next ? *below_next - report.lambda : 0;
    if (gap > std::max(least, report.distance)) {
      const EigenvalueCounter::Count count = counter_.below(*below_next, 1);
      // With one eigenvalue below `below_next` it lies this close to the Rayleigh quotient (Temple 1928; Kato 1949).
      if (count.complete && count.reliable && count.below == 1)
        return proven(report.lambda - std::max(least, report.distance * report.distance / gap), candidate);
    }
    const double margin = std::max(least, 4 * report.residual * scale);
    if (!(margin <= largest_margin * scale)) {
      report.smallest_note = "the residual is too large for a proof";
      return Verdict::undecided;
    }
    const double bound = report.lambda - margin;
    const EigenvalueCounter::Count count = counter_.below(bound, 0);
    if (!count.complete) return Verdict::refuted;
    if (!count.reliable) {
      report.smallest_note = "rounding does not allow a proof";
      return Verdict::undecided;
    }
    if (candidate && *below_next <= bound) return proven(bound, candidate);
    if (!candidate) return proven(bound, std::nullopt);
    // A multiple eigenvalue shows one vector to methods that iterate one.
    const double above = report.lambda + std::max(margin, bound_margin * scale);
    const EigenvalueCounter::Count near = counter_.below(above, 1);
    if (near.complete || margin > next_accuracy * scale) return proven(bound, std::nullopt);
    return proven(bound, report.lambda);
  }

 private:
  Verdict proven(double bound, std::optional<double> next) {
    EigenReport& report = result_.report;
    report.smallest = Smallest::proven;
    report.lower_bound = bound;
    report.next = next;
    return Verdict::proven;
  }

  const EigenProblem& problem_;
  EigenResult& result_;
  std::shared_ptr<const EigenvalueCounter> counted_;
  const EigenvalueCounter& counter_;
};

/// Adopts what another solve found; `from` says what was wrong with the result before.
void replace(EigenResult& result, EigenResult other, const std::string& from) {
  EigenReport& report = result.report;
  const int iterations = report.iterations;
  const std::string solver = report.solver;
  result = std::move(other);
  result.report.iterations += iterations;
  result.report.solver = solver + "; " + result.report.solver;
  result.report.smallest_note = from;
}

/// Lanczos over a factorisation, from another start vector, shifted to just below what is too large.
EigenResult solve_again(const EigenProblem& problem, EigenOptions options, double above, int attempt) {
  options.solver = preferred_factorisation();
  options.seed += static_cast<std::uint64_t>(attempt);
  return smallest_lanczos_below(problem, options, above);
}

/// The second eigenvalue by a search of its own.
std::optional<double> second(const EigenProblem& problem, EigenOptions options) {
  if (problem.S.rows() < 2) return std::nullopt;
  options.solver = preferred_factorisation();
  const EigenModes modes = find_modes(problem, options, "lanczos", 2);
  if (!modes.converged || modes.smallest != Smallest::proven) return std::nullopt;
  return modes.lambda[1];
}

/// Where LOBPCG left it to a proof to find localised states, and none is made: a pair that patches show not to be the
/// smallest is replaced.
void look_on_patches(const EigenProblem& problem, const EigenOptions& options, EigenResult& result) {
  const double lambda = result.report.lambda;
  if (states_below(lambda, problem.area) <= dense_states) return;
  const double below = lambda - bound_margin * scale_of(problem, lambda);
  const std::vector<LocalVector> found = search_patches(problem, options, below, 1);
  if (found.empty()) return;
  EigenResult again = solve_again(problem, options, found.front().lambda, 1);
  if (!again.report.converged || again.report.lambda >= lambda) return;
  replace(result, std::move(again),
          "the search ended at " + rounded_text(lambda) + ", which turned out not to be the smallest: solved again");
  result.report.next.reset();
}

/// The part of the smallest eigenvalue (from `sigma` on) by which `steps` steps of Lanczos from a random vector miss it
/// with a probability of search_risk at most: that of an error of more than epsilon is no larger than
///   1.648 sqrt(N) exp(-(2 steps - 1) sqrt(epsilon))
/// for starts that favour no direction of the N real dimensions (Kuczynski and Wozniakowski 1992).
double missed_part(Eigen::Index rows, int steps) {
  constexpr double factor = 1.648;
  const double root = std::log(factor * std::sqrt(2 * static_cast<double>(rows)) / search_risk) / (2 * steps - 1);
  return std::min(1.0, root * root);
}

/// Why no proof is tried, if so.
std::string no_proof(const EigenProblem& problem, const EigenOptions& options, const EigenReport& report) {
  if (options.prove_smallest == Prove::never) return "no proof was asked for";
  if (!report.converged) return "the eigenpair did not converge";
  if (!asks_for_proof(options, problem.S.rows()))
    return "more than " + std::to_string(automatic_rows) + " rows: EigenOptions::prove_smallest asks for it";
  return {};
}

/// What an independent search that found nothing lower is worth, in words.
std::string confidence(Eigen::Index rows, const EigenReport& found) {
  const double part = missed_part(rows, std::clamp(found.iterations, 1, search_steps));
  std::string text = "not proven; a search from an independent random vector found nothing lower";
  if (part < 1)
    text += ", and would have found with a confidence of " + rounded_text(100 * (1 - search_risk)) +
            " % what lies more than " + rounded_text(100 * part) + " % lower";
  return text;
}

/// Without a factorisation: Lanczos with multigrid solves from independent random vectors, until one finds nothing
/// lower.
void search(const EigenProblem& problem, const EigenOptions& options, EigenResult& result) {
  result.report.next.reset();
  const double first = result.report.lambda;
  std::string replaced;
  for (int attempt = 1; attempt <= attempts; ++attempt) {
    EigenOptions other = options;
    other.solver = "multigrid";
    other.seed += static_cast<std::uint64_t>(attempt);
    other.tolerance = std::max(options.residual_tolerance(), search_tolerance);
    const EigenReport found = smallest_lanczos(problem, other).report;
    if (!found.converged) {
      result.report.smallest_note = replaced + "too large to be factorised, and an independent search did not converge";
      return;
    }
    const double lambda = result.report.lambda, lower = lambda - next_accuracy * scale_of(problem, lambda);
    if (found.lambda >= lower) {
      result.report.smallest = Smallest::searched;
      result.report.smallest_note = replaced + confidence(problem.S.rows(), found);
      return;
    }
    other.tolerance = options.residual_tolerance();
    EigenResult again = smallest_lanczos(problem, other);
    if (!again.report.converged || again.report.lambda >= lower) break;
    replaced = "the first search ended at " + rounded_text(first) + ", an independent one found a smaller eigenvalue; ";
    replace(result, std::move(again), "");
    result.report.next.reset();
  }
  // A Rayleigh quotient is enough to know that.
  result.report.smallest = Smallest::refuted;
  result.report.smallest_note = "an independent search found a smaller eigenvalue, but not its vector";
}

}  // namespace

EigenvalueCounter::Count EigenvalueCounter::below(double sigma, std::int64_t most) const {
  // Where nothing else gives a scale.
  const double unit = std::max(std::abs(sigma), S_.sum() / M_.sum());
  Count count;
  double step = 0;
  for (int k = 0; k <= nudges; ++k) {
    count.sigma = sigma - step;
    const PivotCount pivots = fronts_.count(shifted(problem_, count.sigma), weights(count.sigma), most);
    count.below = pivots.negative;
    count.complete = pivots.complete;
    count.growth = pivots.growth;
    // More negative pivots than asked for are there, however the rest comes out.
    count.reliable = !pivots.broken && pivots.growth <= most_growth;
    if (count.reliable || !count.complete) break;
    step = step == 0 ? nudge * unit : 2 * step;
  }
  return count;
}

double EigenvalueCounter::uncertainty(const ComplexVector& u, double sigma) const {
  const VectorX<double> w = weights(sigma);
  const double sum = parallel_sum<double>(u.size(), [&](std::int64_t j) { return w[j] * std::norm(u[j]); });
  return rounded_operations * std::numeric_limits<double>::epsilon() * sum;
}

bool asks_for_proof(const EigenOptions& options, Eigen::Index rows) {
  return options.prove_smallest == Prove::always ||
         (options.prove_smallest == Prove::automatic && rows <= automatic_rows);
}

void prove_smallest_with(const EigenProblem& problem, const EigenOptions& options,
                         const std::function<std::optional<bool>(double sigma)>& rest, EigenResult& result) {
  EigenReport& report = result.report;
  const Stopwatch timer;
  report.next.reset();
  report.smallest_note = no_proof(problem, options, report);
  if (!report.smallest_note.empty()) return;
  const ControlScope scope(options.cancel);
  const Proof proof(problem, result, nullptr);
  if (!proof.fits({})) {
    report.smallest_note = "too large to be factorised";
    return;
  }
  const EigenvalueCounter& counter = proof.counter();
  const double scale = scale_of(problem, report.lambda);
  const double least = std::max(bound_margin * scale, counter.uncertainty(result.u, report.lambda));
  const double margin = std::max(least, 4 * report.residual * scale);
  const EigenvalueCounter::Count count = counter.below(report.lambda - margin, 0);
  const std::optional<bool> definite = count.complete && count.reliable ? rest(count.sigma) : std::nullopt;
  if (!count.complete || !definite.value_or(true)) {
    report.smallest = Smallest::refuted;
    report.smallest_note = "a smaller eigenvalue exists and was not found";
  } else if (!definite || !(margin <= largest_margin * scale)) {
    report.smallest_note = "rounding does not allow a proof";
  } else {
    report.smallest = Smallest::proven;
    report.lower_bound = count.sigma;
  }
  report.proof_seconds = timer.seconds();
}

std::shared_ptr<const EigenvalueCounter> plan_proof(const EigenProblem& problem, EigenOptions& options) {
  if (options.prove_smallest != Prove::automatic || !asks_for_proof(options, problem.S.rows())) return nullptr;
  const ControlScope scope(options.cancel);
  auto counter = std::make_shared<const EigenvalueCounter>(problem);
  if (!cheap_beside(*counter, problem.S.rows(), usual_iterations)) options.prove_smallest = Prove::never;
  return counter;
}

bool worth_proving(const EigenvalueCounter& counter, Eigen::Index rows, int iterations) {
  return cheap_beside(counter, rows, iterations);
}

void prove_smallest(const EigenProblem& problem, const EigenOptions& options, bool own, EigenResult& result,
                    std::optional<double> memory, std::shared_ptr<const EigenvalueCounter> counter) {
  if (result.report.smallest == Smallest::proven) return;
  const Stopwatch timer;
  const auto unchecked = [&](std::string why) { result.report.smallest_note = std::move(why); };
  std::optional<double> candidate = std::exchange(result.report.next, std::nullopt);
  if (std::string why = no_proof(problem, options, result.report); !why.empty()) return unchecked(std::move(why));
  const ControlScope scope(options.cancel);
  const bool planned = counter != nullptr;
  Proof proof(problem, result, std::move(counter));
  if (options.prove_smallest == Prove::automatic && !planned && !proof.cheap()) {
    look_on_patches(problem, options, result);
    if (result.report.smallest_note.empty()) unchecked(proof_takes_longer);
    return;
  }
  if (!proof.fits(memory)) {
    search(problem, options, result);
    result.report.proof_seconds = timer.seconds();
    return;
  }
  Verdict verdict = proof.decide(candidate, own);
  for (int attempt = 1; verdict == Verdict::refuted && attempt <= attempts; ++attempt) {
    const std::string from = "the search ended at " + rounded_text(result.report.lambda) +
                             ", which turned out not to be the smallest: solved again";
    const double above = result.report.lambda;
    replace(result, solve_again(problem, options, above, attempt), from);
    candidate = std::exchange(result.report.next, std::nullopt);
    if (!result.report.converged) break;
    verdict = proof.decide(candidate, true);
  }
  if (verdict == Verdict::proven && !result.report.next && options.prove_smallest == Prove::always)
    result.report.next = second(problem, options);
  if (verdict == Verdict::refuted) {
    result.report.smallest = Smallest::refuted;
    result.report.smallest_note = "a smaller eigenvalue exists and was not found";
  }
  result.report.proof_seconds = timer.seconds();
}

}  // namespace detail

Inertia inertia(const SparseMatrix<std::complex<double>>& S, const SparseMatrix<std::complex<double>>& M,
                double sigma) {
  const detail::Stopwatch timer;
  detail::require_square(S);
  detail::require_square(M);
  if (S.rows() != M.rows())
    throw SolveError("S has " + std::to_string(S.rows()) + " rows and M " + std::to_string(M.rows()));
  if (!std::isfinite(sigma)) throw OptionError("sigma", sigma, "must be finite");
  const EigenProblem problem{.S = S, .M = M, .area = 1, .transport = detail::same_pattern(S, M) ? &M : nullptr};
  const detail::EigenvalueCounter counter(problem);
  const detail::EigenvalueCounter::Count count = counter.below(sigma);
  return {.below = count.below,
          .sigma = count.sigma,
          .growth = std::max(1.0, count.growth),
          .flops = counter.fronts().flops(),
          .seconds = timer.seconds()};
}

}  // namespace alcap
