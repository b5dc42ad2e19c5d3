// SPDX-License-Identifier: MIT
//
// lanczos_loop.cpp: the basis grows one vector, one solve, at a time, and after each the residual of the first Ritz
// pair is computed. With Op V = V H + f e^T (Lanczos 1950), a Ritz pair (theta, y = V s) has
//   S y - lambda M y = -(s_last / theta) (S - sigma M) f.
// When that says it is done, the vector is formed and its true residual decides.
#include "solvers/eigenpair/lanczos_loop.h"

#include <algorithm>
#include <cmath>

#include "solvers/eigenpair/lanczos_recurrence.h"
#include "solvers/linear/backends.h"

namespace alcap::detail {
namespace {

/// Most basis vectors: 640 bytes a complex row, well below the factor's. After a restart the better half stays.
constexpr Eigen::Index basis_size = 40;
constexpr Eigen::Index kept = 16;
/// Ritz values this close, relatively, to the first may be copies of it.
constexpr double copy = 1e-6;
/// The second eigenvalue is an information, not the result: its Ritz vector this good gives it to about 1e-3. It is
/// waited for so many solves.
constexpr double next_tolerance = 1e-3;
constexpr Eigen::Index solves_for_next = 12;
/// When the recurrence promises this fraction of the true residual, the rest is rounding in the solves. Steps of
/// inverse iteration remove it, at most so many, as long as each leaves no more than this part.
constexpr double limited = 1e-2;
constexpr int most_polishes = 4;
constexpr double polished = 0.5;
/// Where the promise turned out too good, the next one has to be better by as much, and twice that.
constexpr double caution = 2;

Eigen::Index place_of_second(const RitzPairs& ritz) {
  const VectorX<double>& theta = ritz.values;
  const Eigen::Index k = theta.size();
  if (k < 2) return 1;
  Eigen::Index place = 2;
  while (place < k && theta[k - place] > (1 - copy) * theta[k - 1]) ++place;
  return place;
}

/// Products with M are in units of the mean row sum of M, which is size / (rows / 2) (complex rows).
double mass_unit(const LanczosProblem& problem) { return static_cast<double>(problem.rows()) / (2 * problem.size()); }

/// Op, as Spectra calls it.
struct Inverse {
  using Scalar = double;
  const LanczosProblem& problem;
  [[nodiscard]] Eigen::Index rows() const { return problem.rows(); }
  void perform_op(const double* x, double* y) const {
    VectorX<double> Mx(rows());
    problem.mass(x, Mx.data());
    Mx *= mass_unit(problem);
    problem.solve(Mx.data(), y);
  }
};

/// The inner product. Basis vectors have y^H M y = 2 size / rows.
struct Mass {
  using Scalar = double;
  const LanczosProblem& problem;
  [[nodiscard]] Eigen::Index rows() const { return problem.rows(); }
  void perform_op(const double* x, double* y) const {
    problem.mass(x, y);
    Eigen::Map<VectorX<double>>(y, rows()) *= mass_unit(problem);
  }
};

using Operators = Spectra::ArnoldiOp<double, Inverse, Mass>;

}  // namespace

class LanczosLoop::Process {
 public:
  Process(LanczosProblem& problem, const EigenOptions& options)
      : problem_(problem),
        options_(options),
        size_(std::min<Eigen::Index>(basis_size, problem.rows() - 1)),
        op_{problem},
        mass_{problem},
        basis_(Operators(op_, mass_), size_) {}

