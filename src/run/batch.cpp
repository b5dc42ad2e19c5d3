// SPDX-License-Identifier: MIT
#include "alcap/batch.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "src/base/cancel.h"
#include "src/base/parallel.h"

namespace alcap {
namespace {

/// What the workers of a batch share.
class Batch {
 public:
  Batch(std::int64_t count, const FieldRunOptions& options, const std::function<void(Context&, std::int64_t)>& work,
        const std::function<void(std::int64_t, const std::exception&)>& failed)
      : count_(count), options_(options), work_(work), failed_(failed) {}

  /// Takes one mesh after the other, until none is left or the batch has ended.
  void worker() {
    Context context(options_);
    try {
      for (std::int64_t i = next_++; i < count_ && !stop_; i = next_++) {
        detail::check_cancelled();
        one(context, i);
        report(++done_);
      }
    } catch (...) {
      stop_ = true;
      throw;
    }
  }

 private:
  void one(Context& context, std::int64_t i) {
    try {
      // A thread that waits inside a mesh must not start another one: each has its own arena of one thread.
      run_with_threads(1, [&] { work_(context, i); });
    } catch (const Cancelled& error) {
      if (scope_ != nullptr && scope_->cancelled()) throw;  // the batch, not this mesh alone
      tell(i, error);
    } catch (const std::exception& error) {
      tell(i, error);
    }
  }

  void tell(std::int64_t i, const std::exception& error) {
    const std::lock_guard lock(telling_);
    failed_(i, error);
  }

  // Progress is told on the thread of the caller, which is one of the workers.
  void report(std::int64_t done) const {
    if (std::this_thread::get_id() != caller_) return;
    detail::report_phase("batch", static_cast<double>(done) / static_cast<double>(count_));
  }

  std::int64_t count_;
  const FieldRunOptions& options_;
  const std::function<void(Context&, std::int64_t)>& work_;
  const std::function<void(std::int64_t, const std::exception&)>& failed_;
  std::atomic<std::int64_t> next_{0}, done_{0};
  std::atomic<bool> stop_{false};
  std::mutex telling_;
  const detail::ControlScope* const scope_ = detail::cancel::current;
  const std::thread::id caller_ = std::this_thread::get_id();
};

}  // namespace

Context::Context(FieldRunOptions options) : options_(std::move(options)) {
  options_.threads = 1;
  options_.progress = {};
  options_.control.threads = 0;
  options_.control.progress = [](std::string_view, double) {};  // also not that of a call around it
}

const FieldRun& Context::run(const Surface& surface) {
  run_ = {};  // one result at a time: its memory is taken up again by the next
  run_ = run_field(surface, options_);
  return run_;
}

const FieldRun& Context::run(Positions<double>&& V, Faces&& F) {
  run_ = {};
  run_ = run_field(std::move(V), std::move(F), options_);
  return run_;
}

void run_batch(std::int64_t count, const BatchOptions& options,
               const std::function<void(Context& context, std::int64_t i)>& work,
               const std::function<void(std::int64_t i, const std::exception& error)>& failed) {
  if (count < 0) throw OptionError("count", count, "must not be negative");
  if (options.jobs < 0 || options.jobs > 4096)
    throw OptionError("jobs", options.jobs, "must be 0 (all threads of the machine) or 1 to 4096");
  RunControl control = options.control;
  if (options.jobs > 0) control.threads = options.jobs;
  detail::run_controlled(control, [&] {
    detail::report_phase("batch");
    // More workers than threads do no harm: those that come late find nothing left to do.
    const std::int64_t threads =
        control.threads > 0 ? control.threads : std::max(1U, std::thread::hardware_concurrency());
    Batch batch(count, options.field, work, failed);
    parallel_for(
        std::min(count, threads), [&](std::int64_t) { batch.worker(); }, 1);
  });
}

}  // namespace alcap
