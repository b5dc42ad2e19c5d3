// SPDX-License-Identifier: MIT
//
// file_names.h: names of files that are not complete yet. temporary_name() and follow_links() are in atomic_file.h.
#pragma once

#include <filesystem>
#include <string>

namespace alcap::detail {

/// The folder that a path lies in; "." for a bare name.
[[nodiscard]] std::filesystem::path folder_of(const std::filesystem::path& path);

/// What temporary names of a target start with.
[[nodiscard]] std::string prefix_of(const std::filesystem::path& target);

}  // namespace alcap::detail
