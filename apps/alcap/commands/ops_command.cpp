// SPDX-License-Identifier: MIT
//
// ops_command.cpp: `alcap ops`, derivatives and energies of a field in a file.
#include <fmt/core.h>

#include <memory>
#include <string_view>

#include "alcap/energies.h"
#include "alcap/memory.h"
#include "alcap/operators.h"
#include "alcap/output.h"
#include "apps/alcap/commands/commands.h"
#include "apps/alcap/options/cli.h"
#include "apps/alcap/options/shared_options.h"
#include "apps/alcap/report/outputs.h"
#include "apps/alcap/report/report.h"
#include "src/base/atomic_file.h"
#include "src/base/clock.h"

namespace alcap::app {
namespace ops_parts {
namespace {

constexpr const char* footer =
    "Examples:\n"
    "  alcap field bunny.ply -n 1 -o v.ply\n"
    "  alcap ops bunny.ply v.ply -o v.csv            a line per face\n"
    "  alcap ops bunny.ply v.ply -o v.vtp            face data for ParaView\n"
    "  alcap ops bunny.ply v.ply --operators triangle --density --json\n"
    "\n"
    "FIELD is a .ply written by alcap field. Values are integrals over each face unless --density is given. For an\n"
    "n-field, (div, curl) is an (n-1)-vector and the reflected pair an (n+1)-vector in the face's frame, whose\n"
    "first axis is the face's first edge.";

struct OpsOptions {
  MeshChoice mesh = {};
  ConnectionOptions connection = {};
  std::filesystem::path field = {};
  std::filesystem::path output = {};
  OperatorKind kind = OperatorKind::edge;  // more accurate, and exact over patches
  bool density = false;
  cli::App* app = nullptr;  // to see which options were given
};

/// Four integrals per face.
struct FaceValues {
  VectorX<double> div, curl, reflected_div, reflected_curl;
};

/// A field on the surface with the connection that it is looked at with.
struct Loaded {
  MeshFile file;  // its points and faces are in the surface
  ConnectedSurface surface;
  Field field;
  ConnectionOptions how;
  std::vector<Remark> remarks;
};

/// The field in the file's mesh must be a field on this mesh.
void check_same_mesh(const OpsOptions& options, const Surface& surface, const FieldFile& field) {
  const Positions<double>& V = surface.V();
  const Faces& F = surface.F();
  const bool same = V.rows() == field.V.rows() && F.rows() == field.F.rows();
  if (same && (V - field.V).cwiseAbs().maxCoeff() <= 1e-6 * V.cwiseAbs().maxCoeff()) return;
  throw Failure(
      Exit::input,
      fmt::format("{} holds a field on another mesh ({} vertices, {} faces) than {} ({}, {}); give the mesh it "
                  "was computed on",
                  options.field.string(), field.V.rows(), field.F.rows(), options.mesh.path.string(), V.rows(),
                  F.rows()),
      {{"path", options.field.string()}});
}

void write_csv(const std::filesystem::path& path, const Geometry& geometry, const FaceValues& values) {
  alcap::detail::AtomicFile out(path);
  out.write("face,area,div,curl,reflected_div,reflected_curl\n");
  for (Eigen::Index t = 0; t < values.div.size(); ++t) {
    out.write(fmt::format("{},{},{},{},{},{}\n", t, geometry.areas()[t], values.div[t], values.curl[t],
                          values.reflected_div[t], values.reflected_curl[t]));
  }
  out.commit();
}

/// Norm of a density over the surface from face integrals: sqrt(sum of |x|^2 / A).
double norm(const VectorX<double>& integrals, const VectorX<double>& areas) {
  return std::sqrt((integrals.array().square() / areas.array()).sum());
}

std::string summary(const Json& report) {
  const auto real = [](const Json& value) {
    return value.is_null() ? std::string("not finite") : fmt::format("{:.6g}", value.get<double>());
  };
  const Json &e = report["energies"], &n = report["norms"], &sums = report["sums"];
  std::string text;
  const auto line = [&](const char* label, const std::string& value) { text += summary_line(label, value); };
  line("field",
       fmt::format("n = {} on {} faces, {} operators", report["n"].get<int>(),
                   grouped(report["mesh"]["faces"].get<std::int64_t>()), report["operators"].get<std::string>()));
  line("energies", fmt::format("E_D {}, E_A {}, E_H {}, (E_A - E_H) / pi {}", real(e["E_D"]), real(e["E_A"]),
                               real(e["E_H"]), real(e["difference_over_pi"])));
  line("by operators", fmt::format("E_D {}, E_A {}, E_H {}, (E_A - E_H) / pi {}", real(e["operators"]["E_D"]),
                                   real(e["operators"]["E_A"]), real(e["operators"]["E_H"]),
                                   real(e["operators"]["difference_over_pi"])));
  line("L2 norms",
       fmt::format("div {}, curl {}, reflected pair {}", real(n["div"]), real(n["curl"]), real(n["reflected"])));
  line("sums", fmt::format("div {}, curl {}", real(sums["div"]), real(sums["curl"])));
  for (const Json& w : report["warnings"]) line("warning", w["message"].get<std::string>());
  for (const Json& f : report["files"]) line("wrote", f.get<std::string>());
  return text;
}

Json energies_json(double dirichlet, double a, double h) {
  return {{"E_D", number(dirichlet)},
          {"E_A", number(a)},
          {"E_H", number(h)},
          {"difference_over_pi", number((a - h) / pi<double>)}};
}

/// The connection to take derivatives with: as asked, or else the one that the field was made with.
ConnectionOptions choose_connection(const OpsOptions& options, const FieldFile& file) {
  if (connection_lost(*options.app, file)) {
    throw Failure(Exit::usage,
                  "the file does not hold all of the " + std::string(name(file.connection)) +
                      " connection that the field was made with; repeat its --cone or --target options here",
                  {{"option", "--cone"}});
  }
  return connection_for(*options.app, options.connection, file);
}

Loaded load(const OpsOptions& options, Progress& progress) {
  Loaded out;
  progress.phase("reading");
  out.file = read_choice(options.mesh);
  const FieldFile field = read_field(options.field);
  const Surface surface = make_surface(options.mesh, out.file, out.remarks);
  check_same_mesh(options, surface, field);
  out.how = choose_connection(options, field);

  progress.phase("finding the connection");
  out.surface = connect(surface, out.how);
  if (!(*field.field.frames == *out.surface.frames())) {
    out.remarks.push_back(
        {.code = "reprojected",
         .warning = false,
         .message = "the field was made with another connection; its vectors were projected to this one"});
  }
  out.field = on_frames(field.field, out.surface.frames());
  return out;
}

void add_values(Json& report, const FaceValues& values, const VectorX<double>& reflected,
                const VectorX<double>& areas) {
  report["sums"] = {{"div", number(values.div.sum())}, {"curl", number(values.curl.sum())}};
  report["norms"] = {{"div", number(norm(values.div, areas))},
                     {"curl", number(norm(values.curl, areas))},
                     {"reflected", number(norm(reflected, areas))}};
}

std::vector<std::string> write_values(const std::filesystem::path& target, const Loaded& loaded,
                                      const FaceValues& values) {
  std::vector<std::string> files;
  write_guarded([&] {
    if (target.extension() == ".csv") {
      write_csv(target, loaded.surface.geometry(), values);
      files.push_back(target.string());
      return;
    }
    const auto scalars = [](const char* label, const VectorX<double>& x) {
      return FaceScalars{label, {x.data(), static_cast<std::size_t>(x.size())}};
    };
    const std::vector<FaceScalars> all{scalars("div", values.div), scalars("curl", values.curl),
                                       scalars("reflected_div", values.reflected_div),
                                       scalars("reflected_curl", values.reflected_curl)};
    const std::vector<Singularity> singularities = find_singularities(loaded.surface, loaded.field);
    const FieldOutput output{
        .surface = loaded.surface, .field = loaded.field, .singularities = singularities, .face_scalars = all};
    for (const auto& path : write_field(output, target)) files.push_back(path.string());
  });
  return files;
}

Outcome run(const OpsOptions& options, const Common& common, Progress& progress) {
  const detail::Stopwatch watch;
  const OutputPlan plan = plan_output(options.output, {".csv", ".vtp"});
  if (plan.kind == OutputPlan::Kind::folder) {
    throw Failure(Exit::usage, "-o must name a file that ends with .csv or .vtp", {{"option", "-o"}});
  }
  check_distinct({{"-o", plan.target}, {"--report", common.report}},
                 {{"mesh", options.mesh.path}, {"field", options.field}});
  const Loaded loaded = load(options, progress);
  const auto& [file, surface, field, how, remarks] = loaded;

  progress.phase("applying the operators");
  const auto operators = first_order_operators(surface, {.n = field.n, .kind = options.kind});
  const ComplexVectorX<double> p = apply(surface.mesh(), operators.p, field.u);
  const ComplexVectorX<double> q = apply(surface.mesh(), operators.q, field.u);
  FaceValues values{p.real(), p.imag(), q.real(), q.imag()};
  const FieldEnergies exact = field_energies(surface, field.n, field.u);
  const OperatorEnergies sums = operator_energies(surface, operators, field.u);

  Json report = report_head("ops", true);
  report["input"] = input_json(options.mesh.path, file);
  report["field"] = options.field.string();
  report["n"] = field.n;
  report["operators"] = options.kind == OperatorKind::edge ? "edge" : "triangle";
  report["mesh"] = mesh_json(surface);
  report["connection"] = connection_json(surface, how);
  report["energies"] = energies_json(exact.dirichlet, exact.antiholomorphic, exact.holomorphic);
  report["energies"]["operators"] = energies_json(sums.dirichlet(), sums.antiholomorphic, sums.holomorphic);
  add_values(report, values, q.cwiseAbs(), surface.geometry().areas());
  report["warnings"] = remarks_json(remarks, true);
  report["notes"] = remarks_json(remarks, false);

  if (options.density) {
    for (VectorX<double>* x : {&values.div, &values.curl, &values.reflected_div, &values.reflected_curl}) {
      x->array() /= surface.geometry().areas().array();
    }
  }
  std::vector<std::string> files;
  if (plan.kind == OutputPlan::Kind::file) {
    progress.phase("writing");
    files = write_values(plan.target, loaded, values);
  }
  report["times"] = {{"total", watch.seconds()}};
  report["peak_memory_bytes"] = peak_memory_bytes();
  report["files"] = files;
  Outcome outcome{.report = std::move(report)};
  outcome.text = summary(outcome.report);
  return outcome;
}

std::function<Outcome(const Common&, Progress&)> attach(cli::App& app) {
  auto options = std::make_shared<OpsOptions>();
  app.footer(footer);
  add_mesh_options(app, options->mesh);
  add_lengths_option(app, options->mesh);
  app.add_option("field", options->field, "Field on it: a .ply written by alcap field")->required()->type_name("FIELD");
  app.add_option("-o,--output", options->output, "Write a value per face to this .csv or .vtp")->type_name("FILE");
  app.add_option_function<std::string>(
         "--operators",
         [options](const std::string& name) {
           options->kind = name == "edge" ? OperatorKind::edge : OperatorKind::triangle;
         },
         "edge: from the boundary of each face (Stokes), sums telescope; triangle: from its inside")
      ->type_name("KIND")
      ->check(cli::IsMember({"edge", "triangle"}))
      ->default_str("edge");
  app.add_flag("--density", options->density, "Means per unit of area instead of integrals in the file");
  add_connection_options(app, options->connection);
  options->app = &app;
  return [options](const Common& common, Progress& progress) { return run(*options, common, progress); };
}

}  // namespace
}  // namespace ops_parts

const Command ops_command{"ops", "Divergence, curl, reflected pair and energies of a field", true, &ops_parts::attach};

}  // namespace alcap::app
