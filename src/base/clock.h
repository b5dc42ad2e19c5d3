// SPDX-License-Identifier: MIT
//
// clock.h: wall-clock times for reports.
#pragma once

#include <chrono>
#include <utility>

namespace alcap::detail {

class Stopwatch {
 public:
  /// Since construction or the last lap.
  [[nodiscard]] double seconds() const { return between(start_, Clock::now()); }
  /// The same, and starts again.
  double lap() {
    const Clock::time_point now = Clock::now();
    return between(std::exchange(start_, now), now);
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
  }

  Clock::time_point start_ = Clock::now();
};

}  // namespace alcap::detail
