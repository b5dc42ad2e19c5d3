// SPDX-License-Identifier: MIT
//
// shared_options.cpp: groups of options that several subcommands have.
#include "apps/alcap/options/shared_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "alcap/solve.h"
#include "apps/alcap/options/cli.h"

namespace alcap::app {
namespace {

/// A whole number, or a decimal one, that is all of `text`. Throws cli::ValidationError.
template <class T>
T parse_number(const std::string& whole, const std::string& text) {
  T value{};
  const char* const end = text.data() + text.size();
  const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stop != end) {
    throw cli::ValidationError("--cone", whole + " should be VERTEX:INDEX, such as 12:1/4 or 7:-0.5");
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

}  // namespace

void add_mesh_options(cli::App& app, MeshChoice& choice) {
  app.add_option("mesh", choice.path, "Triangle mesh: OBJ, OFF, PLY or STL")->required()->type_name("MESH");
  const std::map<std::string, Repair> repairs{{"orient", Repair::orient}, {"weld", Repair::weld}};
  app.add_option_function<std::vector<std::string>>(
         "--repair",
         [&choice, repairs](const std::vector<std::string>& names) {
           for (const std::string& n : names) choice.repairs.push_back(repairs.at(n));
         },
         "orient: turn faces so that neighbours agree; weld: join vertices at the same position. "
         "May be given twice; numbers never change")
      ->type_name("REPAIR")
      ->check(cli::IsMember({"orient", "weld"}))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group("Mesh");
  app.add_option("--input-format", choice.format, "Read MESH as this format instead of recognising it")
      ->type_name("FORMAT")
      ->check(cli::IsMember(mesh_formats()))
      ->group("Mesh");
  app.add_flag("--refuse-polygons", choice.refuse_polygons, "Stop at faces of more than three corners")->group("Mesh");
}

MeshFile read_choice(const MeshChoice& choice) {
  using Polygons = ReadOptions::Polygons;
  return read_mesh(choice.path, {.polygons = choice.refuse_polygons ? Polygons::refuse : Polygons::triangulate,
                                 .format = choice.format});
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
         "published tables; trivial: flat but for the vertices given by --cone")
      ->type_name("KIND")
      ->check(cli::IsMember({"global", "local", "polar", "polar-barycenter", "trivial"}))
      ->default_str("global")
      ->group("Connection");
  app.add_option_function<std::vector<std::string>>(
         "--cone",
         [&options](const std::vector<std::string>& cones) {
           for (const std::string& c : cones) options.cones.push_back(parse_cone(c));
           options.kind = ConnectionKind::trivial;
         },
         "Of the trivial connection (which it implies): the field's index at a vertex, as VERTEX:1/4. Repeat it; on "
         "a closed surface the indices must sum to the Euler characteristic")
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
  app.add_option("--detail", options.global.detail,
                 "Of the global connection: below 1 the field ignores small bumps (fewer singularities), above 1 it "
                 "follows every detail")
      ->type_name("X")
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
  app.add_option("--tolerance", options.tolerance, "Relative residual of the eigenvector that is asked for and checked")
      ->type_name("X")
      ->capture_default_str()
      ->check(cli::PositiveNumber)
      ->group("Solver");
  app.add_option("--max-iterations", options.max_iterations, "Give up after so many linear solves")
      ->type_name("N")
      ->capture_default_str()
      ->check(cli::PositiveNumber)
      ->group("Solver");
}

}  // namespace alcap::app
