// SPDX-License-Identifier: MIT
#include "src/base/file_names.h"

#include <random>
#include <string_view>

#include "src/base/atomic_file.h"

namespace alcap::detail {

std::filesystem::path folder_of(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.parent_path();
  return folder.empty() ? "." : folder;
}

// Names may have 255 bytes, so that long ones are cut.
std::string prefix_of(const std::filesystem::path& target) {
  constexpr std::size_t most = 200;
  return "." + target.filename().string().substr(0, most) + ".tmp-";
}

std::filesystem::path temporary_name(const std::filesystem::path& target) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::random_device source;
  std::string name = prefix_of(target);
  for (int k = 0; k < 4; ++k)
    for (unsigned bits = source(), digit = 0; digit < 4; ++digit, bits >>= 4) name += digits[bits & 15U];
  return folder_of(target) / name;
}

std::filesystem::path follow_links(const std::filesystem::path& path) {
  constexpr int most = 40;  // as the system
  std::filesystem::path at = path;
  for (int k = 0; k < most; ++k) {
    std::error_code error;
    if (!std::filesystem::is_symlink(std::filesystem::symlink_status(at, error))) return at;
    const std::filesystem::path to = std::filesystem::read_symlink(at, error);
    if (error) return at;
    at = to.is_absolute() ? to : folder_of(at) / to;
  }
  return {};
}

std::string leads_nowhere(const std::filesystem::path& end) {
  return "this symbolic link leads to " + end.string() + ", which does not exist; create it, or remove the link";
}

}  // namespace alcap::detail
