// SPDX-License-Identifier: MIT
//
// cancel.h: what makes a RunControl reach every loop. A public long call opens a ControlScope; until it closes, the
// loops of parallel.h on this thread carry the scope to the threads they use and ask between their chunks, and long
// sequential loops call check_cancelled(). A scope belongs to the call, not to the process: calls on several threads do
// not see each other's. Without a scope a check is one comparison.
//
//   ControlScope scope(options.control);
//   report_phase("mesh");
//   for (Index v = 0; v < mesh.vertices(); ++v) {
//     check_cancelled_at(v);
//     ...
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string_view>
#include <utility>

#include "alcap/control.h"

namespace alcap::detail {

/// Elements that a sequential loop handles between two checks: well below a millisecond at 100 ns each, and the check's
/// 30 ns do not show.
inline constexpr std::int64_t check_every = 4096;

class ControlScope;

namespace cancel {
/// The innermost open scope of this thread.
inline constinit thread_local ControlScope* current = nullptr;
}  // namespace cancel

class ControlScope {
 public:
  /// Throws Cancelled when cancel() is true already, or that of an outer scope. `control` must outlive the scope.
  explicit ControlScope(const RunControl& control) : ControlScope(control.cancel, &control.progress) {}
  /// The same with a cancel alone.
  explicit ControlScope(const std::function<bool()>& cancel) : ControlScope(cancel, nullptr) {}
  ControlScope(const ControlScope&) = delete;
  ControlScope& operator=(const ControlScope&) = delete;
  ~ControlScope() { cancel::current = outer_; }

  /// Throws Cancelled when this scope or one around it has been cancelled. Asks at most every ask_every.
  void check();

  /// Whether cancel() of this scope, or of one around it, has said so.
  [[nodiscard]] bool cancelled() const;

  /// Tells the innermost scope that has a progress; a fraction above 0 at most every ask_every.
  void report(std::string_view phase, double fraction);

 private:
  ControlScope(const std::function<bool()>& cancel, const std::function<void(std::string_view, double)>* progress);

  const std::function<bool()>* cancel_;                            // null: none
  const std::function<void(std::string_view, double)>* progress_;  // null: none
  ControlScope* outer_;
  std::atomic<bool> cancelled_{false};
  std::atomic<std::int64_t> next_ask_{0};  // on the steady clock, nanoseconds
  std::int64_t next_report_ = 0;
};

/// Throws Cancelled when a scope of this thread has been cancelled.
inline void check_cancelled() {
  if (cancel::current != nullptr) cancel::current->check();
}

/// A check for step i of a sequential loop, every check_every steps.
inline void check_cancelled_at(std::int64_t i) {
  if (i % check_every == 0) check_cancelled();
}

/// The same with a function besides, which is asked every time.
inline void check_cancelled(const std::function<bool()>& cancel) {
  if (cancel && cancel()) throw Cancelled();
  check_cancelled();
}

/// Says on the calling thread that a phase begins, or how much of it is done; a check as well.
inline void report_phase(std::string_view phase, double fraction = 0) {
  if (cancel::current == nullptr) return;
  cancel::current->check();
  cancel::current->report(phase, fraction);
}

/// Carries the scope of another thread to this one, for as long as it lives. With null nothing is asked meanwhile: for
/// short steps that must be done whole.
class CarriedScope {
 public:
  explicit CarriedScope(ControlScope* scope) : before_(std::exchange(cancel::current, scope)) {}
  CarriedScope(const CarriedScope&) = delete;
  CarriedScope& operator=(const CarriedScope&) = delete;
  ~CarriedScope() { cancel::current = before_; }

 private:
  ControlScope* before_;
};

}  // namespace alcap::detail
