// SPDX-License-Identifier: MIT
#include "apps/alcap/options/tolerance_options.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <string_view>
#include <vector>

#include "apps/alcap/options/cli.h"

namespace alcap::app {
namespace {

constexpr const char* tolerance_flag = "--tolerance-of";

struct ToleranceKind {
  std::string_view name;
  double ControlTolerances::*member;
};
constexpr std::array<ToleranceKind, 7> tolerance_kinds{{{"singularity", &ControlTolerances::singularity_degrees},
                                                        {"fixed", &ControlTolerances::fixed_degrees},
                                                        {"stroke", &ControlTolerances::stroke_degrees},
                                                        {"boundary", &ControlTolerances::boundary_degrees},
                                                        {"cone", &ControlTolerances::cone_degrees},
                                                        {"fixed-value", &ControlTolerances::fixed_value},
                                                        {"pin", &ControlTolerances::pin_length}}};

void take_tolerance(const std::string& text, ControlTolerances& tolerances) {
  const std::string_view whole = text;
  const std::size_t colon = std::min(whole.find(':'), whole.size());
  const std::string_view kind = whole.substr(0, colon), number = whole.substr(std::min(colon + 1, whole.size()));
  std::string kinds;
  for (const ToleranceKind& known : tolerance_kinds) {
    kinds += kinds.empty() ? "" : ", ";
    kinds += known.name;
    double value = 0;
    const auto [stop, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    if (known.name != kind || error != std::errc() || stop != number.data() + number.size()) continue;
    tolerances.*known.member = value;
    return;
  }
  throw cli::ValidationError(
      tolerance_flag, fmt::format("{} should be KIND:VALUE, such as stroke:15, with one of the kinds {}", text, kinds));
}

}  // namespace

void add_tolerance_options(cli::App& app, ControlTolerances& tolerances) {
  app.add_option_function<std::vector<std::string>>(
         tolerance_flag,
         [&tolerances](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) take_tolerance(text, tolerances);
         },
         "How far off controls of this kind may be and still count as met, in degrees: singularity (0.5), fixed (0.5), "
         "stroke (10), boundary (10), cone (0.00036); relative: fixed-value (1e-6), pin (1e-6)")
      ->type_name("KIND:VALUE")
      ->allow_extra_args(false)
      ->group("Controls");
}

}  // namespace alcap::app
