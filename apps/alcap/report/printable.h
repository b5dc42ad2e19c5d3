// SPDX-License-Identifier: MIT
//
// printable.h: text that goes to a terminal. Names of files may hold any byte, also those that move the cursor or
// change its colours; they are shown as \\xNN.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace alcap::app {

/// Several lines: tabs and line ends stay.
[[nodiscard]] std::string printable(std::string_view text);
/// One line: line ends are escaped too.
[[nodiscard]] std::string printable_line(std::string_view text);

/// A word of a command line for a shell (sh, bash, zsh), whatever bytes it holds: 'name', and $'...' with octal escapes
/// where it has control characters or is not UTF-8, so that it can be printed.
[[nodiscard]] std::string shell_word(std::string_view text);
/// The same for a file: one that starts with - is no option.
[[nodiscard]] std::string shell_file(const std::filesystem::path& file);

}  // namespace alcap::app
