// SPDX-License-Identifier: MIT
//
// studio_session.cpp: history and saving. Steps keep their results, so that going back is exact and costs nothing.
#include "apps/alcap/studio/studio_session.h"

#include "alcap/errors.h"
#include "apps/alcap/report/outputs.h"

namespace alcap::app {

StudioSession::StudioSession(const Surface& surface, DesignFile design, std::filesystem::path file)
    : surface_(surface), file_(std::move(file)), solver_(surface) {
  check_design(design, surface.mesh());
  now_ = {.design = std::move(design), .result = nullptr};
  try {
    now_.result = solver_.solve(now_.design);
  } catch (const Error& e) {
    // A saved design may be unfinished, such as cones without the right sum: start with the field of an empty one.
    now_.problem = e.what();
    DesignFile empty;
    empty.n = now_.design.n;
    now_.result = solver_.solve(empty);
  }
}

StudioState StudioSession::state_locked() const {
  return {.revision = revision_,
          .design = now_.design,
          .result = now_.result,
          .problem = now_.problem,
          .undo = past_.size(),
          .redo = future_.size()};
}

StudioState StudioSession::state() const {
  const std::lock_guard lock(mutex_);
  return state_locked();
}

void StudioSession::changed() {
  ++revision_;
  moved_.notify_all();
  write_design(file_, now_.design);
}

StudioState StudioSession::edit(const std::string& text, const std::string& gesture) {
  DesignFile design = parse_design(text);
  // Nothing in a request may name a file.
  if (design.guidance.source == DesignGuidance::Source::file)
    throw OptionError("/guidance/field", design.guidance.file.string(), "the studio opens no files named by a page");
  design = place_design(design, surface_);

  const std::lock_guard lock(mutex_);
  Step next{.design = std::move(design), .result = now_.result};
  try {
    next.result = solver_.solve(next.design);
  } catch (const OptionError& e) {
    next.problem = e.what();
  } catch (const SolveError& e) {
    next.problem = e.what();
  }
  if (gesture.empty() || gesture != gesture_) {
    past_.push_back(std::move(now_));
    if (past_.size() > longest_history) past_.erase(past_.begin());
  }
  gesture_ = gesture;
  future_.clear();
  now_ = std::move(next);
  changed();
  return state_locked();
}

StudioState StudioSession::undo() {
  const std::lock_guard lock(mutex_);
  if (!past_.empty()) {
    future_.push_back(std::move(now_));
    now_ = std::move(past_.back());
    past_.pop_back();
    gesture_.clear();
    changed();
  }
  return state_locked();
}

StudioState StudioSession::redo() {
  const std::lock_guard lock(mutex_);
  if (!future_.empty()) {
    past_.push_back(std::move(now_));
    now_ = std::move(future_.back());
    future_.pop_back();
    gesture_.clear();
    changed();
  }
  return state_locked();
}

std::uint64_t StudioSession::wait(std::uint64_t known, std::chrono::milliseconds limit) const {
  std::unique_lock lock(mutex_);
  moved_.wait_for(lock, limit, [&] { return revision_ != known; });
  return revision_;
}

}  // namespace alcap::app
