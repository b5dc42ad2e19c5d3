// SPDX-License-Identifier: MIT
//
// shared_options.cpp: groups of options that several subcommands have.
#include "apps/alcap/options/shared_options.h"
#include "apps/alcap/options/prove_option.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "alcap/design_file.h"
#include "alcap/solve.h"
#include "apps/alcap/options/cli.h"
#include "apps/alcap/options/cone_options.h"

namespace alcap::app {
namespace {

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
    throw cli::ValidationError("--align-features", text + " is not an angle in degrees, above 0 and at most 180");
  return degrees * pi<double> / 180;
}

void add_feature_options(cli::App& app, FeatureFlags& flags, const char* weight) {
  constexpr const char* group = "Alignment";
  app.add_option_function<std::string>(
         "--features", [&flags](const std::string& file) { flags.file = file; },
         "Features are the edges that a .sharp file lists, or the lines (l) of an OBJ or edges of a PLY with the same "
         "vertices, which may be MESH")
      ->type_name("FILE")
      ->check([](const std::string& text) { return std::string(text.empty() ? "the name is empty" : ""); })
      ->group(group);
  app.add_flag("--align-across", flags.across, "Across features, not along them")->group(group);
  const auto number = [&](const char* name, std::optional<double>& value, const char* type, const char* help) {
    return app
        .add_option_function<double>(
            name, [&value](double x) { value = x; }, help)
        ->type_name(type)
        ->group(group);
  };
  number("--align-weight", flags.weight, "X", weight)->check(cli::PositiveNumber);
  number("--feature-corner-angle", flags.corner_angle, "ANGLE",
         "Lines of features that turn by ANGLE degrees or more break there (default 40)")
      ->check(cli::Range(1e-9, 180.0));
  number("--feature-low-angle", flags.low_angle, "ANGLE",
         "Edges that fold by ANGLE degrees are features as well where they are joined to sharper ones")
      ->check(cli::Range(1e-9, 180.0));
  number("--feature-gap", flags.gap, "LENGTH", "Ends of feature lines this close to others are joined to them")
      ->check(cli::PositiveNumber);
  number("--feature-spur", flags.spur, "LENGTH", "Feature lines with an end that are shorter are removed")
      ->check(cli::PositiveNumber);
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
  add_cone_option(app, options.kind, options.cones);
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
  add_turns_option(
      app, "--holonomy", options.kind, options.generator_holonomy,
      "Of trivial and metric: turns around each of the 2 genus generators of homology; default the least change");
  add_turns_option(app, "--loop-index", options.kind, options.loop_index, loop_index_help);
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
  add_prove_option(app, options.prove_smallest);
}

}  // namespace alcap::app
