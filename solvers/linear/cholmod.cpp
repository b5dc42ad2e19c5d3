// SPDX-License-Identifier: MIT
//
// cholmod.cpp: sparse Cholesky through SuiteSparse CHOLMOD (Chen, Davis, Hager, Rajamanickam 2008): supernodal, 64-bit
// indices, complex Hermitian as complex (the real 2n x 2n view costs 2-3 times the time and twice the memory). The only
// file that includes cholmod.h.
//
// A cholmod_common is workspace and status of one caller at a time: each object owns one for analyse() and factorise(),
// and each solve() makes its own, so that solve() may run on several threads at once. BLAS settings are left alone.
#include <cholmod.h>

#include <algorithm>
#include <limits>
#include <mutex>
#include <string>
#include <type_traits>
#include <vector>

#include "solvers/linear/backends.h"
#include "solvers/linear/multifrontal.h"
#include "solvers/linear/stages.h"

namespace alcap::detail {
namespace {

/// Above this many rows (about 200K triangles) nested dissection pays for itself, below AMD is faster overall.
constexpr Eigen::Index cholmod_metis_above_rows = 100'000;

template <class Scalar>
constexpr int xtype = std::is_same_v<Scalar, double> ? CHOLMOD_REAL : CHOLMOD_COMPLEX;

class Common {
 public:
  Common() {
    cholmod_l_start(&c);
    c.print = 0;  // the library never prints
    c.error_handler = nullptr;
    c.useGPU = 0;
    c.supernodal = CHOLMOD_SUPERNODAL;
    c.nmethods = 1;
    c.postorder = 1;
  }
  ~Common() { cholmod_l_finish(&c); }
  Common(const Common&) = delete;
  Common& operator=(const Common&) = delete;

  /// Throws SolveError when the last call failed. Not positive definite is left to the caller, who knows the column.
  void check(const char* step) const {
    const std::string where = std::string("CHOLMOD ") + step + ": ";
    switch (c.status) {
      case CHOLMOD_OK:
      case CHOLMOD_NOT_POSDEF:
      case CHOLMOD_DSMALL:
        return;
      case CHOLMOD_OUT_OF_MEMORY:
        throw SolveError(where + "out of memory" + less_than_a_factor);
      case CHOLMOD_TOO_LARGE:
        throw SolveError(where + "the problem is too large; the solver 'multigrid' orders and factorises nothing");
      case CHOLMOD_NOT_INSTALLED:
        throw SolveError(where + "this CHOLMOD was built without the ordering; the solver 'cholmod-amd' needs none");
      default:
        throw SolveError(where + "failed with status " + std::to_string(c.status));
    }
  }

