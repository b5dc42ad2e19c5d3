// SPDX-License-Identifier: MIT
//
// progress.h: one line on a terminal's stderr that says what is going on and for how long. Silent when stderr is no
// terminal, so that logs and pipes stay clean.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "src/base/clock.h"

namespace alcap::app {

class Progress {
 public:
  explicit Progress(bool wanted);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();

  /// Replaces the line, e.g. phase("solving"). The seconds beside it tick on their own.
  void phase(const std::string& what);
  /// Wipes the line: call before writing anything else to the terminal.
  void clear();

 private:
  void tick();
  void draw();

  bool on_;
  bool stop_ = false;
  bool drawn_ = false;
  std::string what_;
  detail::Stopwatch watch_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::thread ticker_;
};

}  // namespace alcap::app
