// SPDX-License-Identifier: MIT
//
// make_command.cpp: `alcap make`, generated meshes into a file: for trying things and for examples that need no
// download.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <memory>

#include "alcap/generators.h"
#include "apps/alcap/commands/commands.h"
#include "apps/alcap/options/cli.h"
#include "apps/alcap/report/outputs.h"
#include "apps/alcap/report/report.h"

namespace alcap::app {
namespace make_parts {
namespace {

using Numbers = std::vector<double>;

/// A generator on the command line: its arguments with their defaults.
struct Kind {
  const char* name;
  const char* arguments;  ///< for the help
  Numbers defaults;
  std::size_t whole;  ///< so many first arguments are whole numbers
  MeshData (*make)(const Numbers&);
};

int whole(double x) { return static_cast<int>(x); }

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {"icosphere", "LEVEL", {4}, 1, [](const Numbers& x) { return icosphere(whole(x[0])); }},
      {"bumpy",
       "LEVEL,AMPLITUDE,FREQUENCY",
       {4, 0.3, 4},
       1,
       [](const Numbers& x) { return bumpy_sphere(whole(x[0]), x[1], x[2]); }},
      {"scan", "LEVEL,NOISE", {5, 0.1}, 1, [](const Numbers& x) { return noisy_scan(whole(x[0]), x[1], 1); }},
      {"torus",
       "NU,NV,R,r",
       {80, 40, 1, 0.4},
       2,
       [](const Numbers& x) { return torus(whole(x[0]), whole(x[1]), x[2], x[3]); }},
      {"genus",
       "GENUS,RESOLUTION",
       {2, 6},
       2,
       [](const Numbers& x) { return genus_surface(whole(x[0]), whole(x[1])); }},
      {"disk", "RINGS", {20}, 1, [](const Numbers& x) { return disk(whole(x[0])); }},
      {"grid",
       "NX,NY,WIDTH,HEIGHT",
       {20, 20, 1, 1},
       2,
       [](const Numbers& x) { return grid(whole(x[0]), whole(x[1]), x[2], x[3]); }},
      {"cylinder",
       "NU,NV,RADIUS,HEIGHT",
       {60, 30, 1, 2},
       2,
       [](const Numbers& x) { return cylinder(whole(x[0]), whole(x[1]), x[2], x[3]); }},
      {"cube", "", {}, 0, [](const Numbers&) { return cube(); }},
      {"tetrahedron", "", {}, 0, [](const Numbers&) { return tetrahedron(); }},
  };
  return all;
}

constexpr const char* footer =
    "Examples:\n"
    "  alcap make icosphere:4 -o ball.ply          a sphere of 2,562 vertices\n"
    "  alcap make torus:80,40,1,0.4 -o torus.obj\n"
    "  alcap make bumpy:5,0.3,4 -o bumpy.off\n"
    "\n"
    "Arguments that are left out have their defaults. The same arguments give the same mesh on every machine.";

struct MakeOptions {
  std::string what = {};
  std::filesystem::path output = {};
};

[[noreturn]] void refuse(const std::string& what, const std::string& rule) {
  throw Failure(Exit::usage, fmt::format("{}: {}", what, rule), {{"option", "kind"}, {"value", what}});
}

const Kind& find_kind(const std::string& name) {
  std::string list;
  for (const Kind& k : kinds()) {
    if (name == k.name) return k;
    list += (list.empty() ? "" : ", ") + std::string(k.name);
  }
  refuse(name, "there is no such generator; known are " + list);
}

Numbers arguments(const Kind& kind, const std::string& what, std::string_view list) {
  Numbers numbers = kind.defaults;
  for (std::size_t k = 0; !list.empty(); ++k) {
    const std::size_t comma = std::min(list.find(','), list.size());
    double value = 0;
    const auto [stop, error] = std::from_chars(list.data(), list.data() + comma, value);
    const bool number = error == std::errc() && stop == list.data() + comma && std::isfinite(value);
    if (k >= numbers.size() || !number || (k < kind.whole && (value != std::floor(value) || std::abs(value) > 1e6)))
      refuse(what, kind.defaults.empty() ? fmt::format("{} takes no arguments", kind.name)
                                         : fmt::format("should be {}:{}", kind.name, kind.arguments));
    numbers[k] = value;
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return numbers;
}

Outcome run(const MakeOptions& options) {
  const OutputPlan plan = plan_output(options.output, {".obj", ".off", ".ply"});
  if (plan.kind != OutputPlan::Kind::file)
    throw Failure(Exit::usage, "-o must name a file that ends with .obj, .off or .ply", {{"option", "-o"}});
  const std::size_t colon = std::min(options.what.find(':'), options.what.size());
  const Kind& kind = find_kind(options.what.substr(0, colon));
  const std::string_view list = std::string_view(options.what).substr(std::min(colon + 1, options.what.size()));
  const MeshData surface = kind.make(arguments(kind, options.what, list));
  write_guarded([&] { write_mesh(plan.target, surface.V, surface.F); });
  Outcome outcome{.report = report_head("make", true)};
  outcome.report["kind"] = options.what;
  outcome.report["vertices"] = surface.V.rows();
  outcome.report["faces"] = surface.F.rows();
  outcome.report["files"] = {plan.target.string()};
  outcome.text = fmt::format("wrote         {}: {} vertices, {} faces\n", plan.target.string(),
                             grouped(surface.V.rows()), grouped(surface.F.rows()));
  return outcome;
}

std::function<Outcome(const Common&, Progress&)> attach(cli::App& app) {
  auto options = std::make_shared<MakeOptions>();
  std::string list;
  for (const Kind& k : kinds())
    list += fmt::format("{}{}{}{}", list.empty() ? "" : ", ", k.name, k.defaults.empty() ? "" : ":", k.arguments);
  app.footer(footer);
  app.add_option("kind", options->what, list)->required()->type_name("KIND");
  app.add_option("-o,--output", options->output, "The mesh file: .obj, .off or .ply")->required()->type_name("FILE");
  return [options](const Common&, Progress&) { return run(*options); };
}

}  // namespace
}  // namespace make_parts

const Command make_command{"make", "A generated mesh: spheres, tori, higher genus, with boundary", false,
                           &make_parts::attach};

}  // namespace alcap::app
