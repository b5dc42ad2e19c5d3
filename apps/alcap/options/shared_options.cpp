// SPDX-License-Identifier: MIT
//
// shared_options.cpp: groups of options that several subcommands have.
#include "apps/alcap/options/shared_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "alcap/design_file.h"
#include "alcap/solve.h"
#include "apps/alcap/options/cli.h"

namespace alcap::app {
namespace {

/// A whole number, or a decimal one, that is all of `text`. Throws cli::ValidationError.
template <class T>
T parse_number(const std::string& whole, const std::string& text, const char* option = "--cone",
               const char* form = "VERTEX:INDEX, such as 12:1/4 or 7:-0.5") {
  T value{};
  const char* const end = text.data() + text.size();
  const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stop != end) {
    throw cli::ValidationError(option, whole + " should be " + form);
  }
  return value;
}

/// "12:1/4", "12:+1", "12:-0.25"
Cone parse_cone(const std::string& text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string index = colon < text.size() ? text.substr(colon + 1) : "";
  const std::size_t slash = std::min(index.find('/'), index.size());
  Cone cone{.vertex = parse_number<Index>(text, text.substr(0, colon)),
            .index = parse_number<double>(text, index.substr(0, slash))};
  if (slash < index.size()) cone.index /= parse_number<Index>(text, index.substr(slash + 1));
  if (!std::isfinite(cone.index)) throw cli::ValidationError("--cone", text + " has no finite index");
  return cone;
}

void add_repair(const std::string& text, RepairOptions& repair) {
  constexpr std::string_view tolerance = "weld:";
  if (text.starts_with(tolerance)) {
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + tolerance.size(), end, repair.weld_tolerance);
    if (error != std::errc() || stop != end || !(repair.weld_tolerance > 0 && repair.weld_tolerance <= 0.1))
      throw cli::ValidationError("--repair", text + ": the tolerance is a number above 0 and at most 0.1");
    repair.repairs.push_back(Repair::weld);
    return;
  }
  const auto known = from_name<Repair>(text);
  if (!known) {
    std::string names;
    for (const auto& [value, name] : NamesOf<Repair>::table) names += (names.empty() ? "" : ",") + std::string(name);
    throw cli::ValidationError("--repair", text + " not in {" + names + ",weld:X}");
  }
  repair.repairs.push_back(*known);
}

}  // namespace

double feature_angle(const std::string& text) {
  if (text.empty()) return SharpEdgeOptions{}.angle;
  double degrees = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), degrees);
  if (error != std::errc() || stop != text.data() + text.size() || !(degrees > 0 && degrees <= 180))
    throw cli::ValidationError("--align-features", text + " is no angle in degrees, above 0 and at most 180");
  return degrees * pi<double> / 180;
}

void add_mesh_options(cli::App& app, MeshChoice& choice) {
  app.add_option("mesh", choice.path, "Triangle mesh: OBJ, OFF, PLY or STL")->required()->type_name("MESH");
  app.add_option_function<std::vector<std::string>>(
         "--repair",
         [&choice](const std::vector<std::string>& names) {
           for (const std::string& n : names) add_repair(n, choice.repair);
         },
         "weld: join vertices at the same position, weld:X: within X diagonals of the mesh; degenerate: remove or flip "
         "faces without area; duplicates: remove faces given twice; split: cut along edges of more than two faces; "
         "orient: turn faces so that neighbours agree; auto: what is needed of these; mollify: take edges a little "
         "longer, so "
         "that every face has an area. Repeat it; vertices keep their numbers")
      ->type_name("REPAIR")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group("Mesh");
  app.add_option("--input-format", choice.format, "Read MESH as this format instead of recognising it")
      ->type_name("FORMAT")
      ->check(cli::IsMember(mesh_formats()))
      ->group("Mesh");
  app.add_flag("--refuse-polygons", choice.refuse_polygons, "Stop at faces of more than three corners")->group("Mesh");
}

void add_lengths_option(cli::App& app, MeshChoice& choice) {
  app.add_option("--lengths", choice.lengths,
                 "An intrinsic surface: edges are as long as this text file says, three numbers a face; the mesh gives "
                 "its faces, and the points where it is drawn")
      ->type_name("FILE")
      ->group("Mesh");
}

void add_triangulation_options(cli::App& app, Triangulation& triangulation, double& min_angle) {
  app.add_option_function<std::string>(
         "--triangulation", [&](const std::string& name) { triangulation = *from_name<Triangulation>(name); },
         "Which triangles it is solved on: those of the mesh (extrinsic), better ones of the same surface (intrinsic), "
         "or the better ones where one face in a hundred has a corner below 1 degree (auto)")
      ->type_name("KIND")
      ->default_str("auto")
      ->check(cli::IsMember({"auto", "intrinsic", "extrinsic"}))
      ->group("Solver");
  app.add_option_function<double>(
         "--min-angle", [&](double degrees) { min_angle = degrees * pi<double> / 180; },
         "Corners of the better triangles, at least, in degrees; 0 adds no vertices to them")
      ->type_name("DEGREES")
      ->default_str("15")
      ->check(cli::Range(0.0, 30.0))
      ->group("Solver");
}

