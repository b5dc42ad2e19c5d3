// SPDX-License-Identifier: MIT
//
// parallel.h: the only door to oneTBB, which parallel.cpp alone includes. Loops write disjoint elements; reductions run
// over fixed chunks and add the partial results in order, so no result depends on the number of threads.
//
//   parallel_for(n, [&](std::int64_t i) { y[i] = 2 * x[i]; });
//   double s = parallel_sum<double>(n, [&](std::int64_t i) { return x[i] * y[i]; });
//   run_with_threads(4, [&] { ... everything inside uses at most 4 threads ... });
//
// Inside a ControlScope (cancel.h) loops ask between chunks whether they are to stop, on every thread, and then throw
// Cancelled. What a body throws ends the loop and reaches its caller; loops that run inside of other bodies are not
// touched by it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "src/base/cancel.h"

namespace alcap {

namespace detail {

/// A body that somebody else owns, without its type: parallel.cpp alone includes oneTBB and instantiates its loops.
struct RangeBody {
  void* body;
  void (*run)(void* body, std::int64_t begin, std::int64_t end);
};
struct PlainBody {
  void* body;
  void (*run)(void* body);
};

template <class Body>
[[nodiscard]] void* address_of(Body& body) {
  return const_cast<void*>(static_cast<const void*>(std::addressof(body)));
}

// parallel_ranges, run_with_threads and run_isolated, for a body without its type.
void run_ranges(std::int64_t n, std::int64_t grain, RangeBody body);
void run_in_arena(int threads, PlainBody body);
void run_apart(PlainBody body);

}  // namespace detail

/// Elements per chunk of a reduction or scan. Part of the definition of every reduced value: changing it changes
/// last bits of sums. Large enough that a chunk outweighs a task, small enough to balance 50K-triangle meshes.
inline constexpr std::int64_t reduction_chunk = 4096;

/// Below this many elements a loop runs on the calling thread.
inline constexpr std::int64_t sequential_below = 2048;

/// The largest number of threads that options accept.
inline constexpr int most_threads = 4096;

/// The most threads that a loop started here uses.
[[nodiscard]] int thread_limit();

/// Calls body(begin, end) over disjoint ranges that cover [0, n); range limits are multiples of `grain`. One thread
/// gets one range: on small meshes the scheduling of tasks would take a tenth of a run.
template <class Body>
void parallel_ranges(std::int64_t n, std::int64_t grain, Body&& body) {
  if (n <= 0) return;
  using Own = std::remove_reference_t<Body>;
  detail::run_ranges(n, grain, {detail::address_of(body), [](void* own, std::int64_t begin, std::int64_t end) {
                                  (*static_cast<Own*>(own))(begin, end);
                                }});
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
  using Own = std::remove_reference_t<Body>;
  detail::run_in_arena(threads, {detail::address_of(body), [](void* own) { (*static_cast<Own*>(own))(); }});
}

/// Runs body so that this thread, while it waits for loops inside, takes no work from outside of them: for what must
/// not be entered twice by one thread, such as the initialisation under a std::once_flag.
template <class Body>
void run_isolated(Body&& body) {
  using Own = std::remove_reference_t<Body>;
  detail::run_apart({detail::address_of(body), [](void* own) { (*static_cast<Own*>(own))(); }});
}

}  // namespace alcap
