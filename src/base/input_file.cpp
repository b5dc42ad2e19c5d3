// SPDX-License-Identifier: MIT
#include "src/base/input_file.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "alcap/errors.h"
#include "src/base/cancel.h"
#include "src/base/clock.h"
#include "src/base/numbers.h"

namespace alcap::detail {
namespace {

constexpr std::int64_t block = std::int64_t{1} << 24;  // between two looks at cancel

/// One file while it is read.
class Reader {
 public:
  Reader(const std::filesystem::path& path, const InputLimits& limits)
      : path_(path), limits_(limits), largest_(limits.largest > 0 ? limits.largest : half_of_memory()) {
    // Without waiting: a pipe without a writer would hold this call until there is one.
    constexpr int how = O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY;
    while ((descriptor_ = ::open(path.c_str(), how)) < 0 && errno == EINTR) check_cancelled();
    if (descriptor_ < 0) fail_to_open(errno);
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { ::close(descriptor_); }

  Array<char> read(std::int64_t& size) {
    struct stat status = {};
    if (::fstat(descriptor_, &status) != 0) fail(reason("cannot be looked at", errno));
    if (S_ISDIR(status.st_mode)) fail("this is a folder; give the " + std::string(limits_.what) + " inside it");
    const bool pipe = S_ISFIFO(status.st_mode);
    if (!pipe && !S_ISREG(status.st_mode)) fail("this is a device or socket; give a file or a pipe");
    return status.st_size > 0 && !pipe ? read_regular(status.st_size, size) : read_to_end(pipe, size);
  }

 private:
  static std::int64_t half_of_memory() {
    const long pages = ::sysconf(_SC_PHYS_PAGES), bytes = ::sysconf(_SC_PAGESIZE);
    return pages > 0 && bytes > 0 ? std::int64_t{pages} * bytes / 2 : std::int64_t{1} << 32;
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw FileError(path_.string() + ": " + message, path_.string());
  }
  static std::string reason(const std::string& what, int error) {
    return what + " (" + std::generic_category().message(error) + ")";
  }
  [[noreturn]] void fail_to_open(int error) const {
    if (error == ENOENT || error == ENOTDIR) fail("there is no such file; check the name and the folder");
    if (error == ENXIO) fail("this is a device or socket; give a file or a pipe");
    fail(reason("cannot be read", error) + (error == EACCES ? "; check its permissions" : ""));
  }
  void check_size(std::int64_t size) const {
    if (size > largest_)
      fail("has more than " + std::to_string(largest_) + " bytes, too many for a " + std::string(limits_.what));
  }

  /// At most `count` bytes; 0 at the end, -1 where a pipe has none yet.
  std::int64_t some(char* to, std::int64_t count) {
    for (;;) {
      const ssize_t got = ::read(descriptor_, to, at(count));
      if (got >= 0) return got;
      if (errno == EAGAIN || errno == EWOULDBLOCK) return -1;
      if (errno != EINTR) fail(reason("reading failed", errno));
      check_cancelled();
    }
  }

  Array<char> read_regular(std::int64_t expected, std::int64_t& size) {
    check_size(expected);
    Array<char> bytes(expected);
    while (size < expected) {
      check_cancelled();
      const std::int64_t got = some(bytes.data() + size, std::min(block, expected - size));
      if (got <= 0)
        fail("became shorter while it was read: " + std::to_string(size) + " of " + std::to_string(expected) +
             " bytes are left; read it again when it is complete");
      size += got;
    }
    return bytes;
  }

  // Also files of /proc and the like, which have no size.
  Array<char> read_to_end(bool pipe, std::int64_t& size) {
    Array<char> bytes(std::min<std::int64_t>(largest_ + 1, 1 << 16));
    bool met = !pipe;  // a writer
    for (Stopwatch silence;;) {
      check_cancelled();
      check_size(size);
      if (size == bytes.size()) {
        Array<char> larger(std::min(2 * bytes.size(), largest_ + 1));
        std::copy_n(bytes.data(), size, larger.data());
        bytes = std::move(larger);
      }
      const std::int64_t got = some(bytes.data() + size, std::min(block, bytes.size() - size));
      met = met || got != 0;
      if (got > 0) {
        size += got;
        silence.lap();
        continue;
      }
      if (got == 0 && met) return bytes;
      pollfd one{.fd = descriptor_, .events = POLLIN, .revents = 0};
      (void)::poll(&one, 1, 50);
      // A writer has come and gone; what it may have left is read first.
      if (got == 0 && (one.revents & (POLLHUP | POLLIN)) == POLLHUP) return bytes;
      if (silence.seconds() > (met ? limits_.silent_seconds : limits_.writer_seconds))
        fail(met ? "the program that writes into this pipe has stopped; give a file"
                 : "no program writes into this pipe");
    }
  }

  const std::filesystem::path& path_;
  const InputLimits& limits_;
  std::int64_t largest_;
  int descriptor_ = -1;
};

}  // namespace

InputFile::InputFile(const std::filesystem::path& path, const InputLimits& limits)
    : bytes_(Reader(path, limits).read(size_)) {}

}  // namespace alcap::detail
