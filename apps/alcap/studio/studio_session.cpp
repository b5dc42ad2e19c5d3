// SPDX-License-Identifier: MIT
//
// studio_session.cpp: history and saving. Steps keep their results, so that going back is exact and costs nothing.
#include "apps/alcap/studio/studio_session.h"

#include <unistd.h>

#include <algorithm>
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

/// What is said of a design that comes from elsewhere.
std::vector<std::string> sentences(const DesignFile& design) {
  std::vector<std::string> out;
  const std::size_t edits = design.edits.size();
  if (edits > 0)
    out.push_back("The file came with " + std::to_string(edits) + (edits == 1 ? " edit" : " edits") +
                  " of its singularities. What they lead to is below, and will be saved instead.");
  const auto at = [](const auto& list) {
    return std::any_of(list.begin(), list.end(), [](const auto& one) { return one.at.has_value(); });
  };
  bool points = at(design.singularities) || at(design.fixed) || !design.connection.cones_at.empty();
  for (const DesignStroke& s : design.strokes) points = points || !s.path.empty() || at(s.points);
  if (points)
    out.push_back(
        "The file names points of space. They are faces and vertices of this surface from now on, and will be saved "
        "as such.");
  return out;
}

}  // namespace

StudioSession::StudioSession(const Surface& surface, DesignFile design, std::filesystem::path file,
                             const ControlTolerances& tolerances)
    : surface_(surface),
      file_(std::move(file)),
      folder_(std::filesystem::absolute(file_).parent_path()),
      came_(sentences(design)),
      lock_(file_),
      solver_(surface, tolerances) {
  if (design.guidance.source == DesignGuidance::Source::file) {
    design.guidance.file = std::filesystem::absolute(design.guidance.file).lexically_normal();
    guides_.insert(design.guidance.file);
  }
  if (std::filesystem::path& edges = design.features.file; !edges.empty()) {
    edges = std::filesystem::absolute(edges).lexically_normal();
    guides_.insert(edges);
  }
  now_ = {.design = placed(design), .result = nullptr};
  if (surface_.mesh().faces() < large) {
    start();
    if (failed_) std::rethrow_exception(failed_);
    return;
  }
  starter_ = std::thread([this] {
    {
      std::unique_lock lock(mutex_);
      moved_.wait(lock, [&] { return wanted_ || ended_; });
      if (ended_) return;
    }
    start();
  });
}

StudioSession::~StudioSession() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  moved_.notify_all();
  if (starter_.joinable()) starter_.join();
}

DesignFile StudioSession::placed(const DesignFile& design) const {
  // Features stay what they are: where they lie follows from their angle.
  DesignFile part = design;
  part.features = {};
  DesignFile out = place_design(part, surface_);
  out.features = design.features;
  return out;
}

DesignFile StudioSession::as_saved(DesignFile design) const {
  for (std::filesystem::path* named : {&design.guidance.file, &design.features.file}) {
    if (named->empty()) continue;
    const std::filesystem::path near = named->lexically_relative(folder_);
    if (!near.empty() && *near.begin() != "..") *named = near;
  }
  return design;
}

void StudioSession::check_files(const DesignFile& design) const {
  const std::lock_guard lock(mutex_);
  const auto check = [&](const char* path, const std::filesystem::path& file) {
    if (!file.empty() && !guides_.contains(file))
      throw OptionError(path, file.filename().string(),
                        "the studio opens no files named by a page, but that of the design it was started with");
  };
  check("/guidance/file", design.guidance.file);
  check("/features/file", design.features.file);
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
          .design = as_saved(now_.design),
          .result = result_locked(),
          .problem = now_.problem,
          .undo = past_.size(),
          .redo = future_.size()};
}

StudioState StudioSession::state() const {
  std::unique_lock lock(mutex_);
  wanted_ = true;
  moved_.notify_all();
  moved_.wait(lock, [&] { return now_.result || failed_; });
  if (!now_.result) std::rethrow_exception(failed_);
  return state_locked();
}

std::uint64_t StudioSession::result() const {
  const std::lock_guard lock(mutex_);
  return result_locked() ? result_locked()->id : 0;
}

