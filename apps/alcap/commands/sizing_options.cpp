// SPDX-License-Identifier: MIT
#include "apps/alcap/commands/sizing_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "alcap/output.h"
#include "apps/alcap/options/cli.h"
#include "apps/alcap/report/outputs.h"
#include "apps/alcap/report/report.h"

namespace alcap::app {

void add_sizing_options(cli::App& app, SizingChoice& choice) {
  app.add_option("--sizing", choice.file,
                 "Also write how long edges should be at each vertex, by curvature and features, as .sol (mmg), .csv, "
                 ".npy or .dmat")
      ->type_name("FILE")
      ->group("Sizing");
  app.add_option("--sizing-error", choice.options.error,
                 "How far such an edge may be from the surface, in diagonals of the box around the mesh")
      ->type_name("X")
      ->capture_default_str()
      ->check(cli::PositiveNumber)
      ->group("Sizing");
  app.add_option("--sizing-range", choice.range, "The shortest and the longest there are, in diagonals")
      ->type_name("MIN,MAX")
      ->delimiter(',')
      ->group("Sizing");
  app.add_option("--sizing-growth", choice.options.growth, "How fast they may change from one place to the next")
      ->type_name("X")
      ->capture_default_str()
      ->check(cli::Range(0.0, 1e6))
      ->group("Sizing");
}

void check_sizing(const SizingChoice& choice) {
  if (choice.file.empty()) return;
  const std::vector<std::string> known = scalar_formats();
  const std::string extension = choice.file.extension().string();
  if (std::none_of(known.begin(), known.end(), [&](const std::string& format) { return extension == "." + format; }))
    throw Failure(Exit::usage,
                  fmt::format("--sizing {}: use one of .{}", choice.file.string(), fmt::join(known, ", .")),
                  {{"option", "--sizing"}, {"value", choice.file.string()}});
  check_writable(choice.file);
}

VectorX<double> find_sizing(const Surface& surface, const FeatureGraph* features, const SizingChoice& choice,
                            Json& report) {
  if (choice.file.empty()) return {};
  SizingOptions options = choice.options;
  options.smallest = choice.range[0];
  options.largest = choice.range[1];
  VectorX<double> h = target_edge_lengths(surface, features != nullptr ? *features : sharp_edges(surface), options);
  report["sizing"] = {
      {"smallest", number(h.minCoeff())}, {"mean", number(h.mean())}, {"largest", number(h.maxCoeff())}};
  return h;
}

void write_sizing(const VectorX<double>& h, const SizingChoice& choice, Json& report) {
  if (choice.file.empty()) return;
  write_guarded([&] { write_scalars(h, "h", choice.file); });
  report["files"].push_back(choice.file.string());
}

}  // namespace alcap::app
