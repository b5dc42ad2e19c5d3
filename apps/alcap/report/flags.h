// SPDX-License-Identifier: MIT
//
// flags.h: the library's messages name its functions and options; here they get the names of the command line.
#pragma once

#include <string>
#include <string_view>

namespace alcap::app {

/// "join them with Repair::weld" -> "join them with --repair weld".
[[nodiscard]] std::string in_flags(std::string message);

/// The flag that sets a field of the library's options, such as "--tolerance"; empty when there is none.
[[nodiscard]] std::string_view flag_of(std::string_view field);

}  // namespace alcap::app
