// SPDX-License-Identifier: MIT
//
// portable/input_file.cpp: the same in C++ alone, with ALCAP_PORTABLE: regular files, no pipes.
#include "src/base/input_file.h"

#include <algorithm>
#include <fstream>

#include "alcap/errors.h"
#include "src/base/cancel.h"

namespace alcap::detail {
namespace {

constexpr std::int64_t block = std::int64_t{1} << 24;  // between two looks at cancel

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& message) {
  throw FileError(path.string() + ": " + message, path.string());
}

Array<char> read_all(const std::filesystem::path& path, const InputLimits& limits, std::int64_t& size) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) fail(path, "there is no such file; check the name and the folder");
  if (std::filesystem::is_directory(status))
    fail(path, "this is a folder; give the " + std::string(limits.what) + " inside it");
  if (!std::filesystem::is_regular_file(status)) fail(path, "this is a device, pipe or socket; give a file");
  const auto expected = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
  if (error) fail(path, "cannot be looked at (" + error.message() + ")");
  if (limits.largest > 0 && expected > limits.largest)
    fail(path,
         "has more than " + std::to_string(limits.largest) + " bytes, too many for a " + std::string(limits.what));
  std::ifstream in(path, std::ios::binary);
  if (!in) fail(path, "cannot be read; check its permissions");
  Array<char> bytes(expected);
  while (size < expected) {
    check_cancelled();
    in.read(bytes.data() + size, std::min(block, expected - size));
    if (in.gcount() <= 0)
      fail(path, "became shorter while it was read: " + std::to_string(size) + " of " + std::to_string(expected) +
                     " bytes are left; read it again when it is complete");
    size += in.gcount();
  }
  return bytes;
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& path, const InputLimits& limits)
    : bytes_(read_all(path, limits, size_)) {}

}  // namespace alcap::detail
