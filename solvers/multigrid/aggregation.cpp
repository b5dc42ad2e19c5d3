// SPDX-License-Identifier: MIT
//
// aggregation.cpp: which vertices become one. Roots are found greedily in the order of the rows, on one thread
// (one percent of a solve; cutting the rows into pieces that run side by side costs convergence where neighbours lie
// in different pieces); what stays over joins its strongest neighbour, in parallel.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "solvers/multigrid/hierarchy.h"
#include "src/base/cancel.h"

namespace alcap::detail {
namespace {

ComplexF unit(ComplexF z) { return z / std::sqrt(std::norm(z)); }

class Aggregation {
 public:
  explicit Aggregation(const Level& level) : level_(level), A_(level.off), g_(level.guided()), rows_(level.rows()) {
    result_.aggregate = Buffer<Index>(rows_);
    result_.transport = Buffer<ComplexF>(rows_);
    parallel_for(rows_, [this](std::int64_t i) {
      result_.aggregate[i] = none;
      result_.transport[i] = 1;
    });
  }

  Aggregates run() {
    for (Index i = 0; i < rows_; ++i) {
      check_cancelled_at(i);
      root(i);
    }
    parallel_for(
        rows_, [this](std::int64_t i) { join(static_cast<Index>(i)); }, mg_grain);
    finish();
    return std::move(result_);
  }

 private:
  /// A vertex whose strong neighbours are all free takes them all.
  void root(Index i) {
    if (result_.aggregate[i] != none) return;
    Index size = 1;
    for (std::int64_t e = A_.start[i]; e < A_.start[i + 1]; ++e) {
      if (!strong(g_[e])) continue;
      if (result_.aggregate[A_.column[e]] != none) return;
      ++size;
    }
    if (size == 1) return;
    result_.aggregate[i] = result_.count;
    for (std::int64_t e = A_.start[i]; e < A_.start[i + 1]; ++e) {
      if (strong(g_[e])) take(A_.column[e], g_[e]);
    }
    ++result_.count;
    sizes_.push_back(size);
  }

  /// Vertex j joins the newest aggregate, along the entry (root, j).
  void take(Index j, ComplexF entry) {
    result_.aggregate[j] = result_.count;
    result_.transport[j] = unit(-std::conj(entry));
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
      if (!strong(g_[e])) continue;
      const Index a = seen(j);
      if (a < 0) continue;
      const ComplexF value = -g_[e] * result_.transport[j] * level_.guided_near()[j];
      int k = 0;
      while (k < count && pull[k].aggregate != a) ++k;
      if (k < count) {
        pull[k].value += value;
      } else if (count < most) {
        pull[count++] = {a, value};
      }
    }
    // An aggregate of ten pulls half as much as an empty one: sizes stay even.
    constexpr float crowding = 0.1F;
    float best = 0;
    for (int k = 0; k < count; ++k) {
      const float score = std::sqrt(std::norm(pull[k].value)) /
                          (1 + crowding * static_cast<float>(sizes_[static_cast<std::size_t>(pull[k].aggregate)]));
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
        if (!strong(g_[e]) || result_.aggregate[j] != none) continue;
        any = true;
        take(j, g_[e]);
      }
      if (any) result_.aggregate[i] = result_.count++;
    }
  }

  const Level& level_;
  const Rows& A_;
  const Buffer<ComplexF>& g_;
  Index rows_;
  Aggregates result_;
  std::vector<Index> sizes_;  // of the aggregates of the first round
};

}  // namespace

Aggregates aggregate(const Level& level) { return Aggregation(level).run(); }

}  // namespace alcap::detail
