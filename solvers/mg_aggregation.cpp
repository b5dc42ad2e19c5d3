// SPDX-License-Identifier: MIT
//
// mg_aggregation.cpp: which vertices become one. Greedy in fixed pieces of the rows, each in their order, so that
// pieces run side by side and the result does not depend on threads; what stays over joins its strongest neighbour.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "solvers/mg_hierarchy.h"

namespace alcap::detail {
namespace {

/// Rows that are aggregated by one task. Part of the definition of the hierarchy.
constexpr std::int64_t piece = 16384;

ComplexF unit(ComplexF z) { return z / std::sqrt(std::norm(z)); }

class Aggregation {
 public:
  explicit Aggregation(const Level& level)
      : level_(level), A_(level.off), rows_(level.rows()), pieces_((rows_ + piece - 1) / piece) {
    result_.aggregate = Buffer<Index>(rows_);
    result_.transport = Buffer<ComplexF>(rows_);
    sizes_.resize(static_cast<std::size_t>(pieces_));
  }

  Aggregates run() {
    parallel_for(
        pieces_, [this](std::int64_t p) { roots(p); }, 1);
    number();
    parallel_for(
        rows_, [this](std::int64_t i) { join(static_cast<Index>(i)); }, mg_grain);
    finish();
    return std::move(result_);
  }

 private:
  /// A vertex whose strong neighbours in its piece are all free, and are most of its neighbours, takes them all.
  void roots(std::int64_t p) {
    const std::int64_t begin = p * piece, end = std::min<std::int64_t>(rows_, begin + piece);
    std::fill(result_.aggregate.data() + begin, result_.aggregate.data() + end, none);
    std::fill(result_.transport.data() + begin, result_.transport.data() + end, 1.0F);
    std::vector<Index>& sizes = sizes_[static_cast<std::size_t>(p)];
    for (std::int64_t i = begin; i < end; ++i) {
      if (result_.aggregate[i] != none) continue;
      Index inside = 0, outside = 0;
      bool all_free = true;
      for (std::int64_t e = A_.start[i]; e < A_.start[i + 1] && all_free; ++e) {
        if (!strong(A_.value[e])) continue;
        const Index j = A_.column[e];
        const bool here = begin <= j && j < end;
        ++(here ? inside : outside);
        all_free = !here || result_.aggregate[j] == none;
      }
      if (!all_free || inside == 0 || inside < outside) continue;
      const auto id = static_cast<Index>(sizes.size());
      result_.aggregate[i] = id;
      for (std::int64_t e = A_.start[i]; e < A_.start[i + 1]; ++e) {
        const Index j = A_.column[e];
        if (j < begin || j >= end || !strong(A_.value[e])) continue;
        result_.aggregate[j] = id;
        result_.transport[j] = unit(-std::conj(A_.value[e]));  // from i to j
      }
      sizes.push_back(inside + 1);
    }
  }

  /// From numbers within a piece to numbers of the whole.
  void number() {
    std::vector<Index> base(static_cast<std::size_t>(pieces_));
    for (std::size_t p = 0; p < base.size(); ++p) {
      base[p] = result_.count;
      result_.count += static_cast<Index>(sizes_[p].size());
    }
    size_ = Buffer<Index>(result_.count);
    parallel_for(
        pieces_,
        [&](std::int64_t p) {
          const auto at = static_cast<std::size_t>(p);
          std::copy(sizes_[at].begin(), sizes_[at].end(), size_.data() + base[at]);
          for (std::int64_t i = p * piece; i < std::min<std::int64_t>(rows_, (p + 1) * piece); ++i)
            if (result_.aggregate[i] != none) result_.aggregate[i] += base[at];
        },
        1);
  }

  /// Aggregates of the first round are told from later ones by their sign.
  static constexpr Index later(Index a) { return -2 - a; }

  Index seen(std::int64_t i) { return std::atomic_ref<Index>(result_.aggregate[i]).load(std::memory_order_relaxed); }

  /// A vertex left over joins the aggregate of the first round that it is most coupled to, smaller ones first.
  void join(Index i) {
    if (seen(i) != none) return;
    struct Pull {
      Index aggregate;
      ComplexF value;
    };
    constexpr int most = 16;  // more than that: the first ones it has
    Pull pull[most];
    int count = 0;
    for (std::int64_t e = A_.start[i]; e < A_.start[i + 1]; ++e) {
      const Index j = A_.column[e];
      if (!strong(A_.value[e])) continue;
      const Index a = seen(j);
      if (a < 0) continue;
      const ComplexF value = -A_.value[e] * result_.transport[j] * level_.near[j];
      int k = 0;
      while (k < count && pull[k].aggregate != a) ++k;
      if (k < count) {
        pull[k].value += value;
      } else if (count < most) {
        pull[count++] = {a, value};
      }
    }
    float best = 0;
    for (int k = 0; k < count; ++k) {
      const float score =
          std::sqrt(std::norm(pull[k].value)) / (1 + 0.1F * static_cast<float>(size_[pull[k].aggregate]));
      if (!(score > best)) continue;
      best = score;
      std::atomic_ref<Index>(result_.aggregate[i]).store(later(pull[k].aggregate), std::memory_order_relaxed);
      result_.transport[i] = unit(pull[k].value);
    }
  }

  /// Vertices that no aggregate touches form new ones among themselves.
  void finish() {
    const bool left = parallel_reduce(
        std::int64_t{rows_}, false,
        [&](std::int64_t begin, std::int64_t end) {
          bool any = false;
          for (std::int64_t i = begin; i < end; ++i) {
            Index& a = result_.aggregate[i];
            if (a < none) a = later(a);
            any |= a == none;
          }
          return any;
        },
        [](bool a, bool b) { return a || b; });
    if (!left) return;
    for (Index i = 0; i < rows_; ++i) {
      if (result_.aggregate[i] != none) continue;
      bool any = false;
      for (std::int64_t e = A_.start[i]; e < A_.start[i + 1]; ++e) {
        const Index j = A_.column[e];
        if (!strong(A_.value[e]) || result_.aggregate[j] != none) continue;
        any = true;
        result_.aggregate[j] = result_.count;
        result_.transport[j] = unit(-std::conj(A_.value[e]));
      }
      if (any) result_.aggregate[i] = result_.count++;
    }
  }

  const Level& level_;
  const Rows& A_;
  Index rows_;
  std::int64_t pieces_;
  Aggregates result_;
  std::vector<std::vector<Index>> sizes_;  // per piece
  Buffer<Index> size_;                     // per aggregate of the first round
};

}  // namespace

Aggregates aggregate(const Level& level) { return Aggregation(level).run(); }

}  // namespace alcap::detail
