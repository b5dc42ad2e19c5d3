// SPDX-License-Identifier: MIT
//
// together.h: sums over ranks, and failures of one that all must know of. Internal to src/distributed.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <exception>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "alcap/conventions.h"

namespace alcap::detail::distributed {

[[nodiscard]] int rank();
[[nodiscard]] int ranks();

/// Over all ranks; the order of the sum is MPI's, the same in every run.
[[nodiscard]] double sum(double value);
[[nodiscard]] std::int64_t sum(std::int64_t value);
[[nodiscard]] double largest(double value);
[[nodiscard]] std::int64_t largest(std::int64_t value);
[[nodiscard]] bool any(bool value);
/// Sum over the ranks before this one.
[[nodiscard]] std::int64_t sum_before(std::int64_t value);
void sum_all(std::span<double> values);
void sum_all(std::span<std::int64_t> values);
void largest_all(std::span<double> values);
/// Rank 0's values for all: what ranks compute alike may differ in its last bits between machines.
void share_from_first(std::span<double> values);
/// Least, mean and most of the ranks' values.
void spread(double value, double (&out)[3]);

/// The bytes of all ranks, end to end, on every rank.
[[nodiscard]] std::vector<char> gather_bytes(std::span<const char> mine);
template <class T>
[[nodiscard]] std::vector<T> gather_all(const std::vector<T>& mine) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::vector<char> bytes = gather_bytes({reinterpret_cast<const char*>(mine.data()), mine.size() * sizeof(T)});
  std::vector<T> all(bytes.size() / sizeof(T));
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(all.data()));
  return all;
}

/// Throws on all ranks what the first rank caught that caught anything. Defects of a mesh are put together.
void throw_together(const std::exception_ptr& caught);

/// body(), which is no business of the other ranks; what it throws on one rank is thrown on all.
template <class Body>
void agreed(Body&& body) {
  std::exception_ptr caught;
  try {
    body();
  } catch (...) {
    caught = std::current_exception();
  }
  throw_together(caught);
}

}  // namespace alcap::detail::distributed