MeshFile read_choice(const MeshChoice& choice) {
  using Polygons = ReadOptions::Polygons;
  return read_mesh(choice.path, {.polygons = choice.refuse_polygons ? Polygons::refuse : Polygons::triangulate,
                                 .format = choice.format});
}

Surface make_surface(const MeshChoice& choice, MeshFile& file, std::vector<Remark>& remarks) {
  if (choice.lengths.empty()) {
    RepairedSurface repaired = repaired_surface(std::move(file.V), std::move(file.F), choice.repair);
    remarks.insert(remarks.end(), repaired.remarks.begin(), repaired.remarks.end());
    return std::move(repaired.surface);
  }
  const std::vector<Repair>& asked = choice.repair.repairs;
  if (std::find(asked.begin(), asked.end(), Repair::mollify) != asked.end())
    throw Failure(Exit::usage, "--repair mollify changes the lengths that --lengths gives; give one or the other",
                  {{"option", "--repair"}});
  RepairedMesh repaired = repair_mesh(std::move(file.V), std::move(file.F), choice.repair);
  add_remarks(repaired.steps, remarks);
  Mesh mesh(std::move(repaired.F), repaired.V.rows());
  const VectorX<double> lengths = read_edge_lengths(choice.lengths, mesh);
  return Surface::from_lengths(std::move(mesh), lengths, std::move(repaired.V));
}

void add_remarks(const std::vector<RepairStep>& steps, std::vector<Remark>& remarks) {
  for (const RepairStep& step : steps)
    remarks.push_back(
        {.code = step.code, .warning = false, .message = step.message, .count = step.count, .first = step.first});
}

namespace {

/// Cones make a connection trivial unless it is metric.
void imply_cones(ConnectionOptions& options) {
  if (options.kind != ConnectionKind::metric) options.kind = ConnectionKind::trivial;
}

/// "0.25", "-1/4"
double parse_turns(const char* option, const std::string& text) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  double turns = parse_number<double>(text, text.substr(0, slash), option, "a number of turns, such as 0.25 or -1/4");
  if (slash < text.size())
    turns /= parse_number<Index>(text, text.substr(slash + 1), option, "a number of turns, such as 0.25 or -1/4");
  if (!std::isfinite(turns)) throw cli::ValidationError(option, text + " is not finite");
  return turns;
}

void add_turns(cli::App& app, const char* option, ConnectionOptions& options,
               std::vector<double> ConnectionOptions::*values, const char* help) {
  app.add_option_function<std::vector<std::string>>(
         option,
         [&options, option, values](const std::vector<std::string>& texts) {
           for (const std::string& t : texts) (options.*values).push_back(parse_turns(option, t));
           imply_cones(options);
         },
         help)
      ->type_name("TURNS")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group("Connection");
}

}  // namespace

void add_connection_options(cli::App& app, ConnectionOptions& options) {
  app.add_option_function<std::string>(
         "--connection",
         [&options](const std::string& text) {
           const ConnectionChoice choice = connection_choice(text).value();  // among those checked below
           options.kind = choice.kind;
           options.polar.center = choice.center;
         },
         "How directions are compared from place to place. global: as Levi-Civita as possible, the most accurate; "
         "local: its cheap approximation; polar: the classical geodesic polar map; polar-barycenter: to reproduce "
         "published tables; trivial: flat but for the vertices given by --cone, indices multiples of 1/n; metric: any "
         "other, by --cone, --holonomy and --loop-index of any size or by --target")
      ->type_name("KIND")
      ->check(cli::IsMember({"global", "local", "polar", "polar-barycenter", "trivial", "metric"}))
      ->default_str("global")
      ->group("Connection");
  app.add_option_function<std::vector<std::string>>(
         "--cone",
         [&options](const std::vector<std::string>& cones) {
           for (const std::string& c : cones) options.cones.push_back(parse_cone(c));
           imply_cones(options);
         },
         "Of the trivial connection (which it implies) and of metric: the field's index at a vertex, as VERTEX:1/4. "
         "Repeat it; on a closed surface the indices must sum to the Euler characteristic")
      ->type_name("CONE")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group("Connection");
  app.add_option_function<std::string>(
         "--cones",
         [&options](const std::string&) {
           options.balance_cones = true;
           options.kind = ConnectionKind::trivial;
         },
         "auto-balance: add cones of +-1/n to those of --cone, where the curvature is, until they sum to the Euler "
         "characteristic")
      ->type_name("auto-balance")
      ->check(cli::IsMember({"auto-balance"}))
      ->group("Connection");
  add_turns(app, "--holonomy", options, &ConnectionOptions::generator_holonomy,
            "Of trivial and metric: turns around each of the 2 genus generators of homology; default the least change");
  add_turns(app, "--loop-index", options, &ConnectionOptions::loop_index,
            "Of trivial and metric: index of each boundary loop, in turns; default the least change");
  app.add_option_function<std::string>(
         "--target",
         [&options](const std::string& path) {
           if (path.empty()) throw cli::ValidationError("--target", "the name is empty");
           options.target = read_connection_target(path);
           options.kind = ConnectionKind::metric;
         },
         "Of the metric connection (which it implies): the nearest one to the rotations, adjustment angles or "
         "curvatures in this JSON file (docs/design.md)")
      ->type_name("FILE")
      ->group("Connection");
  app.add_flag_function(
         "--hold-curvature", [&options](std::int64_t) { options.spread = false; },
         "With --target: curvature stays in the faces around its vertex instead of spreading as far as is best")
      ->group("Connection");
  add_weight_options(app, options.global);
}

