// SPDX-License-Identifier: MIT
#include "src/base/cancel.h"

#include <chrono>
#include <limits>

#include "src/base/parallel.h"

namespace alcap {
namespace detail {
namespace {

// A tenth of the time in which a call has to end; a slow function that is asked this often costs little still.
constexpr std::int64_t ask_every = 10'000'000;  // nanoseconds

std::int64_t now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

/// At the end of the block, however that is reached: the next question is due at `time`.
class GiveBack {
 public:
  GiveBack(std::atomic<std::int64_t>& next_ask, std::int64_t time) : next_ask_(next_ask), time_(time) {}
  GiveBack(const GiveBack&) = delete;
  GiveBack& operator=(const GiveBack&) = delete;
  ~GiveBack() { next_ask_.store(time_, std::memory_order_release); }

 private:
  std::atomic<std::int64_t>& next_ask_;
  std::int64_t time_;
};

}  // namespace

ControlScope::ControlScope(const std::function<bool()>& cancel,
                           const std::function<void(std::string_view, double)>* progress)
    : cancel_(cancel ? &cancel : nullptr),
      progress_(progress != nullptr && *progress ? progress : nullptr),
      outer_(cancel::current) {
  if (cancel_ == nullptr && progress_ == nullptr) return;  // nothing to ask, nobody to tell: loops need not know
  check();
  cancel::current = this;  // last: a constructor that throws leaves no scope behind
}

void ControlScope::check() {
  for (ControlScope* scope = this; scope != nullptr; scope = scope->outer_) {
    if (scope->cancel_ == nullptr) continue;
    if (scope->cancelled_.load(std::memory_order_relaxed)) throw Cancelled();
    const std::int64_t time = now();
    std::int64_t due = scope->next_ask_.load(std::memory_order_relaxed);
    // Whoever takes the time of the next question asks, and gives it back afterwards; the others go on. So one thread
    // asks at a time, each sees what the last one wrote, and cancel() needs no lock of its own.
    if (time < due || !scope->next_ask_.compare_exchange_strong(due, never, std::memory_order_acquire)) continue;
    const GiveBack give_back(scope->next_ask_, time + ask_every);
    if (!(*scope->cancel_)()) continue;
    scope->cancelled_.store(true, std::memory_order_relaxed);
    throw Cancelled();
  }
}

bool ControlScope::cancelled() const {
  for (const ControlScope* scope = this; scope != nullptr; scope = scope->outer_) {
    if (scope->cancelled_.load(std::memory_order_relaxed)) return true;
  }
  return false;
}

void ControlScope::report(std::string_view phase, double fraction) {
  for (ControlScope* scope = this; scope != nullptr; scope = scope->outer_) {
    if (scope->progress_ == nullptr) continue;
    const std::int64_t time = now();
    if (fraction > 0 && time < scope->next_report_) return;
    scope->next_report_ = time + ask_every;
    (*scope->progress_)(phase, fraction);
    return;
  }
}

void run_controlled(const RunControl& control, const std::function<void()>& body) {
  if (control.threads < 0 || control.threads > most_threads) {
    throw OptionError("threads", control.threads, "must be 0 (all of the machine) or 1 to 4096");
  }
  const ControlScope scope(control);
  run_with_threads(control.threads, body);
}

}  // namespace detail
}  // namespace alcap
