// SPDX-License-Identifier: MIT
//
// studio_session.h: the design that all tabs of a studio share: its history, its field, its file. Every call may come
// from any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "apps/alcap/studio/design_lock.h"
#include "apps/alcap/studio/studio_solver.h"

namespace alcap::app {

/// What a tab is told. `result` is the last one that could be solved.
struct StudioState {
  std::uint64_t revision = 0;
  DesignFile design;  ///< as it is saved: files are named relative to its folder
  std::shared_ptr<const StudioResult> result;
  std::string problem = {};  ///< why the design has no field yet; empty when it has
  std::size_t undo = 0, redo = 0;
};

/// An edit that is not based on the design of now.
class StudioConflict : public std::runtime_error {
 public:
  StudioConflict() : std::runtime_error("another tab changed the design") {}
};

class StudioSession {
 public:
  /// Solves `design`, on large surfaces only when the state is first asked for, and from a thread of its own: until
  /// then the machine is the page's, which is to show them soon. Who asks for the state waits. Points of space become
  /// faces and vertices, and edits of the design are done. Edits are saved to `file`, which appears complete or not at
  /// all, before they count. Throws what solving throws, and Failure(output) when another studio has the file.
  StudioSession(const Surface& surface, DesignFile design, std::filesystem::path file,
                const ControlTolerances& tolerances = {});
  ~StudioSession();
  StudioSession(const StudioSession&) = delete;
  StudioSession& operator=(const StudioSession&) = delete;

  /// Replaces the design by the one in the text (JSON). Edits with the same `gesture`, other than "", are one step of
  /// the history. Throws FileError and OptionError for designs that are not well-formed, too large or not of this
  /// surface; one that has no field, such as cones with the wrong sum, is taken, with `problem`. This and what follows
  /// throw StudioConflict when the revision is another than `base`, and Failure when the file cannot be written;
  /// nothing has changed then.
  StudioState edit(const std::string& text, const std::string& gesture, std::optional<std::uint64_t> base = {});
  /// One step back or forward; nothing happens at the end of the history. Results are those of before, bit for bit.
  StudioState undo(std::optional<std::uint64_t> base = {});
  StudioState redo(std::optional<std::uint64_t> base = {});
  /// Shows the k-th smoothest field instead of the design's, until the next change; 0: the design's again. The design,
  /// its file and its history stay as they are. Throws OptionError.
  StudioState show_mode(int k, std::optional<std::uint64_t> base = {});
  /// Saves the field that is shown beside the design, to a file that was not there, and makes it the guidance of the
  /// design. Throws as edit() does.
  StudioState keep_field(std::optional<std::uint64_t> base = {});
  /// Throws what the first solve threw.
  [[nodiscard]] StudioState state() const;
  /// Number of the present result; for asking often.
  [[nodiscard]] std::uint64_t result() const;
  /// Waits until the revision is another than `known`, or some seconds.
  [[nodiscard]] std::uint64_t wait(std::uint64_t known, std::chrono::milliseconds limit) const;
  [[nodiscard]] const Surface& surface() const { return surface_; }
  /// What became of parts of the design that it was started with, in sentences.
  [[nodiscard]] const std::vector<std::string>& came() const { return came_; }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  struct Step {
    DesignFile design;
    std::shared_ptr<const StudioResult> result;
    std::string problem = {};
  };
  static constexpr Index large = 200'000;              // faces: found in the background, when asked for
  static constexpr std::size_t longest_history = 200;  // steps; a field of 25,000 vertices is 0.5 MB

  void start();
  void check_base(std::optional<std::uint64_t> base) const;
  void check_base_locked(std::optional<std::uint64_t> base) const;
  /// The files that a design may name: nothing in a request may name another one.
  void check_files(const DesignFile& design) const;
  [[nodiscard]] DesignFile placed(const DesignFile& design) const;
  [[nodiscard]] DesignFile as_saved(DesignFile design) const;
  void publish(std::shared_ptr<const StudioResult> result, std::string problem = {});
  [[nodiscard]] StudioState state_locked() const;
  [[nodiscard]] const std::shared_ptr<const StudioResult>& result_locked() const {
    return shown_ ? shown_ : now_.result;
  }
  /// Saves the step, and only then makes it the present one; `shift` changes the history.
  template <class Shift>
  StudioState become(const Step& next, Shift&& shift);

  Surface surface_;
  std::filesystem::path file_;
  std::filesystem::path folder_;  // of the file
  std::vector<std::string> came_;
  DesignLock lock_;
  StudioSolver solver_;
  std::mutex changes_;        // one change at a time, solving and saving included; taken before mutex_
  mutable std::mutex mutex_;  // what is below; never held while anything is solved or written
  mutable std::condition_variable moved_;
  Step now_;
  std::shared_ptr<const StudioResult> shown_;  // a mode; null: the result of now_
  std::vector<Step> past_, future_;
  std::string gesture_;
  std::uint64_t revision_ = 0;              // counts from 1, the first result
  std::exception_ptr failed_;               // of the first solve
  std::set<std::filesystem::path> guides_;  // files that a design may name: those it came with, and fields saved here
  mutable bool wanted_ = false;             // somebody has asked for the state
  bool ended_ = false;
  std::thread starter_;
};

}  // namespace alcap::app
