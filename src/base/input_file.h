// SPDX-License-Identifier: MIT
//
// input_file.h: the bytes of an input file. It is opened once and read to its end into memory: what is parsed are the
// bytes of one moment, whoever renames, shortens or replaces the file meanwhile, and a file that becomes shorter while
// it is read is an error and no signal (a mapped file would be one). Pipes work too, within bounds of size and
// patience; devices, sockets and folders are refused.
//
//   const alcap::detail::InputFile file("bunny.ply", {.what = "mesh file"});
//   parse(file.bytes());
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "src/base/array.h"

namespace alcap::detail {

struct InputLimits {
  const char* what = "file";  ///< what it should be, for messages: "give the <what> inside it"
  /// Bytes; 0: half of the machine's memory. Only a bound for what has no end: lists and designs are far smaller.
  std::int64_t largest = 0;
  double writer_seconds = 10;   ///< how long a pipe may have nobody who writes into it
  double silent_seconds = 600;  ///< how long a writer may write nothing
};

class InputFile {
 public:
  /// Throws FileError: missing, a folder, a device, not readable, too large, became shorter, a pipe without a writer.
  /// Throws Cancelled in a cancelled call (cancel.h).
  explicit InputFile(const std::filesystem::path& path, const InputLimits& limits = {});

  /// Valid while this object lives.
  [[nodiscard]] std::string_view bytes() const { return {bytes_.data(), at(size_)}; }

 private:
  std::int64_t size_ = 0;
  Array<char> bytes_;  // reading it sets the size
};

}  // namespace alcap::detail
