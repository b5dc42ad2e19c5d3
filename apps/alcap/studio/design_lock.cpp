// SPDX-License-Identifier: MIT
#include "apps/alcap/studio/design_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "apps/alcap/commands/command.h"

namespace alcap::app {
namespace {

/// Whether the file that is open is still the one that has this name.
bool has_name(int descriptor, const std::filesystem::path& path) {
  struct stat mine = {}, there = {};
  if (::fstat(descriptor, &mine) != 0 || ::lstat(path.c_str(), &there) != 0) return false;
  return mine.st_dev == there.st_dev && mine.st_ino == there.st_ino;
}

}  // namespace

DesignLock::DesignLock(const std::filesystem::path& file) {
  const std::filesystem::path full = std::filesystem::absolute(file);
  const std::filesystem::path path = full.parent_path() / ("." + full.filename().string() + ".lock");
  for (;;) {
    do descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    while (descriptor_ < 0 && errno == EINTR);
    if (descriptor_ < 0) return;  // a folder that cannot be written to is somebody else's complaint
    const bool locked = ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
    if (!locked && errno == EWOULDBLOCK) {
      ::close(descriptor_);
      throw Failure(Exit::output,
                    file.string() + ": another studio works on this design; use that one, or another --design FILE",
                    {{"path", file.string()}});
    }
    // Its last holder may have removed the file after it was opened here: others lock a new one of that name.
    if (!locked || has_name(descriptor_, path)) break;
    ::close(descriptor_);
  }
  (void)file_.hold(path);
}

DesignLock::~DesignLock() {
  if (descriptor_ < 0) return;
  file_.remove();  // while it is locked
  ::close(descriptor_);
}

}  // namespace alcap::app
