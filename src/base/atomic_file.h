// SPDX-License-Identifier: MIT
//
// atomic_file.h: an output file that appears complete or not at all.
//
// Bytes go to a hidden temporary name in the folder of the target, made up at random and created by nobody else;
// complete() waits until they are on the disk (fsync), commit() renames it over the target, the destructor removes it
// when commit() was not reached (an exception). So the target is complete or what it was before, also after a power
// cut. A process that is killed leaves its temporary name: find_leftovers() recognises it, nobody deletes it.
//
// A target that exists and is no regular file (a pipe, /dev/stdout) is written directly; a symbolic link is followed
// to the file it names, and refused where there is none. Every failure is a FileError with the target's path.
//
//   alcap::detail::AtomicFile file("out/mesh.off");
//   file.write("OFF\n");
//   file.commit();
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace alcap::detail {

/// A name beside `target` for what is not complete yet: hidden, with the target's name, and random. Whoever creates it
/// must insist on being the first (O_EXCL, mkdir) and ask again otherwise, and hold an flock on it as long as it
/// writes.
[[nodiscard]] std::filesystem::path temporary_name(const std::filesystem::path& target);

/// What runs that died have left beside `target`: temporary names that no living process holds. Best effort: a folder
/// that cannot be listed has none.
[[nodiscard]] std::vector<std::filesystem::path> find_leftovers(const std::filesystem::path& target);

/// Makes sure that names created, renamed or removed in a folder survive a power cut, where the system can.
void sync_folder(const std::filesystem::path& folder) noexcept;

/// Where a chain of symbolic links ends, whether anything is there or not; `path` itself when it is none. Nothing for
/// links that form a circle.
[[nodiscard]] std::filesystem::path follow_links(const std::filesystem::path& path);

/// What is wrong with an output that is a link to `end`, where nothing is. Most likely the link is out of date; a file
/// somewhere else than its name says would be found by nobody.
[[nodiscard]] std::string leads_nowhere(const std::filesystem::path& end);

class AtomicFile {
 public:
  /// Opens the temporary file. The folder must exist.
  explicit AtomicFile(std::filesystem::path target);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  /// Appends bytes (buffered unless there are many). Throws Cancelled in a cancelled call (cancel.h).
  void write(std::string_view bytes) {
    if (bytes.size() >= buffer_bytes / 16) {
      flush();
      flush(bytes);
      return;
    }
    buffer_.append(bytes);
    if (buffer_.size() >= buffer_bytes) flush();
  }

  /// Writes what is left to the disk; nothing but commit() may follow. Errors of a full disk are known after it.
  void complete();

  /// complete(), unless that has been called, and renames. Call it once, last.
  void commit();

  /// The target as it was given.
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }

  /// Bytes accepted so far.
  [[nodiscard]] std::int64_t size() const { return flushed_ + static_cast<std::int64_t>(buffer_.size()); }

 private:
  static constexpr std::size_t buffer_bytes = std::size_t{1} << 20;  // large enough that the calls cost nothing

  void flush();
  void flush(std::string_view bytes);
  void create();
  void discard() noexcept;
  [[noreturn]] void fail(const std::string& what, int error);

  std::filesystem::path target_;     // as given, for messages
  std::filesystem::path final_;      // symbolic links followed
  std::filesystem::path temporary_;  // empty when the target is written directly
  std::string buffer_;
  std::int64_t flushed_ = 0;
#ifdef ALCAP_PORTABLE
  std::FILE* stream_ = nullptr;
#else
  int descriptor_ = -1;
#endif
  bool complete_ = false;
};

}  // namespace alcap::detail
