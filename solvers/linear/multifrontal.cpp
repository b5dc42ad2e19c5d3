// SPDX-License-Identifier: MIT
#include "solvers/linear/multifrontal.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <utility>

#include "src/base/cancel.h"
#include "src/base/parallel.h"
#include "src/simd/dispatch.h"

namespace alcap::detail {
namespace {

using std::complex;
using Matrix = SparseMatrix<complex<double>>;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

constexpr const char* no_memory_to_count =
    "inertia: out of memory; EigenOptions::prove_smallest 'never' leaves the count out of a solve";

/// calls use(i, j) for the entries of column j above the diagonal, in positions.
template <class Use>
void for_upper(const Matrix& A, const std::vector<Index>& column, const std::vector<Index>& position, Index j,
               Use&& use) {
  for (Matrix::InnerIterator it(A, column[at(j)]); it; ++it) {
    const Index i = position[at(it.row())];
    if (i < j) use(i);
  }
}

/// The elimination tree (Liu 1986): the parent of every column, none at roots.
std::vector<Index> elimination_tree(const Matrix& A, const std::vector<Index>& column,
                                    const std::vector<Index>& position) {
  const auto n = static_cast<Index>(column.size());
  std::vector<Index> parent(at(n), none), ancestor(at(n), none);
  for (Index j = 0; j < n; ++j) {
    check_cancelled_at(j);
    for_upper(A, column, position, j, [&](Index i) {
      while (i != none && i != j) {
        const Index up = ancestor[at(i)];
        ancestor[at(i)] = j;
        if (up == none) parent[at(i)] = j;
        i = up;
      }
    });
  }
  return parent;
}

/// Columns in postorder: children before parents, subtrees in one piece.
std::vector<Index> postorder(const std::vector<Index>& parent) {
  const auto n = static_cast<Index>(parent.size());
  std::vector<Index> child(at(n), none), sibling(at(n), none), order, stack;
  std::vector<Index> roots;
  for (Index j = n - 1; j >= 0; --j) {
    if (parent[at(j)] == none) {
      roots.push_back(j);
      continue;
    }
    sibling[at(j)] = child[at(parent[at(j)])];
    child[at(parent[at(j)])] = j;
  }
  order.reserve(at(n));
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) {
    stack.push_back(*root);
    while (!stack.empty()) {
      const Index j = stack.back();
      if (child[at(j)] != none) {
        stack.push_back(std::exchange(child[at(j)], sibling[at(child[at(j)])]));
      } else {
        order.push_back(j);
        stack.pop_back();
      }
    }
  }
  return order;
}

/// Entries of every column of L, the diagonal included.
std::vector<std::int64_t> column_counts(const Matrix& A, const std::vector<Index>& column,
                                        const std::vector<Index>& position, const std::vector<Index>& parent) {
  const auto n = static_cast<Index>(column.size());
  std::vector<std::int64_t> count(at(n), 1);
  std::vector<Index> seen(at(n), none);
  for (Index i = 0; i < n; ++i) {
    check_cancelled_at(i);
    seen[at(i)] = i;
    // Row i of L is the part of the tree between the entries of row i of A and i.
    for_upper(A, column, position, i, [&](Index k) {
      for (; seen[at(k)] != i; k = parent[at(k)]) {
        seen[at(k)] = i;
        ++count[at(k)];
      }
    });
  }
  return count;
}

/// Whether a supernode of `columns` columns, of whose entries this part would be zeros that are stored, is better than
/// two: small fronts cost more for their bookkeeping than for their arithmetic.
bool worth_merging(Index columns, double zeros) {
  return columns <= 8 || (columns <= 24 && zeros < 0.6) || (columns <= 48 && zeros < 0.15) || zeros < 0.05;
}

constexpr int panel = simd::front_panel;

/// Numbers from one row of a front to the next.
std::int64_t stride_of(std::int64_t rows) { return (rows + panel + 7) / 8 * 8; }

/// Subtrees with less than this part of all work are handled as a whole, by one thread each.
constexpr double subtree_part = 1.0 / 32;
/// Fronts of so many rows share their rows among threads, in pieces of so many.
constexpr std::int64_t shared_front = 256;
constexpr std::int64_t shared_rows = 32;

}  // namespace