  cholmod_common c{};
};

/// METIS draws from the C library's rand() and seeds it each time: one ordering at a time, or orderings would depend on
/// what other threads do.
std::mutex& metis_lock() {
  static std::mutex lock;
  return lock;
}

/// A as CHOLMOD sees it: the values in place, indices widened, the upper triangle read and the lower one ignored.
template <class Scalar>
struct View {
  explicit View(const SparseMatrix<Scalar>& A)
      : p(static_cast<std::size_t>(A.cols()) + 1), nz(A.isCompressed() ? 0 : static_cast<std::size_t>(A.cols())) {
    for (std::size_t j = 0; j < p.size(); ++j) p[j] = A.outerIndexPtr()[j];
    for (std::size_t j = 0; j < nz.size(); ++j) nz[j] = A.innerNonZeroPtr()[j];
    i.assign(A.innerIndexPtr(), A.innerIndexPtr() + p.back());
    a.nrow = static_cast<std::size_t>(A.rows());
    a.ncol = static_cast<std::size_t>(A.cols());
    a.nzmax = static_cast<std::size_t>(p.back());
    a.p = p.data();
    a.i = i.data();
    a.nz = A.isCompressed() ? nullptr : nz.data();
    a.x = const_cast<Scalar*>(A.valuePtr());
    a.stype = 1;
    a.itype = CHOLMOD_LONG;
    a.xtype = xtype<Scalar>;
    a.dtype = CHOLMOD_DOUBLE;
    a.sorted = 1;
    a.packed = A.isCompressed() ? 1 : 0;
  }
  std::vector<SuiteSparse_long> p, i, nz;
  cholmod_sparse a{};
};

template <class Scalar>
class Cholmod final : public LinearSolver<Scalar> {
 public:
  Cholmod(Ordering ordering, const SolverOptions& options)
      : stages_("CHOLMOD", options.cancel), asked_(ordering), used_(ordering) {}
  ~Cholmod() override { release(); }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  void analyse(const SparseMatrix<Scalar>& A) override {
    stages_.begin_analysis(A);
    release();
    used_ = asked_;
    if (asked_ == Ordering::automatic) used_ = A.rows() > cholmod_metis_above_rows ? Ordering::metis : Ordering::amd;
    common_.c.method[0].ordering = used_ == Ordering::metis ? CHOLMOD_METIS : CHOLMOD_AMD;
    guarded("CHOLMOD analysis", less_than_a_factor, [&] {
      View<Scalar> view(A);
      std::unique_lock<std::mutex> lock(metis_lock(), std::defer_lock);
      if (used_ == Ordering::metis) lock.lock();
      L_ = cholmod_l_analyze(&view.a, &common_.c);
    });
    common_.check("analysis");
    if (L_ == nullptr) throw SolveError("CHOLMOD analysis: failed");
    stages_.analysed(A);
  }

  void factorise(const SparseMatrix<Scalar>& A) override {
    stages_.begin_factorisation(A);
    guarded("CHOLMOD factorisation", less_than_a_factor, [&] {
      View<Scalar> view(A);
      cholmod_l_factorize(&view.a, L_, &common_.c);
    });
    common_.check("factorisation");
    if (common_.c.status == CHOLMOD_NOT_POSDEF || L_->minor < L_->n) {
      const std::size_t pivot = std::min(L_->minor, L_->n - 1);
      not_positive_definite(static_cast<const SuiteSparse_long*>(L_->Perm)[pivot], "not positive definite");
    }
    guarded("CHOLMOD factorisation", less_than_a_factor, [&] {
      check_pivots(A);
      index_factor();
    });
    stages_.factorised(static_cast<std::int64_t>(L_->xsize));
  }

  SolveReport solve(const Eigen::Ref<const MatrixX<Scalar>>& B, Eigen::Ref<MatrixX<Scalar>> X) const override {
    const Stopwatch timer;
    SolveReport report = stages_.begin_solve<Scalar>(B, X, name());
    report.converged = true;
    if (B.cols() == 0) return report;
    const Eigen::Index rows = stages_.rows();
    Common common;
    cholmod_dense b = dense(const_cast<Scalar*>(B.data()), B.cols(), B.outerStride());
    Workspace w{&common.c};
    // CHOLMOD would use its large workspace without a look at whether there was memory for it.
    w.Y = cholmod_l_allocate_dense(static_cast<std::size_t>(rows), static_cast<std::size_t>(B.cols()),
                                   static_cast<std::size_t>(rows), xtype<Scalar>, &common.c);
    common.check("solve");
    if (X.cols() == 1 || X.outerStride() == rows) {
      cholmod_dense x = dense(X.data(), X.cols(), rows);
      cholmod_dense* in_place = &x;
      cholmod_l_solve2(CHOLMOD_A, L_, &b, nullptr, &in_place, nullptr, &w.Y, &w.E, &common.c);
      common.check("solve");
    } else {
      cholmod_l_solve2(CHOLMOD_A, L_, &b, nullptr, &w.X, nullptr, &w.Y, &w.E, &common.c);
      common.check("solve");
      X = Eigen::Map<const MatrixX<Scalar>>(static_cast<const Scalar*>(w.X->x), rows, B.cols());
    }
    report.solve_seconds = timer.seconds();
    return report;
  }

