// SPDX-License-Identifier: MIT
//
// printable.h: text that goes to a terminal. Names of files may hold any byte, also those that move the cursor or
// change its colours; they are shown as \\xNN.
#pragma once

#include <string>
#include <string_view>

namespace alcap::app {

/// Several lines: tabs and line ends stay.
[[nodiscard]] std::string printable(std::string_view text);
/// One line: line ends are escaped too.
[[nodiscard]] std::string printable_line(std::string_view text);

}  // namespace alcap::app