std::vector<Index> fill_reducing_order(const Matrix& A) {
#ifdef ALCAP_WITH_CHOLMOD
  if (A.rows() > metis_above_rows) return metis_order(A);
#endif
  return dissection_order(A);
}

Multifrontal::Multifrontal(const Matrix& A) {
  try {
    order(A);
    find_supernodes(A);
    find_rows(A);
    predict();
    cut_subtrees();
  } catch (const std::bad_alloc&) {
    throw SolveError(no_memory_to_count);
  }
}

void Multifrontal::order(const Matrix& A) {
  column_ = fill_reducing_order(A);
  check_cancelled();
  position_.resize(column_.size());
  const auto invert = [&] {
    for (std::size_t k = 0; k < column_.size(); ++k) position_[at(column_[k])] = static_cast<Index>(k);
  };
  invert();
  const std::vector<Index> post = postorder(elimination_tree(A, column_, position_));
  std::vector<Index> sorted(column_.size());
  for (std::size_t k = 0; k < post.size(); ++k) sorted[k] = column_[at(post[k])];
  column_ = std::move(sorted);
  invert();
}

void Multifrontal::find_supernodes(const Matrix& A) {
  const std::vector<Index> parent = elimination_tree(A, column_, position_);
  const std::vector<std::int64_t> count = column_counts(A, column_, position_, parent);
  struct Super {
    Index first, last;
    std::int64_t front;  // rows of the front
    double zeros;        // stored entries that are zero
  };
  std::vector<Super> done;
  const auto n = static_cast<Index>(column_.size());
  for (Index j = 0; j < n;) {
    Super s{.first = j, .last = j, .front = count[at(j)], .zeros = 0};
    while (s.last + 1 < n && parent[at(s.last)] == s.last + 1 && count[at(s.last)] == count[at(s.last + 1)] + 1)
      ++s.last;
    j = s.last + 1;
    // The last child of s stands right before it.
    while (!done.empty() && parent[at(done.back().last)] >= s.first && parent[at(done.back().last)] <= s.last) {
      const Super& c = done.back();
      const std::int64_t own = c.last - c.first + 1;
      Super both{.first = c.first, .last = s.last, .front = own + s.front, .zeros = 0};
      both.zeros = c.zeros + s.zeros + static_cast<double>(own) * static_cast<double>(both.front - c.front);
      const Index columns = both.last - both.first + 1;
      const double all =
          static_cast<double>(columns) * (static_cast<double>(both.front) - 0.5 * static_cast<double>(columns - 1));
      if (!worth_merging(columns, both.zeros / all)) break;
      s = both;
      done.pop_back();
    }
    done.push_back(s);
  }
  std::vector<Index> super_of(at(n));
  for (std::size_t s = 0; s < done.size(); ++s) {
    first_.push_back(done[s].first);
    for (Index j = done[s].first; j <= done[s].last; ++j) super_of[at(j)] = static_cast<Index>(s);
  }
  first_.push_back(n);
  for (const Super& s : done) parent_.push_back(parent[at(s.last)] == none ? none : super_of[at(parent[at(s.last)])]);
}