  // Forward substitution in the supernodes that B reaches: those of its rows and their ancestors in the elimination
  // tree.
  [[nodiscard]] std::optional<HalfSolution<Scalar>> half_solve(const SparseMatrix<Scalar>& B) const override {
    if (!stages_.ready() || L_->is_super == 0) return std::nullopt;
    if (B.rows() != stages_.rows()) throw SolveError("CHOLMOD: the right-hand side has another size than the matrix");
    const auto* super = static_cast<const SuiteSparse_long*>(L_->super);
    const auto* pi = static_cast<const SuiteSparse_long*>(L_->pi);
    const auto* px = static_cast<const SuiteSparse_long*>(L_->px);
    const auto* row = static_cast<const SuiteSparse_long*>(L_->s);
    const auto* x = static_cast<const Scalar*>(L_->x);
    std::vector<SuiteSparse_long> offset(L_->nsuper, -1), reached;
    for (Eigen::Index k = 0; k < B.nonZeros(); ++k) {
      SuiteSparse_long s =
          super_of_[static_cast<std::size_t>(position_[static_cast<std::size_t>(B.innerIndexPtr()[k])])];
      while (s >= 0 && offset[static_cast<std::size_t>(s)] < 0) {
        offset[static_cast<std::size_t>(s)] = 0;
        reached.push_back(s);
        const SuiteSparse_long below = pi[s] + (super[s + 1] - super[s]);
        s = below < pi[s + 1] ? super_of_[static_cast<std::size_t>(row[below])] : -1;
      }
    }
    std::sort(reached.begin(), reached.end());
    HalfSolution<Scalar> half;
    for (const SuiteSparse_long s : reached) {
      offset[static_cast<std::size_t>(s)] = static_cast<SuiteSparse_long>(half.rows.size()) - super[s];
      for (SuiteSparse_long j = super[s]; j < super[s + 1]; ++j) half.rows.push_back(static_cast<Index>(j));
    }
    const auto place = [&](SuiteSparse_long j) {
      return offset[static_cast<std::size_t>(super_of_[static_cast<std::size_t>(j)])] + j;
    };
    half.values = MatrixX<Scalar>::Zero(static_cast<Eigen::Index>(half.rows.size()), B.cols());
    for (Eigen::Index c = 0; c < B.outerSize(); ++c)
      for (typename SparseMatrix<Scalar>::InnerIterator it(B, c); it; ++it)
        half.values(place(position_[static_cast<std::size_t>(it.row())]), c) += it.value();
    for (const SuiteSparse_long s : reached) {
      const Eigen::Index width = super[s + 1] - super[s], height = pi[s + 1] - pi[s];
      const Eigen::Map<const MatrixX<Scalar>> block(x + px[s], height, width);
      auto own = half.values.middleRows(place(super[s]), width);
      block.topRows(width).template triangularView<Eigen::Lower>().solveInPlace(own);
      if (height == width) continue;
      // A new one each time: a matrix of Eigen that gets no memory for its next size frees the last one twice.
      const MatrixX<Scalar> update = block.bottomRows(height - width) * own;
      for (Eigen::Index i = 0; i < height - width; ++i) half.values.row(place(row[pi[s] + width + i])) -= update.row(i);
    }
    return half;
  }

  [[nodiscard]] std::string name() const override {
    switch (used_) {
      case Ordering::amd:
        return "cholmod (amd)";
      case Ordering::metis:
        return "cholmod (metis)";
      default:
        return "cholmod";
    }
  }

 private:
  /// Frees what a solve allocates, also when it throws.
  struct Workspace {
    cholmod_common* c;
    cholmod_dense* X = nullptr;
    cholmod_dense* Y = nullptr;
    cholmod_dense* E = nullptr;
    explicit Workspace(cholmod_common* common) : c(common) {}
    Workspace(const Workspace&) = delete;
    Workspace& operator=(const Workspace&) = delete;
    ~Workspace() {
      cholmod_l_free_dense(&X, c);
      cholmod_l_free_dense(&Y, c);
      cholmod_l_free_dense(&E, c);
    }
  };

