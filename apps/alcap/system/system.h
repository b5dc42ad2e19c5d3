// SPDX-License-Identifier: MIT
//
// system.h: what the tool asks of the operating system beyond C++. posix.cpp does it, portable.cpp (ALCAP_PORTABLE)
// does without. The studio, which serves a page, has calls of its own and is left out of portable builds.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace alcap::app {

/// Whether a person may be watching standard error. Portable: no.
[[nodiscard]] bool stderr_is_terminal();

/// Gives the standard streams that are closed a place that refuses everything: files that are opened later would take
/// their numbers, and messages would end up in them. Portable: nothing.
void reserve_standard_streams();

/// The jobs of a batch share the cores among them. OpenBLAS, where it is what CHOLMOD calls, would start threads of its
/// own in each, which for small meshes takes most of the time (measured: 24 meshes a second, and 67 without). The
/// library leaves such settings alone; a program of its own may choose. Portable: nothing.
void one_thread_for_blas();

/// Whether new files may be put into the folder, as far as permissions tell. Portable: yes.
[[nodiscard]] bool may_write_into(const std::filesystem::path& folder);

/// The limit of the address space of this process in bytes, or 0 where there is none or nobody tells; and what it takes
/// up of that.
struct AddressSpace {
  std::int64_t limit = 0, used = 0;
};
[[nodiscard]] AddressSpace address_space();

/// Makes OpenBLAS, where it is loaded, take its buffer now. Portable: nothing.
void take_blas_buffer();

/// While it lives, the signals that end programs are only noted. Those that are ignored already (nohup) stay so; those
/// about the writing itself (a closed pipe, the largest size of a file) become errors of it. Portable: nothing.
class HeldSignals {
 public:
  HeldSignals();
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;
  ~HeldSignals();
  /// Whether one has come since the program began.
  [[nodiscard]] static bool stop_requested();

 private:
  struct Before;
  std::unique_ptr<Before> before_;
};

/// A folder that was made and, where the system can, says by a lock that its writer lives.
class NewFolder {
 public:
  NewFolder() = default;
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;
  ~NewFolder();
  /// Makes it: false where something has this name already. Throws std::system_error for other reasons.
  [[nodiscard]] bool make(const std::filesystem::path& path);

 private:
  int descriptor_ = -1;
};

/// Keeps a folder that is there for this process while its files are replaced. Portable: nothing.
class FolderLock {
 public:
  FolderLock() = default;
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();
  /// Waits for others, no longer than the limit and not past a signal that ends programs: false then. True where the
  /// file system knows no locks.
  [[nodiscard]] bool take(const std::filesystem::path& folder, std::chrono::milliseconds limit);

 private:
  int descriptor_ = -1;
};

}  // namespace alcap::app
