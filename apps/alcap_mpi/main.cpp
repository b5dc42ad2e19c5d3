// SPDX-License-Identifier: MIT
//
// main.cpp: alcap-mpi, fields over many machines. All ranks run this; rank 0 speaks. Failures reach all ranks, which
// leave with the same exit code; one that only a single rank knows of ends all of them.
#include <fmt/core.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <new>
#include <string>
#include <vector>

#include "alcap/distributed_output.h"
#include "alcap/version.h"
#include "apps/alcap/options/cli.h"
#include "apps/alcap/options/cone_options.h"
#include "apps/alcap/options/prove_option.h"
#include "apps/alcap/options/tolerance_options.h"
#include "apps/alcap/report/flags.h"
#include "apps/alcap/report/printable.h"
#include "apps/alcap/report/report.h"
#include "apps/alcap_mpi/report.h"
#include "src/base/atomic_file.h"
#include "src/base/clock.h"
#include "src/base/parallel.h"

namespace alcap::app {
namespace {

constexpr const char* description =
    "n-vector fields on triangle meshes that no single machine holds. Run by mpirun, on any number of ranks.";

constexpr const char* footer =
    "Examples:\n"
    "  mpirun -n 4 alcap-mpi field huge.ply -n 4 -o out     out/ gets field.ply and report.json\n"
    "  mpirun -n 4 alcap-mpi field huge.ply -n 4 -o field.pvtp    pieces for ParaView\n"
    "  mpirun -n 4 alcap-mpi field huge.ply -n 2 -o lines.ply\n"
    "  mpirun -n 4 alcap-mpi design huge.ply --design saddle.json -o out\n"
    "\n"
    "Only triangles are read; alcap reads polygons and all other formats. Exit codes are those of alcap, the same on\n"
    "all ranks.";

struct Choice {
  Choice() { options.n = 4; }
  std::string mesh, output, length_factor = "mean_edge", partition = "scotch";
  std::vector<std::string> formats = {"ply"};
  DistributedOptions options;
  std::string design;
  double solve_tolerance = DistributedDesignOptions().tolerance;
  ControlTolerances tolerances;
  std::function<std::size_t(const char* option)> count;  // how often an option of the design was given
  int threads = 1;
  bool json = false, quiet = false;
};

/// Of fields and designs.
void add_common_options(cli::App& app, Choice& c) {
  app.add_option("mesh", c.mesh, "Triangle mesh: binary PLY, or OFF with one vertex or triangle a line")
      ->required()
      ->type_name("MESH");
  app.add_option("-o,--output", c.output,
                 "Folder for the field and report.json, or a file that ends with .ply or .pvtp")
      ->type_name("OUT");
  app.add_option("--formats", c.formats, "Of the files in a folder: ply, one file; pvtp, a piece per rank for ParaView")
      ->delimiter(',')
      ->check(cli::IsMember({"ply", "pvtp"}))
      ->default_str("ply");
  app.add_option("--connection-tolerance", c.options.global.tolerance, "Relative residual of the global connection")
      ->check(cli::PositiveNumber)
      ->capture_default_str();
  app.add_option("--connection-iterations", c.options.global.max_iterations,
                 "Iterations after which the global connection is given up")
      ->check(cli::PositiveNumber)
      ->capture_default_str();
  app.add_option("--max-iterations", c.options.max_iterations, "Of the eigensolver, and of each linear solve")
      ->check(cli::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--seed", c.options.seed, "Of the eigensolver's start")->capture_default_str();
  app.add_option("--partition", c.partition, "Who owns which vertices: scotch, or slices of the file as it is")
      ->check(cli::IsMember({"scotch", "slices"}))
      ->capture_default_str();
  app.add_option("--gather-below", c.options.gather_below,
                 "Components of up to so many vertices are solved by one rank")
      ->check(cli::Range(100, 1000000))
      ->capture_default_str();
  app.add_option("--threads", c.threads, "Threads per rank; 0 for all")
      ->check(cli::Range(0, 4096))
      ->capture_default_str();
  app.add_flag("--json", c.json, "Print the report as JSON on stdout, and nothing else there");
  app.add_flag("-q,--quiet", c.quiet, "No summary; errors still go to stderr");
}

void add_field_options(cli::App& app, Choice& c) {
  add_common_options(app, c);
  app.add_option("-n,-r,--degree,--rosy", c.options.n, "Symmetry: 1 vectors, 2 lines, 4 crosses; any n >= 1")
      ->check(cli::Range(1, 1000))
      ->capture_default_str();
  app.add_option("-s,--energy,--s", c.options.s,
                 "Which smoothness, in [-1, 1]: 0 Dirichlet, 1 favours holomorphic, -1 antiholomorphic fields")
      ->check(cli::Range(-1.0, 1.0))
      ->capture_default_str();
  ConnectionChoice& connection = c.options.connection;
  app.add_option_function<std::string>(
         "--connection",
         [&connection](const std::string& text) { connection = connection_choice(text).value(); },  // checked below
         "How the connection is built. trivial: flat but for the vertices given by --cone, indices multiples of 1/n; "
         "metric: cones of any size")
      ->check(cli::IsMember({"polar", "polar-barycenter", "local", "global", "trivial", "metric"}))
      ->type_name("KIND")
      ->default_str("global");
  add_cone_option(app, connection.kind, c.options.cones);
  add_turns_option(app, "--loop-index", connection.kind, c.options.loop_index, loop_index_help);
  app.add_option("--detail", c.options.global.detail, "Of the global connection: smaller ignores small bumps")
      ->check(cli::PositiveNumber)
      ->capture_default_str();
  app.add_option("--length-factor", c.length_factor, "Length factor of D_E")
      ->check(cli::IsMember({"mean_edge", "metric", "per_edge"}))
      ->capture_default_str();
  app.add_option("--tan-cap", c.options.global.tan_cap, "Cap of the tangents in D_E")
      ->check(cli::PositiveNumber)
      ->capture_default_str();
  app.add_option("--tolerance", c.options.tolerance, "Relative residual of the eigenvector, recomputed")
      ->check(cli::Range(1e-14, 0.1))
      ->capture_default_str();
  add_prove_option(app, c.options.prove_smallest);
}

void add_design_options(cli::App& app, Choice& c) {
  add_common_options(app, c);
  app.add_option("--design", c.design, "Design file; docs/design.md describes it")->required()->type_name("FILE");
  app.add_option("-n,-r,--degree,--rosy", c.options.n, "Degree, instead of the one in the design file")
      ->check(cli::Range(1, 1000));
  app.add_option("--tolerance", c.solve_tolerance, "Relative residual of linear solves, recomputed")
      ->check(cli::Range(1e-15, 0.1))
      ->capture_default_str();
  add_tolerance_options(app, c.tolerances);
  c.count = [&app](const char* option) { return app.get_option(option)->count(); };
}

/// FileErrors of outputs have a code of their own.
template <class Body>
void writing(Body&& body) {
  try {
    body();
  } catch (const FileError& e) {
    throw Failure(Exit::output, e.what(), file_details(e));
  }
}

void write_report(const std::filesystem::path& file, const Json& report) {
  writing([&] {
    on_first_rank([&] {
      detail::AtomicFile out(file);
      out.write(text_of(report, 2) + "\n");
      out.commit();
    });
  });
}

/// The files that are to be written, after making sure that they have a folder.
std::vector<std::filesystem::path> prepare_output(const Choice& c) {
  const std::filesystem::path output = c.output;
  if (output.empty()) return {};
  if (output.extension() == ".ply" || output.extension() == ".pvtp") return {output};
  writing([&] {
    on_first_rank([&] {
      std::error_code error;
      std::filesystem::create_directories(output, error);
      if (error || !std::filesystem::is_directory(output))
        throw FileError(output.string() + ": cannot make this folder (" + error.message() + ")", output.string());
      std::filesystem::remove(output / "report.json", error);
    });
  });
  std::vector<std::filesystem::path> files;
  for (const std::string& format : c.formats) files.push_back(output / ("field." + format));
  return files;
}

void write_fields(const std::vector<std::filesystem::path>& files, const MeshSlice& mesh, DistributedField& field) {
  for (const std::filesystem::path& file : files)
    writing([&] {
      (file.extension() == ".ply" ? write_distributed_ply : write_distributed_pvtp)(file.string(), mesh, field);
    });
}

/// Whether the output is a folder, with report.json and what else belongs to the fields.
bool in_folder(const Choice& c, const std::vector<std::filesystem::path>& files) {
  return !files.empty() && files[0] != std::filesystem::path(c.output);
}

void show(const Choice& c, const Json& report, const std::string& summary) {
  on_first_rank([&] {
    const std::string text = c.json ? text_of(report, 2) + "\n" : c.quiet ? "" : printable(summary);
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
      throw Failure(Exit::output, "cannot write to standard output");
  });
}

/// One line on stderr by rank 0; all ranks wait for it.
void say(const std::string& message) {
  on_first_rank([&] {
    const std::string line = "alcap-mpi: " + printable_line(message) + "\n";
    (void)std::fwrite(line.data(), 1, line.size(), stderr);
  });
}

int run_field_command(Choice& c) {
  c.options.global.length_factor = from_name<LengthFactor>(c.length_factor).value_or(LengthFactor::mean_edge);
  c.options.partition = from_name<PartitionMethod>(c.partition).value_or(PartitionMethod::scotch);
  const detail::Stopwatch watch;
  const MeshSlice mesh = read_mesh_slice(c.mesh);
  const double read_seconds = watch.seconds();
  const std::vector<std::filesystem::path> files = prepare_output(c);
  DistributedField field = distributed_field(mesh, c.options);
  write_fields(files, mesh, field);
  Json report = distributed_report(c.mesh, mesh, field, c.options);
  report["times"] = {{"read", read_seconds}, {"total", watch.seconds()}};
  if (in_folder(c, files)) write_report(std::filesystem::path(c.output) / "report.json", report);
  show(c, report, distributed_summary(report));
  if (report["ok"].get<bool>()) return static_cast<int>(Exit::ok);
  say(complaint("the certificate does not hold:", field.remarks));
  return static_cast<int>(Exit::uncertified);
}

int run_design_command(Choice& c) {
  const detail::Stopwatch watch;
  DesignFile asked;
  on_every_rank([&] { asked = read_design(c.design); });
  if (c.count("-n") > 0) asked.n = c.options.n;
  const MeshSlice mesh = read_mesh_slice(c.mesh);
  const double read_seconds = watch.seconds();
  const std::vector<std::filesystem::path> files = prepare_output(c);
  DistributedDesign design =
      distributed_design(mesh, asked,
                         {.tolerance = c.solve_tolerance,
                          .tolerances = c.tolerances,
                          .max_iterations = c.options.max_iterations,
                          .connection_tolerance = c.options.global.tolerance,
                          .connection_iterations = c.options.global.max_iterations,
                          .seed = c.options.seed,
                          .partition = from_name<PartitionMethod>(c.partition).value_or(PartitionMethod::scotch),
                          .gather_below = c.options.gather_below});
  write_fields(files, mesh, design);
  Json report = distributed_report(c.mesh, mesh, asked, design);
  report["times"] = {{"read", read_seconds}, {"total", watch.seconds()}};
  if (in_folder(c, files)) {
    writing([&] { on_first_rank([&] { write_design(std::filesystem::path(c.output) / "design.json", asked); }); });
    write_report(std::filesystem::path(c.output) / "report.json", report);
  }
  show(c, report, distributed_design_summary(report));
  if (!design.certificate.holds()) {
    say(complaint("the certificate does not hold:", design.remarks));
    return static_cast<int>(Exit::uncertified);
  }
  if (!design.met()) {
    say(complaint("the design is not met everywhere:", design.remarks));
    return static_cast<int>(Exit::unmet);
  }
  return static_cast<int>(Exit::ok);
}

/// Says what is wrong, with --json as an object on stdout as well.
int complain(const Choice& c, const char* command, Exit exit, const std::string& message,
             const Json& details = Json::object()) {
  say(message);
  on_first_rank([&] {
    if (!c.json) return;
    const std::string text = text_of(error_report(command, exit, message, details), 2) + "\n";
    (void)std::fwrite(text.data(), 1, text.size(), stdout);
    (void)std::fflush(stdout);
  });
  return static_cast<int>(exit);
}

/// What all ranks throw becomes an exit code.
template <class Body>
int guarded(const Choice& c, const char* command, Body&& body) {
  try {
    return body();
  } catch (const Failure& e) {
    return complain(c, command, e.exit(), in_flags(e.what()), e.details());
  } catch (const FileError& e) {
    return complain(c, command, Exit::input, e.what(), file_details(e));
  } catch (const MeshError& e) {
    return complain(c, command, Exit::mesh, in_flags(e.what()), mesh_details(e));
  } catch (const OptionError& e) {
    return complain(c, command, Exit::usage, e.what(),
                    {{"option", e.field()}, {"value", e.value()}, {"rule", e.rule()}});
  } catch (const SolveError& e) {
    return complain(c, command, Exit::solver, e.what());
  } catch (const std::bad_alloc&) {
    return complain(c, command, Exit::solver, "out of memory; use more ranks or machines with more memory");
  } catch (const std::exception& e) {
    return complain(c, command, Exit::internal, fmt::format("internal error, please report it: {}", e.what()));
  }
}

int start(int argc, char** argv) {
  cli::App app(description, "alcap-mpi");
  app.footer(footer);
  app.require_subcommand(0, 1);
  bool version_wanted = false;
  app.add_flag("--version", version_wanted, "Version");
  Choice choice;
  cli::App* field = app.add_subcommand("field", "The smoothest n-field, its file and its report");
  add_field_options(*field, choice);
  cli::App* design = app.add_subcommand("design", "The field of a variational design, its file and its report");
  add_design_options(*design, choice);
  const auto put = [](const std::string& text, std::FILE* to) {
    on_first_rank([&] {
      (void)std::fwrite(text.data(), 1, text.size(), to);
      (void)std::fflush(to);
    });
  };
  try {
    if (const auto help = app.parse(argc, argv)) {
      put(*help, stdout);
      return 0;
    }
  } catch (const cli::ParseError& e) {
    return complain(choice, "field", Exit::usage, fmt::format("{} (see alcap-mpi --help)", e.what()));
  }
  if (version_wanted) {
    put(fmt::format("alcap-mpi {}\n", version()), stdout);
    return 0;
  }
  if (!field->parsed() && !design->parsed()) {
    put(app.help(), stderr);
    return static_cast<int>(Exit::usage);
  }
  int code = 0;
  run_with_threads(choice.threads, [&] {
    code = design->parsed() ? guarded(choice, "design", [&] { return run_design_command(choice); })
                            : guarded(choice, "field", [&] { return run_field_command(choice); });
  });
  return code;
}

}  // namespace
}  // namespace alcap::app

int main(int argc, char** argv) {
  try {
    return alcap::app::start(argc, argv);
  } catch (const std::exception& e) {
    // Only this rank knows, and the others may wait for it.
    (void)std::fprintf(stderr, "alcap-mpi: internal error, please report it: %s\n", e.what());
    alcap::distributed_abort(static_cast<int>(alcap::app::Exit::internal));
  }
}
