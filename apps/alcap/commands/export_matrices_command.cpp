// SPDX-License-Identifier: MIT
//
// export_matrices_command.cpp: `alcap export-matrices`, the matrices of a mesh's smoothest field as files, for other
// solvers.
#include <fmt/core.h>

#include <memory>

#include "alcap/energies.h"
#include "alcap/matrix_file.h"
#include "apps/alcap/commands/commands.h"
#include "apps/alcap/options/cli.h"
#include "apps/alcap/options/shared_options.h"
#include "apps/alcap/report/outputs.h"
#include "apps/alcap/report/report.h"

namespace alcap::app {
namespace export_matrices_parts {
namespace {

constexpr const char* footer =
    "Examples:\n"
    "  alcap export-matrices bunny.ply -n 4 --format npz -o matrices\n"
    "  alcap export-matrices bunny.ply -n 1 --format petsc --connection polar -o matrices\n"
    "\n"
    "The folder gets stiffness.EXT, mass.EXT and report.json. The smoothest n-field is the eigenvector u of\n"
    "S u = lambda M u with the smallest lambda. S is Hermitian positive semidefinite, M positive definite; both have\n"
    "a row per vertex and the same places of entries. docs/backends.md shows how to read the files.";

struct ExportOptions {
  MeshChoice mesh = {};
  ConnectionOptions connection = {};
  std::string format = "npz";
  std::filesystem::path output = {};
  double energy = 0;
};

Outcome run(const ExportOptions& options, const Common& common, Progress& progress) {
  if (const std::filesystem::path& out = options.output;
      out.has_filename() && out.has_extension() && !is_directory(out))
    throw Failure(Exit::usage,
                  fmt::format("-o {}: the matrices go into a folder; put a / at the end of its name", out.string()),
                  {{"option", "-o"}, {"value", out.string()}});
  const OutputPlan plan = plan_output(options.output, {});
  const std::string stiffness = "stiffness." + options.format, mass = "mass." + options.format;
  check_distinct({{"--report", common.report}, {"-o", plan.target / stiffness}, {"-o", plan.target / mass}},
                 {{"mesh", options.mesh.path}});
  progress.phase("reading");
  MeshFile file = read_choice(options.mesh);
  std::vector<Remark> remarks;
  const Surface mesh = make_surface(options.mesh, file, remarks);
  progress.phase("finding the connection");
  const ConnectedSurface surface = connect(mesh, options.connection);
  progress.phase("assembling");
  const StiffnessMass matrices = energy_matrices(surface, options.connection.n, options.energy);

  Json report = report_head("export-matrices", true);
  report["input"] = input_json(options.mesh.path, file);
  report["n"] = options.connection.n;
  report["energy"] = options.energy;
  report["mesh"] = mesh_json(surface);
  report["connection"] = connection_json(surface, options.connection);
  report["matrices"] = {{"format", options.format},
                        {"rows", matrices.S.rows()},
                        {"entries", {{"stiffness", matrices.S.nonZeros()}, {"mass", matrices.M.nonZeros()}}},
                        {"area", surface.geometry().total_area()}};
  report["warnings"] = remarks_json(remarks, true);
  report["notes"] = remarks_json(remarks, false);

  progress.phase("writing");
  const MatrixFormat format = from_name<MatrixFormat>(options.format).value();
  for (const std::string& name : {stiffness, mass, std::string("report.json")})
    report["files"].push_back((plan.target / name).string());
  write_folder(plan.target, [&](const std::filesystem::path& folder) {
    write_matrix(folder / stiffness, matrices.S, format);
    write_matrix(folder / mass, matrices.M, format);
    write_text(folder / "report.json", text_of(report, 2) + "\n");
  });

  Outcome outcome{.report = std::move(report)};
  outcome.text = summary_line("matrices", fmt::format("{} rows, {} entries each, n = {}", grouped(matrices.S.rows()),
                                                      grouped(matrices.S.nonZeros()), options.connection.n));
  for (const Json& f : outcome.report["files"]) outcome.text += summary_line("wrote", f.get<std::string>());
  return outcome;
}

std::function<Outcome(const Common&, Progress&)> attach(cli::App& app) {
  auto options = std::make_shared<ExportOptions>();
  app.footer(footer);
  add_mesh_options(app, options->mesh);
  app.add_option("-n,-r,--degree,--rosy", options->connection.n, "Symmetry of the field")
      ->type_name("N")
      ->capture_default_str()
      ->check(cli::Range(1, 1000));
  std::vector<std::string> formats;
  for (const auto& [format, text] : names_of<MatrixFormat>()) formats.emplace_back(text);
  app.add_option("--format", options->format,
                 "npz: SciPy; mtx: Matrix Market, text; petsc: PETSc's binary, for a complex build")
      ->type_name("FORMAT")
      ->capture_default_str()
      ->check(cli::IsMember(formats));
  app.add_option("-s,--energy", options->energy,
                 "Energy family in [-1, 1]: 0 Dirichlet, 1 favours holomorphic, -1 antiholomorphic fields")
      ->type_name("S")
      ->capture_default_str()
      ->check(cli::Range(-1.0, 1.0));
  app.add_option("-o,--output", options->output, "Folder for the files")->required()->type_name("FOLDER");
  add_connection_options(app, options->connection);
  return [options](const Common& common, Progress& progress) { return run(*options, common, progress); };
}

}  // namespace
}  // namespace export_matrices_parts

const Command export_matrices_command{"export-matrices", "The matrices of a mesh's fields as files, for other solvers",
                                      true, &export_matrices_parts::attach};

}  // namespace alcap::app
