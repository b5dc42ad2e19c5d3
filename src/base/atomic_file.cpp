// SPDX-License-Identifier: MIT
//
// atomic_file.cpp: write to a temporary name, rename when complete.
#include "src/base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <system_error>
#include <utility>

#include "alcap/errors.h"
#include "src/base/cancel.h"

namespace alcap::detail {
namespace {

// A name nobody else uses: O_EXCL decides, process and counter only make a second try rare.
std::string unique_suffix() {
  static std::atomic<unsigned> counter{0};
  return ".tmp-" + std::to_string(::getpid()) + "-" + std::to_string(counter.fetch_add(1));
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)), final_(target_) {
  std::error_code ignored;
  if (target_.filename().empty()) fail("this names a folder, not a file", 0);
  if (std::filesystem::is_symlink(target_, ignored)) {
    final_ = std::filesystem::weakly_canonical(target_, ignored);
    if (final_.empty()) final_ = target_;
  }
  struct stat old = {};
  const bool exists = ::stat(final_.c_str(), &old) == 0;
  if (exists && S_ISDIR(old.st_mode)) fail("this is a folder; give the name of a file", 0);
  if (exists && !S_ISREG(old.st_mode)) {
    descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail("cannot open for writing", errno);
    return;
  }
  for (int attempt = 0; attempt < 100 && descriptor_ < 0; ++attempt) {
    temporary_ = final_;
    temporary_ += unique_suffix();
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST) break;
  }
  if (descriptor_ < 0) {
    const int error = errno;
    temporary_.clear();
    fail(error == ENOENT ? "cannot write: the folder does not exist; create it first" : "cannot write", error);
  }
  if (exists) static_cast<void>(::fchmod(descriptor_, old.st_mode & 07777));  // a replaced file keeps its permissions
}

AtomicFile::~AtomicFile() { discard(); }

void AtomicFile::flush() {
  flush(buffer_);
  buffer_.clear();
}

void AtomicFile::flush(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail("writing failed after " + std::to_string(flushed_) + " bytes", errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
    flushed_ += written;
    check_cancelled();
  }
}

void AtomicFile::complete() {
  if (descriptor_ < 0) fail("written twice or after a failure", 0);
  flush();
  if (::close(std::exchange(descriptor_, -1)) != 0) fail("closing failed", errno);
  complete_ = true;
}

void AtomicFile::commit() {
  if (!complete_) complete();
  complete_ = false;
  if (temporary_.empty()) return;
  if (::rename(temporary_.c_str(), final_.c_str()) != 0) fail("cannot give the finished file its name", errno);
  temporary_.clear();
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