  void run(const double* start) {
    Eigen::Map<const VectorX<double>> from(start, problem_.rows());
    basis_.init(from, solves_);
    Eigen::Index stop_next = options_.max_iterations;  // when to stop waiting for the second Ritz value
    bool found = false;
    for (Eigen::Index k = 1;; ++k) {
      check_cancelled(options_.cancel);
      ritz_ = hermitian_eigenpairs<double>(basis_.matrix_H().topLeftCorner(k, k));
      if (!found && correction_ * promised_residual() <= options_.residual_tolerance()) {
        found = accept();
        if (found) stop_next = std::min<Eigen::Index>(stop_next, solves_ + solves_for_next);
      }
      const bool give_up = solves_ >= options_.max_iterations;
      if ((found && (second_is_good() || solves_ >= stop_next)) || give_up) {
        if (!found) static_cast<void>(accept());
        return;
      }
      if (k == size_) {
        basis_.restart(std::min(kept, size_ / 2), ritz_.values);
        k = basis_.subspace_dim();
      }
      basis_.extend([&](const double* x, double* y) { mass_.perform_op(x, y); },
                    [&](const double* Mx, double* y) { problem_.solve(Mx, y); }, solves_);
    }
  }

  [[nodiscard]] int solves() const { return static_cast<int>(solves_); }
  [[nodiscard]] const RitzPairs& ritz() const { return ritz_; }

  void ritz_vectors(Eigen::Index count, double* out) const {
    Eigen::Map<MatrixX<double>>(out, problem_.rows(), count).noalias() =
        basis_.matrix_V().leftCols(ritz_.values.size()) * ritz_.vectors.rightCols(count);
  }

 private:
  /// The residual of the first Ritz pair by the recurrence, but for |M y|, for which the guess is that of a uniform
  /// vector.
  [[nodiscard]] double promised_residual() const {
    const Eigen::Index k = ritz_.values.size();
    const double theta = ritz_.values[k - 1];
    const double difference = problem_.shifted_norm(basis_.vector_f().data());
    const double uniform = 2 * problem_.size() / static_cast<double>(problem_.rows());
    const double scale = std::max(1 / theta, 1.0) / problem_.size();
    return difference * std::abs(ritz_.vectors(k - 1, k - 1)) / (theta * scale * uniform);
  }

  /// Forms the first Ritz vector and says whether to stop: its true residual is good enough, or rounding does not let
  /// it get better.
  bool accept() {
    const Eigen::Index k = ritz_.values.size();
    problem_.vector().noalias() = basis_.matrix_V().leftCols(k) * ritz_.vectors.col(k - 1);
    double residual = problem_.check();
    const double promised = promised_residual();
    for (int round = 1; residual > options_.residual_tolerance() && promised < limited * residual; ++round) {
      // The recurrence has converged further than the vector: what is left is rounding in the solves.
      const VectorX<double> before = problem_.vector();
      solves_ += problem_.polish();
      const double after = problem_.check();
      if (after > residual) problem_.vector() = before;
      if (round == most_polishes || after > polished * residual) return true;
      residual = after;
    }
    if (residual <= options_.residual_tolerance()) return true;
    correction_ *= caution * residual / options_.residual_tolerance();
    return false;
  }

  [[nodiscard]] bool second_is_good() const {
    const Eigen::Index k = ritz_.values.size();
    if (k < 2) return false;
    const Eigen::Index at = k - place_of_second(ritz_);
    return std::abs(ritz_.vectors(k - 1, at)) * basis_.f_norm() <= next_tolerance * ritz_.values[at];
  }

  LanczosProblem& problem_;
  const EigenOptions& options_;
  Eigen::Index size_;  // most basis vectors
  Inverse op_;
  Mass mass_;
  LanczosRecurrence<Operators> basis_;
  RitzPairs ritz_;
  Eigen::Index solves_ = 0;
  double correction_ = 1;  // what the last true residual taught
};

LanczosLoop::LanczosLoop(LanczosProblem& problem, const EigenOptions& options)
    : process_(std::make_unique<Process>(problem, options)) {}
LanczosLoop::~LanczosLoop() = default;
void LanczosLoop::run(const double* start) { process_->run(start); }
int LanczosLoop::solves() const { return process_->solves(); }
const RitzPairs& LanczosLoop::ritz() const { return process_->ritz(); }
Eigen::Index LanczosLoop::second_place() const { return place_of_second(process_->ritz()); }
void LanczosLoop::ritz_vectors(Eigen::Index count, double* out) const { process_->ritz_vectors(count, out); }

}  // namespace alcap::detail