  [[nodiscard]] cholmod_dense dense(Scalar* data, Eigen::Index columns, Eigen::Index stride) const {
    cholmod_dense d{};
    d.nrow = static_cast<std::size_t>(stages_.rows());
    d.ncol = static_cast<std::size_t>(columns);
    d.d = static_cast<std::size_t>(columns == 1 ? stages_.rows() : stride);
    d.nzmax = d.d * d.ncol;
    d.x = data;
    d.xtype = xtype<Scalar>;
    d.dtype = CHOLMOD_DOUBLE;
    return d;
  }

  [[noreturn]] void not_positive_definite(SuiteSparse_long column, const char* what) const {
    throw SolveError("CHOLMOD factorisation: the matrix is " + std::string(what) + " (found at column " +
                     std::to_string(column) + ")");
  }

  /// Throws when a pivot has lost all its digits or is not a number.
  void check_pivots(const SparseMatrix<Scalar>& A) const {
    if (L_->is_super == 0) return;
    const auto* super = static_cast<const SuiteSparse_long*>(L_->super);
    const auto* pi = static_cast<const SuiteSparse_long*>(L_->pi);
    const auto* px = static_cast<const SuiteSparse_long*>(L_->px);
    const auto* perm = static_cast<const SuiteSparse_long*>(L_->Perm);
    const auto* x = static_cast<const Scalar*>(L_->x);
    const VectorX<double> diagonal = A.diagonal().real();
    for (std::size_t s = 0; s < L_->nsuper; ++s) {
      const SuiteSparse_long height = pi[s + 1] - pi[s];
      for (SuiteSparse_long j = super[s]; j < super[s + 1]; ++j) {
        const double pivot = std::real(x[px[s] + (j - super[s]) * (height + 1)]);
        if (!(pivot * pivot > singular_pivot * diagonal[perm[j]])) {
          not_positive_definite(perm[j], "singular to working precision");
        }
      }
    }
  }

  /// Where each row of A is in the factor, and the supernode of each of its columns.
  void index_factor() {
    if (L_->is_super == 0) return;
    const auto* super = static_cast<const SuiteSparse_long*>(L_->super);
    const auto* perm = static_cast<const SuiteSparse_long*>(L_->Perm);
    position_.resize(L_->n);
    super_of_.resize(L_->n);
    for (std::size_t j = 0; j < L_->n; ++j) position_[static_cast<std::size_t>(perm[j])] = static_cast<Index>(j);
    for (std::size_t s = 0; s < L_->nsuper; ++s)
      for (SuiteSparse_long j = super[s]; j < super[s + 1]; ++j)
        super_of_[static_cast<std::size_t>(j)] = static_cast<Index>(s);
  }

  void release() {
    if (L_ != nullptr) cholmod_l_free_factor(&L_, &common_.c);
  }

  Stages stages_;
  Common common_;
  cholmod_factor* L_ = nullptr;
  Ordering asked_;
  Ordering used_;
  std::vector<Index> position_, super_of_;
};

}  // namespace

std::vector<Index> metis_order(const SparseMatrix<std::complex<double>>& A) {
  Common common;
  const View<std::complex<double>> view(A);
  std::vector<SuiteSparse_long> order(static_cast<std::size_t>(A.rows()));
  const std::lock_guard<std::mutex> lock(metis_lock());
  const int ordered = cholmod_l_metis(const_cast<cholmod_sparse*>(&view.a), nullptr, 0, 1, order.data(), &common.c);
  common.check("ordering");
  if (ordered == 0) throw SolveError("CHOLMOD ordering: failed");
  return {order.begin(), order.end()};
}

template <class Scalar>
SolverPtr<Scalar> make_cholmod(Ordering ordering, const SolverOptions& options) {
  return std::make_unique<Cholmod<Scalar>>(ordering, options);
}
template SolverPtr<double> make_cholmod<double>(Ordering, const SolverOptions&);
template SolverPtr<std::complex<double>> make_cholmod<std::complex<double>>(Ordering, const SolverOptions&);

}  // namespace alcap::detail
