// SPDX-License-Identifier: MIT
//
// plan_command.cpp: `alcap plan`, what a field will take before it is computed.
#include <fmt/core.h>

#include <charconv>
#include <cstdint>
#include <limits>
#include <memory>

#include "alcap/plan.h"
#include "apps/alcap/commands/commands.h"
#include "apps/alcap/options/cli.h"
#include "apps/alcap/options/shared_options.h"
#include "apps/alcap/report/report.h"
#include "src/base/numbers.h"

namespace alcap::app {
namespace plan_parts {
namespace {

constexpr const char* footer =
    "Examples:\n"
    "  alcap plan bunny.ply -n 4\n"
    "  alcap plan 20000000 -n 4 --formats ply,vtp      before there is such a mesh\n"
    "  alcap plan 20000000 --memory 64 --speed 1       for another machine, 64 GB, as quick as the model's\n"
    "\n"
    "Predicts memory, time and disk of every phase of alcap field from constants that were measured; docs/scale.md "
    "has\n"
    "them. Without --speed a small field is computed to see how quick this core is. Exit code 0: it fits. 4: the\n"
    "library cannot number such a mesh. 7: there is not enough memory.";

struct PlanCommandOptions {
  MeshChoice mesh = {};
  PlanOptions plan = {};
  double speed = 0;   // measured
  double memory = 0;  // in GB; what is free
  std::vector<std::string> formats = {"ply"};
};

/// The number of triangles, when that is what MESH says.
std::int64_t number_of(const std::string& text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : 0;
}

std::string size_text(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.0f} MB", bytes / 1e6) : fmt::format("{:.1f} GB", bytes / 1e9);
}
std::string time_text(double seconds) {
  return seconds < 1     ? fmt::format("{:.2f} s", seconds)
         : seconds < 600 ? fmt::format("{:.0f} s", seconds)
                         : fmt::format("{:.0f} min", seconds / 60);
}

Json plan_json(const RunPlan& plan, const PlanOptions& options) {
  Json json{{"faces", options.faces}, {"halfedges", plan.halfedges}, {"matrix_entries", plan.matrix_entries},
            {"n", options.n},         {"speed", options.speed},      {"refusals", plan.refusals}};
  json["phases"] = Json::array();
  for (const PhasePlan& phase : plan.phases)
    json["phases"].push_back(
        {{"name", phase.name}, {"seconds", phase.seconds}, {"bytes", phase.bytes}, {"disk", phase.disk}});
  json["seconds"] = plan.seconds;
  json["bytes"] = plan.bytes;
  json["most_bytes"] = plan.most_bytes;
  json["factor_bytes"] = plan.factor_bytes;
  json["disk"] = plan.disk;
  json["memory"] = plan.memory > 0 ? Json(plan.memory) : Json(nullptr);
  json["largest"] = plan.memory > 0 ? Json(plan.largest) : Json(nullptr);
  json["factor_fits"] = plan.factor_fits;
  return json;
}

std::string summary(const RunPlan& plan, const PlanOptions& options) {
  std::string text = summary_line("mesh", fmt::format("{} triangles, {} matrix entries, n = {}", grouped(options.faces),
                                                      grouped(plan.matrix_entries), options.n));
  for (const PhasePlan& phase : plan.phases)
    text += summary_line(phase.name, fmt::format("{:>8} {:>9}{}", time_text(phase.seconds), size_text(phase.bytes),
                                                 phase.disk > 0 ? "  on disk " + size_text(phase.disk) : ""));
  text += summary_line("all", fmt::format("{:>8} {:>9}, {} in the hardest case measured", time_text(plan.seconds),
                                          size_text(plan.bytes), size_text(plan.most_bytes)));
  if (plan.memory > 0)
    text +=
        summary_line("here", fmt::format("{} free: up to {} triangles", size_text(plan.memory), grouped(plan.largest)));
  text += summary_line("solver", plan.factor_fits ? std::string("auto; a factorisation fits as well")
                                                  : fmt::format("auto; a factorisation would take {} more",
                                                                size_text(plan.factor_bytes)));
  for (const std::string& r : plan.refusals) text += summary_line("refused", r);
  if (plan.refusals.empty()) text += summary_line("fits", plan.fits() ? "yes" : "no");
  return text;
}

Outcome run(PlanCommandOptions options, Progress& progress) {
  Json report = report_head("plan", true);
  PlanOptions& plan_options = options.plan;
  plan_options.faces = number_of(options.mesh.path.string());
  if (plan_options.faces == 0) {
    progress.phase("reading");
    const MeshFile file = read_choice(options.mesh);
    report["input"] = input_json(options.mesh.path, file);
    plan_options.faces = file.F.rows();
    plan_options.vertices = file.V.rows();
  }
  plan_options.formats = options.formats;
  plan_options.memory =
      detail::to_integer(1e9 * options.memory, std::int64_t{0}, std::numeric_limits<std::int64_t>::max());
  if (options.speed <= 0) progress.phase("measuring this core");
  plan_options.speed = options.speed > 0 ? options.speed : relative_speed();
  const RunPlan plan = plan_field(plan_options);

  report["ok"] = plan.fits();
  report["plan"] = plan_json(plan, plan_options);
  Outcome outcome{.report = std::move(report)};
  outcome.text = summary(plan, plan_options);
  if (!plan.refusals.empty()) {
    outcome.exit = Exit::mesh;
    outcome.complaint = plan.refusals.front();
  } else if (!plan.fits()) {
    outcome.exit = Exit::solver;
    outcome.complaint = fmt::format("needs up to {}, there are {}; {} triangles fit", size_text(plan.most_bytes),
                                    size_text(plan.memory), grouped(plan.largest));
  }
  return outcome;
}

std::function<Outcome(const Common&, Progress&)> attach(cli::App& app) {
  auto options = std::make_shared<PlanCommandOptions>();
  app.footer(footer);
  app.add_option("mesh", options->mesh.path, "Mesh file, or a number of triangles")
      ->required()
      ->type_name("MESH|TRIANGLES");
  app.add_option("-n,-r,--degree,--rosy", options->plan.n, "Symmetry of the field")
      ->type_name("N")
      ->capture_default_str()
      ->check(cli::Range(1, 1000));
  app.add_option("--formats", options->formats, "Files to be written: ply, vtp, rosy, rawfield")
      ->type_name("EXT,...")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--memory", options->memory, "Gigabytes to plan for; default: what is free here")
      ->type_name("GB")
      ->check(cli::PositiveNumber);
  app.add_option("--speed", options->speed, "Of a core, 1 for the machine of docs/scale.md; default: measured here")
      ->type_name("X")
      ->check(cli::PositiveNumber);
  return [options](const Common& common, Progress& progress) {
    options->plan.threads = common.threads;
    return run(*options, progress);
  };
}

}  // namespace
}  // namespace plan_parts

const Command plan_command{"plan", "Memory, time and disk that a field will take, before it is computed", true,
                           &plan_parts::attach};

}  // namespace alcap::app