namespace {

void save(const std::function<void()>& write) {
  try {
    write_guarded(write);
  } catch (const Failure& e) {
    if (e.exit() == Exit::interrupted) ::kill(::getpid(), SIGINT);  // nobody else here ends the program
    throw;
  }
}

}  // namespace

template <class Shift>
StudioState StudioSession::become(const Step& next, Shift&& shift) {
  save([&] { write_design(file_, as_saved(next.design)); });
  const std::lock_guard lock(mutex_);
  shift();
  shown_.reset();
  ++revision_;
  moved_.notify_all();
  return state_locked();
}

StudioState StudioSession::edit(const std::string& text, const std::string& gesture,
                                std::optional<std::uint64_t> base) {
  DesignFile design = parse_design(text, "design", folder_);
  design.guidance.file = design.guidance.file.lexically_normal();
  check_files(design);
  check_size(design);
  design = placed(design);

  (void)state();  // the first field comes first
  const std::lock_guard change(changes_);
  Step next{.design = std::move(design), .result = nullptr};
  {
    const std::lock_guard lock(mutex_);
    check_base_locked(base);
    next.result = now_.result;
  }
  try {
    next.result = solver_.solve(next.design);
  } catch (const OptionError& e) {
    next.problem = e.what();
  } catch (const SolveError& e) {
    next.problem = e.what();
  } catch (const FileError& e) {
    next.problem = e.what();  // a guidance field that is gone, or of another n
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

void StudioSession::check_base_locked(std::optional<std::uint64_t> base) const {
  if (base && *base != revision_) throw StudioConflict();
}

void StudioSession::check_base(std::optional<std::uint64_t> base) const {
  const std::lock_guard lock(mutex_);
  check_base_locked(base);
}

// Only changes move the history, and this is one.
StudioState StudioSession::undo(std::optional<std::uint64_t> base) {
  (void)state();
  const std::lock_guard change(changes_);
  check_base(base);
  if (past_.empty()) return state();
  return become(past_.back(), [&] {
    future_.push_back(std::move(now_));
    now_ = std::move(past_.back());
    past_.pop_back();
    gesture_.clear();
  });
}

StudioState StudioSession::redo(std::optional<std::uint64_t> base) {
  (void)state();
  const std::lock_guard change(changes_);
  check_base(base);
  if (future_.empty()) return state();
  return become(future_.back(), [&] {
    past_.push_back(std::move(now_));
    now_ = std::move(future_.back());
    future_.pop_back();
    gesture_.clear();
  });
}

StudioState StudioSession::show_mode(int k, std::optional<std::uint64_t> base) {
  (void)state();
  const std::lock_guard change(changes_);
  std::shared_ptr<const StudioResult> solved;
  double s = 0;
  {
    const std::lock_guard lock(mutex_);
    check_base_locked(base);
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

StudioState StudioSession::keep_field(std::optional<std::uint64_t> base) {
  StudioState now = state();
  if (base && *base != now.revision) throw StudioConflict();
  if (now.result->field.n != now.design.n)
    throw OptionError("/n", now.design.n, "the field that is shown has another n; the design has none yet");
  std::string stem = file_.stem().string();
  if (stem.ends_with(".design")) stem.resize(stem.size() - std::string_view(".design").size());
  std::filesystem::path field;
  std::error_code error;
  for (int k = 1; field.empty() || std::filesystem::exists(field, error); ++k)
    field = folder_ / (stem + ".guidance-" + std::to_string(k) + ".ply");
  save([&] { write_field(now.result->output(), field); });
  {
    const std::lock_guard lock(mutex_);
    guides_.insert(field);
  }
  now.design.method = DesignMethod::variational;
  now.design.guidance.source = DesignGuidance::Source::file;
  now.design.guidance.file = field;
  return edit(design_text(as_saved(std::move(now.design))), "", now.revision);
}

std::uint64_t StudioSession::wait(std::uint64_t known, std::chrono::milliseconds limit) const {
  std::unique_lock lock(mutex_);
  moved_.wait_for(lock, limit, [&] { return revision_ != known; });
  return revision_;
}

}  // namespace alcap::app