void Multifrontal::find_rows(const Matrix& A) {
  std::vector<Index> seen(column_.size(), none);
  std::vector<std::vector<Index>> children(parent_.size());
  rows_begin_.push_back(0);
  for (Index s = 0; s < supernodes(); ++s) {
    check_cancelled_at(s);
    const Index begin = first_[at(s)], end = first_[at(s) + 1];
    const std::int64_t start = rows_begin_.back();
    for (Index j = begin; j < end; ++j) rows_.push_back(j);
    const auto add = [&](Index i) {
      if (i < end || seen[at(i)] == s) return;
      seen[at(i)] = s;
      rows_.push_back(i);
    };
    for (Index j = begin; j < end; ++j)
      for (Matrix::InnerIterator it(A, column_[at(j)]); it; ++it) add(position_[at(it.row())]);
    for (const Index c : children[at(s)])
      for (std::int64_t k = rows_begin_[at(c)] + columns(c); k < rows_begin_[at(c) + 1]; ++k) add(rows_[at(k)]);
    std::sort(rows_.begin() + start + (end - begin), rows_.end());
    rows_begin_.push_back(static_cast<std::int64_t>(rows_.size()));
    if (parent_[at(s)] != none) children[at(parent_[at(s)])].push_back(s);
    children[at(s)] = {};
  }
}

void Multifrontal::predict() {
  std::vector<double> waiting(parent_.size(), 0);  // bytes of the children's updates
  double stack = 0;
  for (Index s = 0; s < supernodes(); ++s) {
    const auto rows = static_cast<double>(front_rows(s)), own = static_cast<double>(columns(s));
    // A pivot costs 4 (rows below)^2 operations: real ones, half a matrix.
    const double last = rows - own;
    flops_ += 4.0 / 3 * (rows * rows * rows - last * last * last);
    const double front = 16 * rows * static_cast<double>(stride_of(front_rows(s)));
    bytes_ = std::max(bytes_, stack + front);
    const double update = 8 * last * (last + 1);
    stack += update - waiting[at(s)];
    if (parent_[at(s)] != none) waiting[at(parent_[at(s)])] += update;
    bytes_ = std::max(bytes_, stack + front);
  }
  bytes_ += static_cast<double>(rows_.size() * sizeof(Index) + column_.size() * 64);
}

void Multifrontal::cut_subtrees() {
  std::vector<double> work(parent_.size(), 0);
  leftmost_.resize(parent_.size());
  std::iota(leftmost_.begin(), leftmost_.end(), Index{0});
  for (Index s = 0; s < supernodes(); ++s) {
    const auto rows = static_cast<double>(front_rows(s)), last = rows - static_cast<double>(columns(s));
    work[at(s)] += rows * rows * rows - last * last * last + 1000 * rows;
    if (parent_[at(s)] == none) continue;
    work[at(parent_[at(s)])] += work[at(s)];
    Index& left = leftmost_[at(parent_[at(s)])];
    left = std::min(left, leftmost_[at(s)]);
  }
  double all = 0;
  for (Index s = 0; s < supernodes(); ++s)
    if (parent_[at(s)] == none) all += work[at(s)];
  for (Index s = 0; s < supernodes(); ++s) {
    if (work[at(s)] > subtree_part * all) {
      top_.push_back(s);
    } else if (parent_[at(s)] == none || work[at(parent_[at(s)])] > subtree_part * all) {
      subtrees_.push_back(s);
    }
  }
  std::stable_sort(subtrees_.begin(), subtrees_.end(), [&](Index a, Index b) { return work[at(a)] > work[at(b)]; });
}

/// Eliminates supernodes one after another.
class Multifrontal::Task {
 public:
  /// The lower triangle of an update matrix, row after row, pairs.
  using Update = std::vector<complex<double>>;

  struct Shared {
    const Multifrontal& tree;
    const Matrix& A;
    std::int64_t most;
    std::vector<Update> updates;           // by supernode, of those that wait for their parent
    std::vector<std::vector<Index>> kids;  // of each supernode
    std::atomic<std::int64_t> negative{0};
    std::atomic<bool> broken{false};
  };

  Task(Shared& shared, bool share_fronts) : shared_(shared), tree_(shared.tree), share_fronts_(share_fronts) {
    place_.resize(tree_.column_.size());
  }

