// SPDX-License-Identifier: MIT
//
// atomic_file.h: an output file that appears complete or not at all.
//
// Bytes go to a temporary name in the folder of the target; commit() renames it over the target, the destructor removes
// it when commit() was not reached (an exception). There is no fsync: this guards against failing writers, not against
// power cuts. A target that exists and is no regular file (a pipe, /dev/stdout) is written directly; a symbolic link is
// followed. Every failure is a FileError with the target's path.
//
//   alcap::detail::AtomicFile file("out/mesh.off");
//   file.write("OFF\n");
//   file.commit();
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace alcap::detail {

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

  /// Writes what is left and closes; nothing but commit() may follow. Errors of a full disk are known after it.
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
  void discard() noexcept;
  [[noreturn]] void fail(const std::string& what, int error);

  std::filesystem::path target_;     // as given, for messages
  std::filesystem::path final_;      // symbolic links followed
  std::filesystem::path temporary_;  // empty when the target is written directly
  std::string buffer_;
  std::int64_t flushed_ = 0;
  int descriptor_ = -1;
  bool complete_ = false;
};

}  // namespace alcap::detail
