// SPDX-License-Identifier: MIT
//
// passing_file.h: files that are there only while the program runs.
#pragma once

#include <array>
#include <atomic>
#include <filesystem>

namespace alcap::app {

/// A file that this process has made. It goes with this object, and before a signal ends the program once
/// remove_passing_files_at_signals() has been called. Calls may come from any thread.
class PassingFile {
 public:
  PassingFile() = default;
  PassingFile(const PassingFile&) = delete;
  PassingFile& operator=(const PassingFile&) = delete;
  ~PassingFile() { remove(); }
  /// Call it once. False where there are too many such files or the name is too long; the file stays then.
  [[nodiscard]] bool hold(const std::filesystem::path& file);
  /// Removes it now; nothing happens where it is gone.
  void remove();

 private:
  struct Place;
  static std::array<Place, 4> places;
  std::atomic<Place*> place_{nullptr};
  friend void remove_passing_files_at_signals();
};

/// From now on SIGINT, SIGTERM, SIGHUP and SIGQUIT remove all such files before they end the program, as they would
/// have; those that are ignored (nohup) stay so.
void remove_passing_files_at_signals();

}  // namespace alcap::app
