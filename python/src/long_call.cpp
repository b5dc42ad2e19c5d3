// SPDX-License-Identifier: MIT
#include "python/src/long_call.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <thread>

#include "alcap/control.h"

namespace alcap::python {
namespace {

/// A tenth of the time in which a call has to end.
constexpr std::chrono::milliseconds look_every{10};

/// What the two threads say to each other.
class Conversation {
 public:
  /// On the working thread: hands a phase over and waits until it was told.
  void tell(std::string_view phase, double fraction) {
    std::unique_lock lock(mutex_);
    phase_ = phase;
    fraction_ = fraction;
    told_ = true;
    changed_.notify_all();
    changed_.wait(lock, [&] { return !told_; });
  }
  void finish() {
    const std::lock_guard lock(mutex_);
    done_ = true;
    changed_.notify_all();
  }
  [[nodiscard]] bool stopped() const { return stop_; }

  /// On the calling thread, without the interpreter's lock, until finish(). Returns what Python raised.
  std::exception_ptr wait(const py::object& progress) {
    std::exception_ptr raised;
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait_for(lock, look_every, [&] { return done_ || told_; });
      if (done_) return raised;
      const bool told = told_;
      lock.unlock();
      if (!raised) {
        const py::gil_scoped_acquire held;
        try {
          if (PyErr_CheckSignals() != 0) throw py::error_already_set();
          if (told) progress(py::str(phase_), fraction_);
        } catch (...) {
          raised = std::current_exception();
          stop_ = true;
        }
      }
      lock.lock();
      if (told) {
        told_ = false;
        changed_.notify_all();
      }
    }
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string phase_;
  double fraction_ = 0;
  bool told_ = false, done_ = false;
  std::atomic<bool> stop_{false};
};

}  // namespace

void long_call(const py::object& progress, int threads, const std::function<void()>& body) {
  Conversation talk;
  RunControl control{.cancel = [&] { return talk.stopped(); }, .threads = threads};
  if (!progress.is_none())
    control.progress = [&](std::string_view phase, double fraction) { talk.tell(phase, fraction); };
  std::exception_ptr failed, raised;
  std::thread worker([&] {
    try {
      controlled(control, body);
    } catch (...) {
      failed = std::current_exception();
    }
    talk.finish();
  });
  {
    const py::gil_scoped_release released;
    raised = talk.wait(progress);
    worker.join();
  }
  if (raised) std::rethrow_exception(raised);
  if (failed) std::rethrow_exception(failed);
}

}  // namespace alcap::python
