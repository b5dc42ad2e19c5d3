// SPDX-License-Identifier: MIT
//
// mapped_file.cpp: mmap for regular files, read for pipes.
#include "src/io/mesh/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "alcap/errors.h"
#include "src/base/array.h"

namespace alcap::detail {
namespace {

[[noreturn]] void fail_path(const std::filesystem::path& path, const std::string& message) {
  throw FileError(path.string() + ": " + message, path.string());
}

struct Descriptor {
  int number;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

std::string read_all(int descriptor, const std::filesystem::path& path) {
  constexpr std::size_t block = std::size_t{1} << 20;
  std::string all;
  for (;;) {
    const std::size_t size = all.size();
    all.resize(size + block);
    const ssize_t got = ::read(descriptor, all.data() + size, block);
    const int error = errno;
    all.resize(size + (got > 0 ? at(got) : 0));
    if (got == 0) return all;
    if (got < 0 && error != EINTR) fail_path(path, "reading failed (" + std::generic_category().message(error) + ")");
  }
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) {
  struct stat status = {};
  if (::stat(path.c_str(), &status) != 0) {
    const int error = errno;
    fail_path(path, error == ENOENT || error == ENOTDIR
                        ? std::string("there is no such file; check the name and the folder")
                        : "cannot be opened (" + std::generic_category().message(error) + ")");
  }
  if (S_ISDIR(status.st_mode)) fail_path(path, "this is a folder; give the mesh file inside it");
  if (!S_ISREG(status.st_mode) && !S_ISFIFO(status.st_mode)) {
    fail_path(path, "this is a device or socket; give a file or a pipe");
  }
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.number < 0) {
    fail_path(path, "cannot be read (" + std::generic_category().message(errno) + "); check its permissions");
  }
  const auto size = at(status.st_size);
  if (S_ISREG(status.st_mode) && size > 0) {
    void* mapped = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE | MAP_POPULATE, file.number, 0);
    if (mapped != MAP_FAILED) {
      mapped_ = mapped;
      bytes_ = {static_cast<const char*>(mapped), size};
      return;
    }
  }
  read_ = read_all(file.number, path);  // pipes, and file systems that cannot map
  bytes_ = read_;
}

MappedFile::~MappedFile() {
  if (mapped_ != nullptr) ::munmap(mapped_, bytes_.size());
}

}  // namespace alcap::detail
