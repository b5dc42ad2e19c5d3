// SPDX-License-Identifier: MIT
//
// sizing_options.h: --sizing: target edge lengths beside a field.
#pragma once

#include <array>
#include <filesystem>

#include "alcap/sizing.h"
#include "apps/alcap/commands/command.h"

namespace alcap::app {

struct SizingChoice {
  std::filesystem::path file = {};  ///< empty: none
  SizingOptions options = {};
  std::array<double, 2> range = {SizingOptions{}.smallest, SizingOptions{}.largest};
};

/// Adds --sizing, --sizing-error, --sizing-range and --sizing-growth.
void add_sizing_options(cli::App& app, SizingChoice& choice);

/// Throws Failure when the file cannot be written. Quick: meant to be called before long work.
void check_sizing(const SizingChoice& choice);

/// What was asked for, along `features` or, where there are none, the sharp edges of the surface; report["sizing"] says
/// what came out. Empty when nothing was asked for.
[[nodiscard]] VectorX<double> find_sizing(const Surface& surface, const FeatureGraph* features,
                                          const SizingChoice& choice, Json& report);

/// Writes it and adds it to report["files"]. Throws Failure.
void write_sizing(const VectorX<double>& h, const SizingChoice& choice, Json& report);

}  // namespace alcap::app
