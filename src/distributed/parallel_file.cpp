// SPDX-License-Identifier: MIT
#include "src/distributed/parallel_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "alcap/errors.h"
#include "src/base/array.h"
#include "src/base/atomic_file.h"
#include "src/distributed/together.h"

namespace alcap::detail::distributed {
namespace {

/// MPI counts in int. Ranks read and write on their own, long runs of bytes each: where a disk is full, collective
/// calls of Open MPI 4.1 leave the others waiting.
constexpr std::int64_t piece = std::int64_t{1} << 28;

std::string words(int code) {
  std::string text(MPI_MAX_ERROR_STRING, '\0');
  int length = 0;
  MPI_Error_string(code, text.data(), &length);
  text.resize(at(length));
  return text;
}

std::string system_words(int error) { return std::generic_category().message(error); }

std::string shared(const std::string& text) {
  const std::vector<char> bytes = gather_bytes(rank() == 0 ? std::span<const char>(text) : std::span<const char>());
  return {bytes.begin(), bytes.end()};
}

/// The file that a path names, held open while MPI opens the same path: a path alone may name another file by then.
/// What cannot be read is said in the system's words, which MPI hides.
class HeldFile {
 public:
  explicit HeldFile(const std::string& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)), error_(descriptor_ < 0 ? errno : 0) {}
  HeldFile(const HeldFile&) = delete;
  HeldFile& operator=(const HeldFile&) = delete;
  ~HeldFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  void check_readable(const std::string& path) {
    if (descriptor_ >= 0 && ::fstat(descriptor_, &about_) != 0) error_ = errno;
    if (error_ == ENOENT) throw FileError(path + ": there is no such file; check the name and the folder", path);
    if (error_ != 0) throw FileError(path + ": cannot open (" + system_words(error_) + ")", path);
    if (S_ISDIR(about_.st_mode)) throw FileError(path + ": this is a folder; give the mesh file inside it", path);
    if (!S_ISREG(about_.st_mode))
      throw FileError(path + ": several ranks cannot read this kind of file; give a regular file", path);
  }
  /// Throws where the path names another file than the one that is held.
  void check_same(const std::string& path) const {
    struct stat now = {};
    if (::stat(path.c_str(), &now) != 0 || now.st_dev != about_.st_dev || now.st_ino != about_.st_ino)
      throw FileError(path + ": the file was replaced while it was opened; run again", path);
  }

 private:
  struct stat about_ = {};
  int descriptor_, error_;
};

}  // namespace

ParallelInput::ParallelInput(std::string path) : path_(std::move(path)) {
  HeldFile held(path_);
  agreed([&] { held.check_readable(path_); });
  const int code = MPI_File_open(MPI_COMM_WORLD, path_.c_str(), MPI_MODE_RDONLY, MPI_INFO_NULL, &file_);
  agreed([&] {
    if (code != MPI_SUCCESS) throw FileError(path_ + ": cannot open (" + words(code) + ")", path_);
    held.check_same(path_);
    MPI_Offset bytes = 0;
    MPI_File_get_size(file_, &bytes);
    size_ = bytes;
  });
}

ParallelInput::~ParallelInput() {
  if (file_ != MPI_FILE_NULL) MPI_File_close(&file_);
}

std::vector<char> ParallelInput::read(std::int64_t offset, std::int64_t count) const {
  std::vector<char> bytes;
  agreed([&] { bytes.resize(at(count)); });
  std::int64_t done = 0;
  int worst = MPI_SUCCESS;
  while (done < count && worst == MPI_SUCCESS) {
    const int now = static_cast<int>(std::min(piece, count - done));
    MPI_Status status;
    const int code = MPI_File_read_at(file_, offset + done, bytes.data() + done, now, MPI_CHAR, &status);
    int got = 0;
    if (code == MPI_SUCCESS) MPI_Get_count(&status, MPI_CHAR, &got);
    if (code != MPI_SUCCESS || got != now) worst = code == MPI_SUCCESS ? MPI_ERR_IO : code;
    done += now;
  }
  agreed([&] {
    if (worst != MPI_SUCCESS) throw FileError(path_ + ": reading failed (" + words(worst) + ")", path_, 0, offset);
  });
  return bytes;
}

ParallelOutput::ParallelOutput(std::string path) : path_(std::move(path)) {
  std::string name;
  agreed([&] {
    if (rank() != 0) return;
    const std::filesystem::path target = follow_links(path_);
    if (std::filesystem::is_directory(target)) fail("this is a folder; give the name of a file");
    temporary_ = temporary_name(target);
    const int created = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (created < 0) {
      const int error = errno;
      temporary_.clear();
      fail((error == ENOENT ? "cannot write: the folder does not exist; create it first" : "cannot write") +
           std::string(" (") + system_words(error) + ")");
    }
    ::close(created);
    name = temporary_.string();
  });
  temporary_ = shared(name);
  const int code = MPI_File_open(MPI_COMM_WORLD, temporary_.c_str(), MPI_MODE_WRONLY, MPI_INFO_NULL, &file_);
  try {
    agreed([&] {
      if (code != MPI_SUCCESS) fail("cannot write (" + words(code) + ")");
    });
  } catch (...) {
    close();
    throw;
  }
}

ParallelOutput::~ParallelOutput() { close(); }

void ParallelOutput::close() {
  if (file_ != MPI_FILE_NULL) MPI_File_close(&file_);
  std::error_code ignored;
  if (!temporary_.empty() && rank() == 0) std::filesystem::remove(temporary_, ignored);
  temporary_.clear();
}

void ParallelOutput::fail(const std::string& what) const { throw FileError(path_ + ": " + what, path_); }

void ParallelOutput::write(std::int64_t offset, const std::vector<char>& bytes) {
  const std::int64_t count = count_of(bytes);
  std::int64_t done = 0;
  int worst = MPI_SUCCESS;
  while (done < count && worst == MPI_SUCCESS) {
    const int now = static_cast<int>(std::min(piece, count - done));
    MPI_Status status;
    const int code = MPI_File_write_at(file_, offset + done, bytes.data() + done, now, MPI_CHAR, &status);
    int got = 0;
    if (code == MPI_SUCCESS) MPI_Get_count(&status, MPI_CHAR, &got);
    if (code != MPI_SUCCESS || got != now) worst = code == MPI_SUCCESS ? MPI_ERR_NO_SPACE : code;
    done += now;
  }
  agreed([&] {
    if (worst != MPI_SUCCESS) fail("writing failed after " + std::to_string(offset) + " bytes (" + words(worst) + ")");
  });
}

void ParallelOutput::finish() {
  const int synced = MPI_File_sync(file_);
  const int closed = MPI_File_close(&file_);
  agreed([&] {
    if (synced != MPI_SUCCESS || closed != MPI_SUCCESS)
      fail("the disk did not take it (" + words(synced != MPI_SUCCESS ? synced : closed) + ")");
  });
  agreed([&] {
    if (rank() != 0) return;
    const std::filesystem::path target = follow_links(path_);
    std::error_code error;
    std::filesystem::rename(temporary_, target, error);
    if (error) fail("cannot give the finished file its name (" + error.message() + ")");
    sync_folder(target.parent_path());
  });
  temporary_.clear();
}

}  // namespace alcap::detail::distributed
