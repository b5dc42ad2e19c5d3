// SPDX-License-Identifier: MIT
//
// parallel.h: the only door to oneTBB. Loops write disjoint elements; reductions run over fixed chunks and add
// the partial results in order, so no result depends on the number of threads.
//
//   parallel_for(n, [&](std::int64_t i) { y[i] = 2 * x[i]; });
//   double s = parallel_sum<double>(n, [&](std::int64_t i) { return x[i] * y[i]; });
//   run_with_threads(4, [&] { ... everything inside uses at most 4 threads ... });
//
// Inside a ControlScope (cancel.h) loops ask between chunks whether they are to stop, on every thread, and then throw
// Cancelled. What a body throws ends the loop and reaches its caller; loops that run inside of other bodies are not
// touched by it.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

#include "src/base/cancel.h"

// ThreadSanitizer cannot find the line of every access in code that was inlined into the scheduler. So bodies have
// frames of their own there, and tests/support/tsan.supp silences the scheduler by the name of its functions; what it
// passes to a body, which it synchronises in ways that are not seen, is read without checks.
#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#define ALCAP_OWN_FRAME [[gnu::noinline]]
#define ALCAP_UNCHECKED __attribute__((no_sanitize("thread")))
#else
#define ALCAP_OWN_FRAME
#define ALCAP_UNCHECKED
#endif

namespace alcap {

namespace detail {

/// Tells ThreadSanitizer what it cannot see inside TBB: what was written before a parallel region is visible in its
/// bodies, and what they wrote is visible after it, also where an exception ends them. Races between the bodies stay
/// visible. Compiles to nothing otherwise.
class Region {
#if defined(__SANITIZE_THREAD__)
 public:
  Region() { __tsan_release(&start_); }
  ~Region() { __tsan_acquire(&end_); }
  Region(const Region&) = delete;
  Region& operator=(const Region&) = delete;

  class Inside {
   public:
    explicit Inside(Region& region) : region_(region) { __tsan_acquire(&region_.start_); }
    ~Inside() { __tsan_release(&region_.end_); }
    Inside(const Inside&) = delete;
    Inside& operator=(const Inside&) = delete;

   private:
    Region& region_;
  };

 private:
  char start_ = 0;
  char end_ = 0;
#else
 public:
  struct Inside {
    explicit Inside(Region&) {}
  };
#endif
};

template <class Body, class... Arguments>
ALCAP_OWN_FRAME void run_body(Body& body, Arguments... arguments) {
  body(arguments...);
}

/// body(begin, end) for the range; inside a scope in pieces of `grain`, a check before each.
template <class Body>
void run_range(Body& body, std::int64_t begin, std::int64_t end, std::int64_t grain) {
  if (cancel::current == nullptr) {
    run_body(body, begin, end);
    return;
  }
  for (; begin < end; begin += grain) {
    check_cancelled();
    run_body(body, begin, std::min(end, begin + grain));
  }
}

}  // namespace detail

/// Elements per chunk of a reduction or scan. Part of the definition of every reduced value: changing it changes
/// last bits of sums. Large enough that a chunk outweighs a task, small enough to balance 50K-triangle meshes.
inline constexpr std::int64_t reduction_chunk = 4096;

/// Below this many elements a loop runs on the calling thread.
inline constexpr std::int64_t sequential_below = 2048;

/// The largest number of threads that options accept.
inline constexpr int most_threads = 4096;

/// The most threads that a loop started here uses.
[[nodiscard]] inline int thread_limit() { return tbb::this_task_arena::max_concurrency(); }

/// Calls body(begin, end) over disjoint ranges that cover [0, n); range limits are multiples of `grain`. One thread
/// gets one range: on small meshes the scheduling of tasks would take a tenth of a run.
template <class Body>
void parallel_ranges(std::int64_t n, std::int64_t grain, Body&& body) {
  if (n <= 0) return;
  const std::int64_t chunks = (n + grain - 1) / grain;
  if (chunks == 1 || thread_limit() == 1) {
    detail::run_range(body, 0, n, grain);
    return;
  }
  detail::Region region;
  detail::ControlScope* const scope = detail::cancel::current;
  const auto run = [&](const tbb::blocked_range<std::int64_t>& r) ALCAP_UNCHECKED {
    const detail::Region::Inside inside(region);
    const detail::CarriedScope carried(scope);
    detail::run_range(body, r.begin() * grain, std::min(n, r.end() * grain), grain);
  };
  // A group of its own: one that hangs on the group around it would, when another body of that throws, end here early
  // and without a word, and the body around this loop would go on with half of the results.
  tbb::task_group_context own(tbb::task_group_context::isolated);
  tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, chunks), run, own);
}

