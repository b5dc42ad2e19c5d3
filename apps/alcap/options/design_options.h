// SPDX-License-Identifier: MIT
//
// design_options.h: the flags of `alcap design`, and the design that they make together with a design file.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "alcap/design_file.h"
#include "apps/alcap/commands/command.h"
#include "apps/alcap/options/shared_options.h"

namespace alcap::app {

struct DesignFlags {
  std::filesystem::path file = {};
  int n = 1;
  ConnectionOptions connection = {};
  std::vector<DesignSingularity> singularities = {};
  std::vector<DesignEdit> edits = {};
  std::vector<DesignFixed> fixed = {};
  std::vector<std::string> strokes = {};  // FILE[:WEIGHT]
  DesignBoundary boundary = {};
  std::optional<double> features_angle = {};  // degrees; given: --align-features
  bool hold = false, feature_boundary = false;
  FeatureFlags features = {};
  DesignMethod method = DesignMethod::variational;
  double s = 0;
  std::optional<DesignGuidance> guidance = {};
  std::optional<double> t = {};
  double strength = 1;
  bool pin = false;
  std::vector<double> relative_to = {};
  std::function<std::size_t(const char* option)> count = {};  // how often an option was given
};

/// Adds --design, -n, --source ... --guidance, --method and the connection options.
void add_design_options(cli::App& app, DesignFlags& flags);

/// The design file, if any, with what the flags add (controls, cones) and replace (n, connection, guidance). Throws
/// FileError and OptionError.
[[nodiscard]] DesignFile make_design(const DesignFlags& flags);

}  // namespace alcap::app
