// SPDX-License-Identifier: MIT
//
// progress.cpp: a line that is redrawn when the phase changes and five times a second.
#include "apps/alcap/report/progress.h"

#include <fmt/core.h>

#include <cstdio>

#include "apps/alcap/report/printable.h"
#include "apps/alcap/system/system.h"

namespace alcap::app {

Progress::Progress(bool wanted) : on_(wanted && stderr_is_terminal()) {
  if (on_) ticker_ = std::thread([this] { tick(); });
}

Progress::~Progress() {
  if (!on_) return;
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  ticker_.join();
  clear();
}

void Progress::phase(const std::string& what) {
  if (!on_) return;
  const std::lock_guard lock(mutex_);
  what_ = printable_line(what);
  draw();
}

void Progress::clear() {
  if (!on_) return;
  const std::lock_guard lock(mutex_);
  if (drawn_) (void)std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
  what_.clear();
}

void Progress::tick() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, std::chrono::milliseconds(200), [this] { return stop_; })) draw();
}

void Progress::draw() {
  if (what_.empty()) return;
  const double seconds = watch_.seconds();
  // The terminal may be gone by now: nothing may be thrown here.
  (void)std::fputs(fmt::format("\r\033[K{:6.1f} s  {} ...", seconds, what_).c_str(), stderr);
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace alcap::app
