// SPDX-License-Identifier: MIT
//
// mapped_file.h: the bytes of a file, mapped into memory when it is a regular file, read to its end when it is a pipe.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace alcap::detail {

class MappedFile {
 public:
  /// Throws FileError: missing, a folder, a device, not readable.
  explicit MappedFile(const std::filesystem::path& path);
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();

  /// Valid while this object lives.
  [[nodiscard]] std::string_view bytes() const { return bytes_; }

 private:
  std::string_view bytes_;
  std::string read_;  // holds the bytes when they are not mapped
  void* mapped_ = nullptr;
};

}  // namespace alcap::detail
