// SPDX-License-Identifier: MIT
//
// portable/atomic_file.cpp: the same in C++ alone, with ALCAP_PORTABLE: no wait for the disk, no locks, so nothing that
// a killed program left is recognised.
#include "src/base/atomic_file.h"

#include <cerrno>
#include <system_error>
#include <utility>

#include "alcap/errors.h"
#include "src/base/cancel.h"

namespace alcap::detail {

std::vector<std::filesystem::path> find_leftovers(const std::filesystem::path&) { return {}; }

void sync_folder(const std::filesystem::path&) noexcept {}

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)), final_(follow_links(target_)) {
  if (target_.filename().empty()) fail("this names a folder, not a file", 0);
  if (final_.empty()) fail("this symbolic link leads in a circle", 0);
  std::error_code error;
  const std::filesystem::file_status old = std::filesystem::status(final_, error);
  if (!std::filesystem::exists(old) && final_ != target_) fail(leads_nowhere(final_), 0);
  if (std::filesystem::is_directory(old)) fail("this is a folder; give the name of a file", 0);
  if (std::filesystem::exists(old) && !std::filesystem::is_regular_file(old)) {
    stream_ = std::fopen(target_.string().c_str(), "wb");
    if (stream_ == nullptr) fail("cannot open for writing", errno);
    return;
  }
  create();
  if (std::filesystem::exists(old)) std::filesystem::permissions(temporary_, old.permissions(), error);
}

void AtomicFile::create() {
  temporary_ = temporary_name(final_);
  stream_ = std::fopen(temporary_.string().c_str(), "wbx");
  if (stream_ != nullptr) return;
  const int error = errno;
  temporary_.clear();
  fail(error == ENOENT ? "cannot write: the folder does not exist; create it first" : "cannot write", error);
}

AtomicFile::~AtomicFile() { discard(); }

void AtomicFile::flush() {
  flush(buffer_);
  buffer_.clear();
}

void AtomicFile::flush(std::string_view bytes) {
  if (!bytes.empty() && std::fwrite(bytes.data(), 1, bytes.size(), stream_) != bytes.size())
    fail("writing failed after " + std::to_string(flushed_) + " bytes", errno);
  flushed_ += static_cast<std::int64_t>(bytes.size());
  check_cancelled();
}

void AtomicFile::complete() {
  if (stream_ == nullptr) fail("written twice or after a failure", 0);
  flush();
  if (std::fflush(stream_) != 0) fail("the disk did not take it", errno);
  complete_ = true;
}

void AtomicFile::commit() {
  if (!complete_) complete();
  complete_ = false;
  if (std::fclose(std::exchange(stream_, nullptr)) != 0) fail("closing failed", errno);
  if (temporary_.empty()) return;
  std::error_code error;
  std::filesystem::rename(temporary_, final_, error);
  if (error) fail("cannot give the finished file its name", error.value());
  temporary_.clear();
}

void AtomicFile::discard() noexcept {
  if (stream_ != nullptr) std::fclose(std::exchange(stream_, nullptr));
  std::error_code ignored;
  if (!temporary_.empty()) std::filesystem::remove(temporary_, ignored);
  temporary_.clear();
}

void AtomicFile::fail(const std::string& what, int error) {
  discard();
  const std::string reason = error == 0 ? "" : " (" + std::generic_category().message(error) + ")";
  throw FileError(target_.string() + ": " + what + reason, target_.string());
}

}  // namespace alcap::detail
