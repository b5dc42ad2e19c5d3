// SPDX-License-Identifier: MIT
//
// html_page.h: the page of apps/viewer, which is built with npm and embedded in this program, filled with data.
#pragma once

#include <string>
#include <string_view>

#include "apps/alcap/commands/command.h"
#include "apps/alcap/page/view_pack.h"

namespace alcap::app {

/// Throws Failure(usage) that says what is missing when this program was built without the page.
void check_page();

/// A page that stands alone: one file, no network. Throws as check_page().
[[nodiscard]] std::string html_page(const ViewPack& scene);

/// The same page without data; `boot` tells it what to do (studio_server.cpp).
[[nodiscard]] std::string html_page(const Json& boot);

/// Text for the inside of an element.
[[nodiscard]] std::string html_escaped(std::string_view text);

}  // namespace alcap::app
