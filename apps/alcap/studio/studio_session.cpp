// SPDX-License-Identifier: MIT
//
// studio_session.cpp: history and saving. Steps keep their results, so that going back is exact and costs nothing.
#include "apps/alcap/studio/studio_session.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <csignal>
#include <utility>

#include "alcap/errors.h"
#include "apps/alcap/report/outputs.h"

namespace alcap::app {

namespace {

// What a page can show and a person can draw; a solve of so many takes seconds.
constexpr std::size_t most_controls = 2000, most_points = 200'000;

void check_size(const DesignFile& design) {
  const std::size_t controls =
      design.singularities.size() + design.fixed.size() + design.strokes.size() + design.connection.cones.size();
  std::size_t points = 0;
  for (const DesignStroke& stroke : design.strokes) points += stroke.path.size() + stroke.vertices.size();
  if (controls > most_controls)
    throw OptionError("controls", controls, "the studio takes at most " + std::to_string(most_controls));
  if (points > most_points)
    throw OptionError("/strokes", points, "the studio takes at most " + std::to_string(most_points) + " points");
}

}  // namespace

DesignLock::DesignLock(const std::filesystem::path& file) {
  const std::filesystem::path full = std::filesystem::absolute(file);
  path_ = full.parent_path() / ("." + full.filename().string() + ".lock");
  do descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  while (descriptor_ < 0 && errno == EINTR);
  if (descriptor_ < 0) return;  // a folder that cannot be written to is somebody else's complaint
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  ::close(descriptor_);
  throw Failure(Exit::output,
                file.string() + ": another studio works on this design; use that one, or another --design FILE",
                {{"path", file.string()}});
}

DesignLock::~DesignLock() {
  if (descriptor_ < 0) return;
  ::unlink(path_.c_str());
  ::close(descriptor_);
}

StudioSession::StudioSession(const Surface& surface, DesignFile design, std::filesystem::path file)
    : surface_(surface), file_(std::move(file)), lock_(file_), solver_(surface) {
  check_design(design, surface.mesh());
  now_ = {.design = std::move(design), .result = nullptr};
  if (surface_.mesh().faces() < large) {
    start();
    if (failed_) std::rethrow_exception(failed_);
  } else {
    starter_ = std::thread([this] { start(); });
  }
}

StudioSession::~StudioSession() {
  if (starter_.joinable()) starter_.join();
}

namespace {

/// A design that has the directions of this one without a factorisation; none where it asks for more.
std::optional<DesignFile> quick_version(const DesignFile& design) {
  const bool plain = design.method == DesignMethod::variational && design.singularities.empty() &&
                     design.fixed.empty() && design.strokes.empty() && !design.boundary.wanted &&
                     !design.features.wanted && design.guidance.source == DesignGuidance::Source::smoothest &&
                     design.guidance.weights.empty();
  if (!plain) return std::nullopt;
  DesignFile quick = design;
  quick.guidance = {};
  return quick;
}

}  // namespace

void StudioSession::start() {
  const std::lock_guard change(changes_);
  try {
    const auto quick = quick_version(now_.design);
    const bool shown = quick && surface_.mesh().faces() >= large;
    if (shown) publish(solver_.solve(*quick));
    // Prepares the first edit. The field differs from the one that is shown by a factor alone: nobody is told.
    auto solved = solver_.solve(now_.design);
    if (!shown) publish(std::move(solved));
  } catch (const Error& e) {
    try {
      // A saved design may be unfinished, such as cones without the right sum: start with the field of an empty one.
      DesignFile empty;
      empty.n = now_.design.n;
      publish(solver_.solve(empty), e.what());
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failed_ = std::current_exception();
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failed_ = std::current_exception();
  }
  moved_.notify_all();
}

void StudioSession::publish(std::shared_ptr<const StudioResult> result, std::string problem) {
  const std::lock_guard lock(mutex_);
  now_.result = std::move(result);
  now_.problem = std::move(problem);
  ++revision_;
  moved_.notify_all();
}

StudioState StudioSession::state_locked() const {
  return {.revision = revision_,
          .design = now_.design,
          .result = result_locked(),
          .problem = now_.problem,
          .undo = past_.size(),
          .redo = future_.size()};
}

StudioState StudioSession::state() const {
  std::unique_lock lock(mutex_);
  moved_.wait(lock, [&] { return now_.result || failed_; });
  if (!now_.result) std::rethrow_exception(failed_);
  return state_locked();
}

std::uint64_t StudioSession::result() const {
  const std::lock_guard lock(mutex_);
  return result_locked() ? result_locked()->id : 0;
}

template <class Shift>
StudioState StudioSession::become(const Step& next, Shift&& shift) {
  try {
    write_guarded([&] { write_design(file_, next.design); });
  } catch (const Failure& e) {
    if (e.exit() == Exit::interrupted) ::kill(::getpid(), SIGINT);  // nobody else here ends the program
    throw;
  }
  const std::lock_guard lock(mutex_);
  shift();
  shown_.reset();
  ++revision_;
  moved_.notify_all();
  return state_locked();
}

StudioState StudioSession::edit(const std::string& text, const std::string& gesture,
                                std::optional<std::uint64_t> base) {
  DesignFile design = parse_design(text);
  // Nothing in a request may name a file.
  if (design.guidance.source == DesignGuidance::Source::file)
    throw OptionError("/guidance/field", design.guidance.file.string(), "the studio opens no files named by a page");
  check_size(design);
  // Features stay what they are: where they lie follows from their angle.
  const DesignFeatures features = std::exchange(design.features, {});
  design = place_design(design, surface_);
  design.features = features;

  const std::lock_guard change(changes_);
  Step next{.design = std::move(design), .result = nullptr};
  {
    const std::lock_guard lock(mutex_);
    if (base && *base != revision_) throw StudioConflict();
    next.result = now_.result;
  }
  try {
    next.result = solver_.solve(next.design);
  } catch (const OptionError& e) {
    next.problem = e.what();
  } catch (const SolveError& e) {
    next.problem = e.what();
  }
  return become(next, [&] {
    if (gesture.empty() || gesture != gesture_) {
      past_.push_back(std::move(now_));
      if (past_.size() > longest_history) past_.erase(past_.begin());
    }
    gesture_ = gesture;
    future_.clear();
    now_ = std::move(next);
  });
}

// Only changes move the history, and this is one.
StudioState StudioSession::undo() {
  const std::lock_guard change(changes_);
  if (past_.empty()) return state();
  return become(past_.back(), [&] {
    future_.push_back(std::move(now_));
    now_ = std::move(past_.back());
    past_.pop_back();
    gesture_.clear();
  });
}

StudioState StudioSession::redo() {
  const std::lock_guard change(changes_);
  if (future_.empty()) return state();
  return become(future_.back(), [&] {
    past_.push_back(std::move(now_));
    now_ = std::move(future_.back());
    future_.pop_back();
    gesture_.clear();
  });
}

StudioState StudioSession::show_mode(int k) {
  const std::lock_guard change(changes_);
  std::shared_ptr<const StudioResult> solved;
  double s = 0;
  {
    const std::lock_guard lock(mutex_);
    solved = now_.result;
    s = now_.design.s;
  }
  if (!solved) return state();
  std::shared_ptr<const StudioResult> mode;
  if (k != 0) mode = solver_.mode(*solved, s, k);
  const std::lock_guard lock(mutex_);
  shown_ = std::move(mode);
  gesture_.clear();
  ++revision_;
  moved_.notify_all();
  return state_locked();
}

std::uint64_t StudioSession::wait(std::uint64_t known, std::chrono::milliseconds limit) const {
  std::unique_lock lock(mutex_);
  moved_.wait_for(lock, limit, [&] { return revision_ != known; });
  return revision_;
}

}  // namespace alcap::app