/// Calls body(i) for i in [0, n) in any order. Bodies must write disjoint elements.
template <class Body>
void parallel_for(std::int64_t n, Body&& body, std::int64_t grain = sequential_below) {
  parallel_ranges(n, grain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) body(i);
  });
}

/// Reduces over fixed chunks: chunk_value(begin, end) per chunk of `reduction_chunk` elements, combined in order by
/// total = join(total, chunk). Bitwise independent of the number of threads.
template <class T, class ChunkValue, class Join>
[[nodiscard]] T parallel_reduce(std::int64_t n, T init, ChunkValue&& chunk_value, Join&& join) {
  const std::int64_t chunks = (n + reduction_chunk - 1) / reduction_chunk;
  struct Slot {  // std::vector<bool> would pack neighbours into one byte
    T value;
  };
  std::vector<Slot> partial(static_cast<std::size_t>(std::max<std::int64_t>(chunks, 0)), Slot{init});
  parallel_for(
      chunks,
      [&](std::int64_t c) {
        partial[static_cast<std::size_t>(c)].value =
            chunk_value(c * reduction_chunk, std::min(n, (c + 1) * reduction_chunk));
      },
      1);
  T total = init;
  for (const Slot& p : partial) total = join(total, p.value);
  return total;
}

/// Sum of term(i) for i in [0, n), bitwise independent of the number of threads.
template <class T, class Term>
[[nodiscard]] T parallel_sum(std::int64_t n, Term&& term) {
  return parallel_reduce(
      n, T{},
      [&](std::int64_t begin, std::int64_t end) {
        T sum{};
        for (std::int64_t i = begin; i < end; ++i) sum += term(i);
        return sum;
      },
      [](const T& a, const T& b) { return a + b; });
}

/// Exclusive prefix sum in place of counts[0..n); returns the total. Two passes over fixed chunks.
template <class Int>
Int parallel_exclusive_scan(Int* counts, std::int64_t n) {
  const std::int64_t chunks = (n + reduction_chunk - 1) / reduction_chunk;
  std::vector<Int> base(static_cast<std::size_t>(std::max<std::int64_t>(chunks, 0)));
  const auto limits = [n](std::int64_t c) { return std::min(n, (c + 1) * reduction_chunk); };
  parallel_for(
      chunks,
      [&](std::int64_t c) {
        Int sum{};
        for (std::int64_t i = c * reduction_chunk; i < limits(c); ++i) sum += counts[i];
        base[static_cast<std::size_t>(c)] = sum;
      },
      1);
  Int total{};
  for (Int& b : base) {
    const Int here = b;
    b = total;
    total += here;
  }
  parallel_for(
      chunks,
      [&](std::int64_t c) {
        Int sum = base[static_cast<std::size_t>(c)];
        for (std::int64_t i = c * reduction_chunk; i < limits(c); ++i) {
          const Int here = counts[i];
          counts[i] = sum;
          sum += here;
        }
      },
      1);
  return total;
}

/// Runs body with at most `threads` threads (0: as many as there are). Nothing global is changed; more threads than the
/// machine has need a tbb::global_control of the caller's. Inside a smaller or larger arena of the caller's there are
/// the threads of that arena and no others. Inside an arena of one thread there is nothing to limit, and a second arena
/// would only cost time.
template <class Body>
void run_with_threads(int threads, Body&& body) {
  const int here = thread_limit();
  if (threads <= 0 || (threads == 1 && here == 1)) {
    body();
    return;
  }
  const auto allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  const int most = here == tbb::info::default_concurrency() ? static_cast<int>(allowed) : here;
  tbb::task_arena arena(std::min(threads, most));
  detail::Region region;
  detail::ControlScope* const scope = detail::cancel::current;
  arena.execute([&]() ALCAP_UNCHECKED {
    const detail::Region::Inside inside(region);
    const detail::CarriedScope carried(scope);
    detail::run_body(body);
  });
}

/// Runs body so that this thread, while it waits for loops inside, takes no work from outside of them: for what must
/// not be entered twice by one thread, such as the initialisation under a std::once_flag.
template <class Body>
void run_isolated(Body&& body) {
  tbb::this_task_arena::isolate(std::forward<Body>(body));
}

#undef ALCAP_OWN_FRAME
#undef ALCAP_UNCHECKED

}  // namespace alcap
