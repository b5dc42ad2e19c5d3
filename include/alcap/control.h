// SPDX-License-Identifier: MIT
//
// control.h: how a long call is stopped, watched and given its threads.
//
//   std::stop_source stop;   // another thread calls stop.request_stop()
//   alcap::FieldRun run = alcap::run_field(V, F, {.control = {.cancel = [&] { return stop.stop_requested(); }}});
//
// The options of long calls hold a RunControl. Calls without options, and several calls together, take one from
// controlled():
//
//   alcap::controlled({.cancel = stopped, .threads = 2}, [&] {
//     file = alcap::read_mesh("scan.ply");
//     surface = alcap::Surface(file.V, file.F);
//     alcap::write_mesh("copy.ply", file.V, file.F);
//   });
//
// `cancel` is honoured within a tenth of a second, with one exception: a step inside a factorisation that has begun
// (CHOLMOD's ordering or numeric part, Eigen's LDL') runs to its end, see SolverOptions::cancel. The call then throws
// Cancelled. Every object can be used again, and no file that was being written appears.
//
// Threads: loops run in the arena of the calling thread. Inside a tbb::task_arena of the caller the library uses that
// arena's threads and no others; `threads` can only lower their number. Results do not depend on any of it.
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

#include "alcap/errors.h"

namespace alcap {

/// How the caller of a long function hears of it and stops it.
struct RunControl {
  /// Asked by the call and by its loops, about every hundredth of a second, by one thread at a time, not always the
  /// same one; true ends the call with Cancelled. An exception thrown here ends the call as well and reaches the
  /// caller. Empty: the call cannot be stopped.
  std::function<bool()> cancel = {};
  /// Told on the calling thread when a phase begins ("read", "mesh", "connection", "solve", ...), with fraction 0, and,
  /// by phases that know how far they are, again about every hundredth of a second with the part that is done, in
  /// [0, 1]. An exception thrown here ends the call and reaches the caller.
  std::function<void(std::string_view phase, double fraction)> progress = {};
  /// The most threads; 0: all of the machine, or of the caller's tbb::task_arena. At most 4096.
  int threads = 0;
};

namespace detail {
/// controlled() for a body without result.
void run_controlled(const RunControl& control, const std::function<void()>& body);
}  // namespace detail

/// Calls body() and gives back what it returns. Every call of the library made in it, on this thread, honours
/// `control`, besides its own options; so do nested controlled() calls. Throws OptionError for bad `threads`,
/// Cancelled, and what body throws.
template <class Body>
auto controlled(const RunControl& control, Body&& body) {
  using Result = std::invoke_result_t<Body>;
  if constexpr (std::is_void_v<Result>) {
    detail::run_controlled(control, [&] { std::forward<Body>(body)(); });
  } else {
    std::optional<std::decay_t<Result>> result;
    detail::run_controlled(control, [&] { result.emplace(std::forward<Body>(body)()); });
    return std::move(*result);
  }
}

}  // namespace alcap