namespace {

bool says_which(cli::App& app) {
  for (const char* option : {"--connection", "--cone", "--cones", "--holonomy", "--loop-index", "--target"})
    if (app.get_option(option)->count() > 0) return true;
  return false;
}

}  // namespace

ConnectionOptions connection_for(cli::App& app, const ConnectionOptions& flags, const FieldFile& file) {
  ConnectionOptions how = says_which(app) ? flags : file.how;
  how.n = file.field.n;
  if (app.get_option("--detail")->count() > 0) how.global.detail = flags.global.detail;
  if (app.get_option("--length-factor")->count() > 0) how.global.length_factor = flags.global.length_factor;
  if (app.get_option("--tan-cap")->count() > 0) how.global.tan_cap = flags.global.tan_cap;
  return how;
}

bool connection_lost(cli::App& app, const FieldFile& file) {
  const bool prescribed = file.connection == ConnectionKind::trivial || file.connection == ConnectionKind::metric;
  return prescribed && !file.connection_known && !says_which(app);
}

void add_weight_options(cli::App& app, GlobalOptions& options) {
  app.add_option("--detail", options.detail,
                 "Of the global connection: below 1 the field ignores small bumps (fewer singularities), above 1 it "
                 "follows every detail")
      ->type_name("X")
      ->capture_default_str()
      ->check(cli::PositiveNumber)
      ->group("Connection");
  app.add_option_function<std::string>(
         "--length-factor",
         [&options](const std::string& text) {
           options.length_factor = from_name<LengthFactor>(text).value();  // among those checked below
         },
         "How much an edge counts besides its angles. mean_edge: its length over the mean, the same in every unit; "
         "metric: its length, as printed in the paper; per_edge: all the same")
      ->type_name("FACTOR")
      ->check(cli::IsMember({"mean_edge", "metric", "per_edge"}))
      ->default_str("mean_edge")
      ->group("Connection");
  app.add_option("--tan-cap", options.tan_cap, "Cap of tan(angle opposite an edge), also used at obtuse angles")
      ->type_name("X")
      ->capture_default_str()
      ->check(cli::PositiveNumber)
      ->group("Connection");
  app.add_option("--connection-tolerance", options.tolerance, "Relative residual of the global connection")
      ->type_name("X")
      ->capture_default_str()
      ->check(cli::BetweenZeroAndOne)
      ->group("Connection");
  app.add_option("--connection-iterations", options.max_iterations,
                 "Iterations after which the global connection is given up")
      ->type_name("N")
      ->capture_default_str()
      ->check(cli::PositiveNumber)
      ->group("Connection");
}

void add_eigen_options(cli::App& app, EigenOptions& options) {
  std::vector<std::string> names{"auto"};
  for (const std::string& n : linear_solvers()) names.push_back(n);
  std::vector<std::string> methods{"auto"};
  for (const std::string& n : eigen_solvers()) methods.push_back(n);
  app.add_option("--solver", options.solver, "Linear solver; auto picks by size")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(cli::IsMember(names))
      ->group("Solver");
  app.add_option("--method", options.method, "Eigensolver; auto picks by size")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(cli::IsMember(methods))
      ->group("Solver");
  app.add_option("--angle-tolerance", options.angle_tolerance,
                 "Degrees that directions may be off, as root mean square, by a bound that is checked; 0: a residual "
                 "of 1e-8 instead")
      ->type_name("DEGREES")
      ->capture_default_str()
      ->group("Solver");
  app.add_option_function<double>(
         "--tolerance", [&options](const double& x) { options.tolerance = x; },
         "Instead: relative residual of the eigenvector that is asked for and checked")
      ->type_name("X")
      ->check(cli::BetweenZeroAndOne)
      ->group("Solver");
  app.add_option("--max-iterations", options.max_iterations, "Give up after so many linear solves")
      ->type_name("N")
      ->capture_default_str()
      ->check(cli::PositiveNumber)
      ->group("Solver");
  app.add_flag_function(
         "--prove,!--no-prove",
         [&options](std::int64_t count) { options.prove_smallest = count > 0 ? Prove::always : Prove::never; },
         "Prove that no smaller eigenvalue exists, whatever the size, or do not; without either, where the proof "
         "costs less than the solve")
      ->group("Solver");
}

}  // namespace alcap::app
