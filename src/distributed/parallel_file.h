// SPDX-License-Identifier: MIT
//
// parallel_file.h: files that all ranks read or write together, by MPI-IO. Internal to src/distributed.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace alcap::detail::distributed {

/// A file open for reading on all ranks. Throws FileError on all ranks.
class ParallelInput {
 public:
  explicit ParallelInput(std::string path);
  ~ParallelInput();
  ParallelInput(const ParallelInput&) = delete;
  ParallelInput& operator=(const ParallelInput&) = delete;
  [[nodiscard]] std::int64_t size() const { return size_; }
  /// This rank's bytes; collective, any number per rank.
  [[nodiscard]] std::vector<char> read(std::int64_t offset, std::int64_t count) const;

 private:
  std::string path_;
  MPI_File file_ = MPI_FILE_NULL;
  std::int64_t size_ = 0;
};

/// A file that appears complete or not at all: written under a temporary name in the same folder, renamed by finish(),
/// removed if that is not reached. Throws FileError on all ranks.
class ParallelOutput {
 public:
  explicit ParallelOutput(std::string path);
  ~ParallelOutput();
  ParallelOutput(const ParallelOutput&) = delete;
  ParallelOutput& operator=(const ParallelOutput&) = delete;
  /// This rank's bytes; collective.
  void write(std::int64_t offset, const std::vector<char>& bytes);
  void finish();

 private:
  [[noreturn]] void fail(const std::string& what) const;
  void close();

  std::string path_;
  std::filesystem::path temporary_;
  MPI_File file_ = MPI_FILE_NULL;
};

}  // namespace alcap::detail::distributed
