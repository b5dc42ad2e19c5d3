// SPDX-License-Identifier: MIT
//
// atomic_file.cpp: write to a temporary name, rename when complete.
#include "src/base/atomic_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "alcap/errors.h"
#include "src/base/cancel.h"
#include "src/base/file_names.h"

namespace alcap::detail {
namespace {

// The signal may have been somebody's wish to stop. Checks answer every hundredth of a second.
void after_signal() {
  ::usleep(20'000);
  check_cancelled();
}

}  // namespace

std::vector<std::filesystem::path> find_leftovers(const std::filesystem::path& target) {
  std::vector<std::filesystem::path> found;
  // Also of files beside it: x_singularities.vtp beside x.vtp.
  const std::string prefix = "." + target.stem().string().substr(0, 200);  // names are cut there
  std::error_code error;
  std::filesystem::directory_iterator entries(folder_of(target), error);
  for (; !error && entries != std::filesystem::directory_iterator(); entries.increment(error)) {
    const std::string name = entries->path().filename().string();
    if (!name.starts_with(prefix) || name.find(".tmp-") == std::string::npos) continue;
    const int descriptor = ::open(entries->path().c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
    if (descriptor < 0) continue;
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) found.push_back(entries->path());
    ::close(descriptor);
  }
  std::sort(found.begin(), found.end());
  return found;
}

void sync_folder(const std::filesystem::path& folder) noexcept {
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  static_cast<void>(::fsync(descriptor));
  ::close(descriptor);
}

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)), final_(follow_links(target_)) {
  if (target_.filename().empty()) fail("this names a folder, not a file", 0);
  if (final_.empty()) fail("this symbolic link leads in a circle", 0);
  struct stat old = {};
  const bool exists = ::stat(final_.c_str(), &old) == 0;
  if (!exists && final_ != target_) fail(leads_nowhere(final_), 0);
  if (exists && S_ISDIR(old.st_mode)) fail("this is a folder; give the name of a file", 0);
  if (exists && !S_ISREG(old.st_mode)) {
    // A pipe opens when it has a reader.
    while ((descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC)) < 0 && errno == EINTR) after_signal();
    if (descriptor_ < 0) fail("cannot open for writing", errno);
    return;
  }
  create();
  if (exists) static_cast<void>(::fchmod(descriptor_, old.st_mode & 07777));  // a replaced file keeps its permissions
}

void AtomicFile::create() {
  for (int attempt = 0; attempt < 100 && descriptor_ < 0; ++attempt) {
    temporary_ = temporary_name(final_);
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ >= 0 || errno == EEXIST) continue;
    if (errno != EINTR) break;
    after_signal();
  }
  if (descriptor_ < 0) {
    const int error = errno;
    temporary_.clear();
    fail(error == ENOENT ? "cannot write: the folder does not exist; create it first" : "cannot write", error);
  }
  static_cast<void>(::flock(descriptor_, LOCK_EX | LOCK_NB));  // says that its writer lives
}

AtomicFile::~AtomicFile() { discard(); }

void AtomicFile::flush() {
  flush(buffer_);
  buffer_.clear();
}

void AtomicFile::flush(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) {
      after_signal();
      continue;
    }
    if (written <= 0) fail("writing failed after " + std::to_string(flushed_) + " bytes", errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
    flushed_ += written;
    check_cancelled();
  }
}

void AtomicFile::complete() {
  if (descriptor_ < 0) fail("written twice or after a failure", 0);
  flush();
  // Pipes have no disk behind them, and some file systems no fsync.
  while (!temporary_.empty() && ::fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOSYS) {
    if (errno != EINTR) fail("the disk did not take it", errno);
    after_signal();
  }
  complete_ = true;
}

void AtomicFile::commit() {
  if (!complete_) complete();
  complete_ = false;
  if (!temporary_.empty()) {
    if (::rename(temporary_.c_str(), final_.c_str()) != 0) fail("cannot give the finished file its name", errno);
    temporary_.clear();
    sync_folder(folder_of(final_));
  }
  // Interrupted, it is closed all the same, on Linux.
  if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR) fail("closing failed", errno);
}

void AtomicFile::discard() noexcept {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  temporary_.clear();
}

void AtomicFile::fail(const std::string& what, int error) {
  discard();
  const std::string reason = error == 0 ? "" : " (" + std::generic_category().message(error) + ")";
  throw FileError(target_.string() + ": " + what + reason, target_.string());
}

}  // namespace alcap::detail
