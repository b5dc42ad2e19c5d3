// SPDX-License-Identifier: MIT
//
// show_options.h: what shows a field to people, beside its files: a picture, its curves, a page.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/alcap/commands/command.h"
#include "apps/alcap/page/view_scene.h"
#include "apps/alcap/picture/png_picture.h"

namespace alcap::app {

struct ShowOptions {
  PictureOptions picture = {};
  std::filesystem::path html = {};  // no page
};

/// Adds --html and those of add_picture_options().
void add_show_options(cli::App& app, ShowOptions& options);

/// Throws Failure when something was asked for that cannot be made here. Quick: meant to be called before long work.
void check_show(const ShowOptions& options);

/// The curves of what was asked for.
struct ShownCurves {
  std::optional<CurveSet> picture;
  std::optional<PageCurves> page;
};

/// Traces them, and says in the report how many there are (report["curves"], of the picture) and, as a warning, whether
/// some had to end early.
[[nodiscard]] ShownCurves trace_show(const FieldOutput& output, const ShowOptions& options, Json& report);

/// Writes what was asked for and adds it to report["files"]. Throws Failure.
void write_show(const FieldOutput& output, const std::string& title, const ShowOptions& options,
                const ShownCurves& curves, Json& report);

}  // namespace alcap::app
