// SPDX-License-Identifier: MIT
#include "python/src/long_call.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#ifndef _WIN32
#include <unistd.h>
#endif

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

/// A thread that waits for work. Each calling thread keeps one: to start a thread for every call costs little where
/// cores are free, and several milliseconds where they are not, because the system lets new threads wait their turn.
class Helper {
 public:
  Helper() : thread_([this] { run(); }) {}
  Helper(const Helper&) = delete;
  Helper& operator=(const Helper&) = delete;
  ~Helper() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    changed_.notify_one();
    thread_.join();
  }
  void start(std::function<void()> work) {
    {
      const std::lock_guard lock(mutex_);
      work_ = std::move(work);
    }
    changed_.notify_one();
  }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [&] { return ended_ || work_; });
      if (!work_) return;
      const std::function<void()> work = std::exchange(work_, nullptr);
      lock.unlock();
      work();
      lock.lock();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void()> work_;
  bool ended_ = false;
  std::thread thread_;  // last: it uses the others
};

/// The helper of this thread, taken for a call and given back. A call within a call (from `progress`) gets another one.
/// After a fork the child's threads are gone, and so is what it inherited: that helper is left alone.
class Borrowed {
 public:
  Borrowed() : helper_(std::move(kept().helper)) {
    if (helper_ && kept().process != this_process()) static_cast<void>(helper_.release());
    if (!helper_) helper_ = std::make_unique<Helper>();
  }
  Borrowed(const Borrowed&) = delete;
  Borrowed& operator=(const Borrowed&) = delete;
  ~Borrowed() {
    if (kept().helper) return;
    kept().helper = std::move(helper_);
    kept().process = this_process();
  }
  Helper* operator->() const { return helper_.get(); }

 private:
  struct Kept {
    std::unique_ptr<Helper> helper;
    long process = 0;
    ~Kept() {
      if (helper && process != this_process()) static_cast<void>(helper.release());
    }
  };
  static Kept& kept() {
    thread_local Kept mine;
    return mine;
  }
  static long this_process() {
#ifdef _WIN32
    return 0;  // no fork
#else
    return static_cast<long>(::getpid());
#endif
  }

  std::unique_ptr<Helper> helper_;
};

}  // namespace

void long_call(const py::object& progress, int threads, const std::function<void()>& body) {
  Conversation talk;
  RunControl control{.cancel = [&] { return talk.stopped(); }, .threads = threads};
  if (!progress.is_none())
    control.progress = [&](std::string_view phase, double fraction) { talk.tell(phase, fraction); };
  std::exception_ptr failed, raised;
  {
    const py::gil_scoped_release released;
    const Borrowed helper;
    helper->start([&] {
      try {
        controlled(control, body);
      } catch (...) {
        failed = std::current_exception();
      }
      talk.finish();  // the last thing that touches this call's variables
    });
    raised = talk.wait(progress);
  }
  if (raised) std::rethrow_exception(raised);
  if (failed) std::rethrow_exception(failed);
}

}  // namespace alcap::python