  /// False when there is no need to go on.
  bool eliminate(Index s) {
    check_cancelled();
    if (shared_.broken || shared_.negative > shared_.most) return false;
    rows_ = tree_.front_rows(s);
    stride_ = stride_of(rows_);
    const auto size = static_cast<std::size_t>(rows_ * stride_);
    re_.assign(size, 0.0);
    im_.assign(size, 0.0);
    assemble(s);
    std::int64_t negative = 0;
    for (std::int64_t first = 0; first < tree_.columns(s); first += panel) {
      const int depth = static_cast<int>(std::min<std::int64_t>(panel, tree_.columns(s) - first));
      if (!eliminate_panel(s, first, depth, negative)) {
        shared_.broken = true;
        return false;
      }
    }
    shared_.negative += negative;
    keep_update(s);
    return true;
  }

  /// Where |L| |D| |L|^H exceeds A: 2 |d_p| |l_ip|^2 of negative pivots p.
  [[nodiscard]] const std::vector<std::pair<Index, double>>& grown() const { return grown_; }

 private:
  [[nodiscard]] std::int64_t row(Index s, std::int64_t k) const {
    return tree_.rows_[at(tree_.rows_begin_[at(s)] + k)];
  }

  void assemble(Index s) {
    for (std::int64_t k = 0; k < rows_; ++k) place_[at(row(s, k))] = static_cast<Index>(k);
    const Index begin = tree_.first_[at(s)];
    for (Index c = 0; c < tree_.columns(s); ++c)
      for (Matrix::InnerIterator it(shared_.A, tree_.column_[at(begin + c)]); it; ++it) {
        const Index i = tree_.position_[at(it.row())];
        if (i < begin + c) continue;
        const std::int64_t to = place_[at(i)] * stride_ + c;
        re_[at(to)] += it.value().real();
        im_[at(to)] += i == begin + c ? 0.0 : it.value().imag();
      }
    for (const Index child : shared_.kids[at(s)]) {
      Update update = std::move(shared_.updates[at(child)]);
      const std::int64_t own = tree_.columns(child), count = tree_.front_rows(child) - own;
      to_.resize(at(count));
      for (std::int64_t k = 0; k < count; ++k) to_[at(k)] = place_[at(row(child, own + k))];
      const complex<double>* from = update.data();
      for (std::int64_t k = 0; k < count; ++k) {
        double* const re = re_.data() + to_[at(k)] * stride_;
        double* const im = im_.data() + to_[at(k)] * stride_;
        for (std::int64_t l = 0; l <= k; ++l, ++from) {
          re[to_[at(l)]] += from->real();
          im[to_[at(l)]] += from->imag();
        }
      }
    }
  }

  /// Columns first ... first + depth - 1; false for a pivot without a sign.
  bool eliminate_panel(Index s, std::int64_t first, int depth, std::int64_t& negative) {
    double own_re[panel * panel] = {}, own_im[panel * panel] = {}, pivots[panel] = {}, inverse[panel] = {};
    below_re_.resize(at(panel * stride_));
    below_im_.resize(at(panel * stride_));
    const simd::RawFront front{re_.data(), im_.data(), stride_};
    simd::RawPanel P{first, depth, inverse, own_re, own_im, below_re_.data(), below_im_.data()};
    const simd::FrontLoops& loops = simd::loops().front;
    for (int q = 0; q < depth; ++q) {
      // Row q of the panel against the pivots before it.
      P.depth = q;
      const std::int64_t i = first + q;
      loops.panel(front, P, i, i + 1);
      for (int p = 0; p < q; ++p) {
        own_re[panel * p + q] = below_re_[at(p * stride_ + i)];
        own_im[panel * p + q] = below_im_[at(p * stride_ + i)];
      }
      pivots[q] = re_[at(i * stride_ + i)];
      for (int p = 0; p < q; ++p) {
        const double re = own_re[panel * p + q], im = own_im[panel * p + q];
        pivots[q] -= (re * re + im * im) * inverse[p];
      }
      if (!(std::abs(pivots[q]) > 0) || !std::isfinite(pivots[q])) return false;
      inverse[q] = 1 / pivots[q];
      negative += pivots[q] < 0;
    }
    P.depth = depth;
    const std::int64_t end = first + depth;
    const auto rows = [&](std::int64_t begin, std::int64_t stop) { loops.panel(front, P, end + begin, end + stop); };
    const auto trailing = [&](std::int64_t begin, std::int64_t stop) {
      loops.update(front, P, end, end + begin, end + stop);
    };
    if (share_fronts_ && rows_ - end >= shared_front) {
      parallel_ranges(rows_ - end, shared_rows, rows);
      parallel_ranges(rows_ - end, shared_rows, trailing);
    } else {
      rows(0, rows_ - end);
      trailing(0, rows_ - end);
    }
    for (int p = 0; p < depth; ++p)
      if (pivots[p] < 0) grow(s, first + p, -2 * pivots[p]);
    return true;
  }

