// SPDX-License-Identifier: MIT
#include "alcap/batch.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "src/base/parallel.h"

namespace alcap {

Context::Context(FieldRunOptions options) : options_(std::move(options)) {
  options_.threads = 1;
  options_.progress = {};
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
  if (count < 0) throw OptionError("count", std::to_string(count), "must not be negative");
  if (options.jobs < 0 || options.jobs > 4096)
    throw OptionError("jobs", std::to_string(options.jobs), "must be 0 (all threads of the machine) or 1 to 4096");
  std::atomic<std::int64_t> next{0};
  std::atomic<bool> stop{false};
  std::mutex telling;
  const auto worker = [&] {
    Context context(options.field);
    for (std::int64_t i = next++; i < count && !stop; i = next++) {
      try {
        // A thread that waits inside a mesh must not start another one: each has its own arena of one thread.
        run_with_threads(1, [&] { work(context, i); });
      } catch (const std::exception& error) {
        const std::lock_guard lock(telling);
        try {
          failed(i, error);
        } catch (...) {
          stop = true;
          throw;
        }
      } catch (...) {
        stop = true;
        throw;
      }
    }
  };
  run_with_threads(options.jobs, [&] {
    // More workers than threads do no harm: those that come late find nothing left to do.
    const std::int64_t threads = options.jobs > 0 ? options.jobs : std::max(1U, std::thread::hardware_concurrency());
    parallel_for(
        std::min(count, threads), [&](std::int64_t) { worker(); }, 1);
  });
}

}  // namespace alcap
