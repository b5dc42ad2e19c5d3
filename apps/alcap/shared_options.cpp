// SPDX-License-Identifier: MIT
//
// shared_options.cpp: groups of options that several subcommands have.
#include "shared_options.h"

#include <CLI/CLI.hpp>
#include <map>

#include "alcap/solve.h"

namespace alcap::app {

void add_mesh_options(CLI::App& app, MeshChoice& choice) {
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
      ->check(CLI::IsMember({"orient", "weld"}))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group("Mesh");
  app.add_option("--input-format", choice.format, "Read MESH as this format instead of recognising it")
      ->type_name("FORMAT")
      ->check(CLI::IsMember(mesh_formats()))
      ->group("Mesh");
  app.add_flag("--refuse-polygons", choice.refuse_polygons, "Stop at faces of more than three corners")->group("Mesh");
}

MeshFile read_choice(const MeshChoice& choice) {
  using Polygons = ReadOptions::Polygons;
  return read_mesh(choice.path, {.polygons = choice.refuse_polygons ? Polygons::refuse : Polygons::triangulate,
                                 .format = choice.format});
}

void add_connection_options(CLI::App& app, FieldRunOptions& options) {
  app.add_option_function<std::string>(
         "--connection",
         [&options](const std::string& name) {
           options.connection = name == "global"  ? ConnectionKind::global
                                : name == "local" ? ConnectionKind::local
                                                  : ConnectionKind::polar;
           options.polar.center = name == "polar-barycenter" ? PolarCenter::barycenter : PolarCenter::incenter;
         },
         "How directions are compared from place to place. global: as Levi-Civita as possible, the most accurate; "
         "local: its cheap approximation; polar: the classical geodesic polar map; polar-barycenter: to reproduce "
         "published tables")
      ->type_name("KIND")
      ->check(CLI::IsMember({"global", "local", "polar", "polar-barycenter"}))
      ->default_str("global")
      ->group("Connection");
  app.add_option("--detail", options.global.detail,
                 "Of the global connection: below 1 the field ignores small bumps (fewer singularities), above 1 it "
                 "follows every detail")
      ->type_name("X")
      ->capture_default_str()
      ->check(CLI::PositiveNumber)
      ->group("Connection");
}

void add_eigen_options(CLI::App& app, EigenOptions& options) {
  std::vector<std::string> names{"auto"};
  for (const std::string& n : linear_solvers()) names.push_back(n);
  app.add_option("--solver", options.solver, "Linear solver; auto picks by size")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(CLI::IsMember(names))
      ->group("Solver");
  app.add_option("--tolerance", options.tolerance, "Relative residual of the eigenvector that is asked for and checked")
      ->type_name("X")
      ->capture_default_str()
      ->check(CLI::PositiveNumber)
      ->group("Solver");
  app.add_option("--max-iterations", options.max_iterations, "Give up after so many linear solves")
      ->type_name("N")
      ->capture_default_str()
      ->check(CLI::PositiveNumber)
      ->group("Solver");
}

}  // namespace alcap::app