  void grow(Index s, std::int64_t p, double weight) {
    grown_.emplace_back(static_cast<Index>(row(s, p)), weight);
    for (std::int64_t k = p + 1; k < rows_; ++k) {
      const double re = re_[at(k * stride_ + p)], im = im_[at(k * stride_ + p)];
      grown_.emplace_back(static_cast<Index>(row(s, k)), weight * (re * re + im * im));
    }
  }

  void keep_update(Index s) {
    const std::int64_t own = tree_.columns(s), count = rows_ - own;
    if (count == 0) return;
    Update& update = shared_.updates[at(s)];
    update.resize(at(count * (count + 1) / 2));
    complex<double>* to = update.data();
    for (std::int64_t k = own; k < rows_; ++k)
      for (std::int64_t l = own; l <= k; ++l) *to++ = {re_[at(k * stride_ + l)], im_[at(k * stride_ + l)]};
  }

  Shared& shared_;
  const Multifrontal& tree_;
  bool share_fronts_;
  std::int64_t rows_ = 0, stride_ = 0;
  std::vector<double> re_, im_, below_re_, below_im_;  // the front, and Y of its panel
  std::vector<Index> place_, to_;                      // of rows in the front
  std::vector<std::pair<Index, double>> grown_;
};

PivotCount Multifrontal::count(const Matrix& A, const VectorX<double>& weights, std::int64_t most) const {
  try {
    Task::Shared shared{.tree = *this, .A = A, .most = most, .updates = {}, .kids = {}};
    shared.updates.resize(parent_.size());
    shared.kids.resize(parent_.size());
    for (Index s = 0; s < supernodes(); ++s)
      if (parent_[at(s)] != none) shared.kids[at(parent_[at(s)])].push_back(s);
    std::vector<std::vector<std::pair<Index, double>>> grown(subtrees_.size() + 1);
    parallel_for(
        static_cast<std::int64_t>(subtrees_.size()),
        [&](std::int64_t k) {
          Task task(shared, false);
          const Index root = subtrees_[at(k)];
          for (Index s = leftmost_[at(root)]; s <= root; ++s)
            if (!task.eliminate(s)) break;
          grown[at(k)] = task.grown();
        },
        1);
    Task task(shared, true);
    for (const Index s : top_)
      if (!task.eliminate(s)) break;
    grown.back() = task.grown();

    PivotCount result{.negative = shared.negative, .complete = shared.negative <= most, .broken = shared.broken};
    VectorX<double> g(A.rows());
    for (Index j = 0; j < A.cols(); ++j) g[j] = std::abs(A.coeff(j, j));
    for (const auto& list : grown)
      for (const auto& [position, amount] : list) g[column_[at(position)]] += amount;
    for (Eigen::Index j = 0; j < g.size(); ++j) result.growth = std::max(result.growth, g[j] / weights[j]);
    return result;
  } catch (const std::bad_alloc&) {
    throw SolveError(no_memory_to_count);
  }
}

}  // namespace alcap::detail
