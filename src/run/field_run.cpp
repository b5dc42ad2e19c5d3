// SPDX-License-Identifier: MIT
//
// field_run.cpp: the steps of a run in order, with times, remarks and the certificate.
#include "alcap/field_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "alcap/mesh_check.h"
#include "solvers/eigenpair/problem.h"
#include "src/base/cancel.h"
#include "src/base/clock.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/mesh/near_vertices.h"
#include "src/run/field_aligned.h"
#include "src/run/field_intrinsic.h"
#include "src/run/intrinsic_solve.h"
#include "src/run/remarks.h"

namespace alcap {
namespace {

using detail::counted;

constexpr std::size_t most_named = 8;

// Corners below this angle are slivers worth a remark: their cotangents are beyond 500 and the solver's matrices feel
// it.
constexpr double sliver_angle = 0.002;

// Boundary vertices this close, in diagonals of the box, may have been one before single precision or a jitter.
constexpr double near_coincident = 1e-6;

void remark_unreferenced(const Mesh& mesh, std::vector<Remark>& remarks) {
  const std::int64_t count = mesh.vertices() - mesh.referenced_vertices();
  if (count == 0) return;
  Remark remark{.code = "unreferenced_vertices", .count = count};
  for (Index v = 0; v < mesh.vertices() && remark.first.size() < most_named; ++v) {
    if (!mesh.referenced(v)) remark.first.push_back(v);
  }
  remark.message = counted(count, "vertex is", "vertices are") + " used by no face; the field is zero there";
  remarks.push_back(std::move(remark));
}

/// Whether welding within this part of the size gives a mesh that can be used and joins pieces, not corners alone.
bool welding_helps(const Surface& surface, double tolerance) {
  const RepairedMesh welded =
      repair_mesh(surface.V(), surface.F(), {.repairs = {Repair::weld}, .weld_tolerance = tolerance});
  return find_defects(welded.F, welded.V.rows()).empty() && find_defects(welded.V, welded.F).empty() &&
         Mesh(welded.F, welded.V.rows()).boundary_edges() < surface.mesh().boundary_edges();
}

// Only boundary vertices can be where two pieces should have been one.
void remark_separate_pieces(const Surface& surface, std::vector<Remark>& remarks) {
  const Mesh& mesh = surface.mesh();
  if (mesh.boundary_edges() == 0 || !surface.in_space()) return;
  std::vector<Index> rim;
  for (Index v = 0; v < mesh.vertices(); ++v) {
    if (mesh.boundary_vertex(v)) rim.push_back(v);
  }
  Positions<double> points(static_cast<Eigen::Index>(rim.size()), 3);
  for (std::size_t k = 0; k < rim.size(); ++k) points.row(static_cast<Eigen::Index>(k)) = surface.V().row(rim[k]);
  const std::int64_t same = duplicate_positions(points);
  std::int64_t near = 0;
  if (same == 0) {
    const std::vector<Index> first = detail::first_near(points, near_coincident * detail::box_diagonal(surface.V()));
    for (std::size_t k = 0; k < first.size(); ++k) near += first[k] == static_cast<Index>(k) ? 0 : 1;
  }
  if (same + near == 0) return;
  const auto pieces = static_cast<std::int64_t>(surface.topology().components.size());
  const char* const where = same > 0 ? " exactly where another one does" : " within 1e-6 of the size of another one";
  std::string message = counted(same + near, "boundary vertex lies", "boundary vertices lie") + where +
                        ", but the faces do not share them; the mesh is taken as " +
                        counted(pieces, "piece", "separate pieces");
  if (welding_helps(surface, same > 0 ? 0 : near_coincident))
    message += same > 0 ? "; join them with Repair::weld" : "; join them with Repair::weld:1e-6";
  remarks.push_back({.code = same > 0 ? "separate_pieces" : "near_pieces", .message = message, .count = same + near});
}

void remark_slivers(const Surface& surface, std::vector<Remark>& remarks) {
  const Mesh& mesh = surface.mesh();
  const Geometry& geometry = surface.geometry();
  const double least = parallel_reduce(
      geometry.angles().size(), pi<double>,
      [&](std::int64_t begin, std::int64_t end) { return geometry.angles().segment(begin, end - begin).minCoeff(); },
      [](double a, double b) { return std::min(a, b); });
  if (least >= sliver_angle) return;
  Remark remark{.code = "slivers", .warning = false};
  for (Index t = 0; t < mesh.faces(); ++t) {
    const double smallest = geometry.angles().segment<3>(3 * Eigen::Index{t}).minCoeff();
    if (smallest >= sliver_angle) continue;
    if (static_cast<std::size_t>(remark.count++) < most_named) remark.first.push_back(t);
  }
  remark.message = counted(remark.count, "face has", "faces have") +
                   " a corner below 0.1 degrees; the result holds, solving takes longer";
  remarks.push_back(std::move(remark));
}

/// From the worst to the best.
Smallest least_known(const std::vector<EigenReport>& reports) {
  for (const Smallest s : {Smallest::refuted, Smallest::not_checked, Smallest::searched})
    if (std::any_of(reports.begin(), reports.end(), [s](const EigenReport& e) { return e.smallest == s; })) return s;
  return reports.empty() ? Smallest::not_checked : Smallest::proven;
}

/// The largest angle, if there is one of every component, and the least that any of them rests on.
void judge_angles(const std::vector<EigenReport>& reports, Certificate& certificate) {
  if (reports.empty()) return;
  certificate.angle = 0;
  certificate.angle_check = AngleCheck::bounded;
  for (const EigenReport& e : reports) {
    if (certificate.angle && e.angle)
      certificate.angle = std::max(*certificate.angle, *e.angle);
    else
      certificate.angle.reset();
    certificate.angle_check = std::min(certificate.angle_check, e.angle_check);
  }
}

Certificate certify(const FieldRun& run, const FieldRunOptions& options) {
  Certificate certificate;
  certificate.connection_converged =
      run.connection().report.converged && (!run.triangulation || run.triangulation->connection.converged);
  certificate.eigen_converged =
      std::all_of(run.eigen.begin(), run.eigen.end(), [](const EigenReport& e) { return e.converged; });
  certificate.residual_small = std::all_of(run.eigen.begin(), run.eigen.end(),
                                           [&](const EigenReport& e) { return within_tolerance(e, options.eigen); });
  certificate.smallest = least_known(run.eigen);
  judge_angles(run.eigen, certificate);
  certificate.index_sums_match =
      std::all_of(run.index_sums.begin(), run.index_sums.end(), [](const IndexSum& i) { return i.sum == i.expected; });
  certificate.finite = parallel_reduce(
      run.field.u.size(), true,
      [&](std::int64_t begin, std::int64_t end) { return run.field.u.segment(begin, end - begin).allFinite(); },
      [](bool a, bool b) { return a && b; });
  return certificate;
}

void say(const FieldRunOptions& options, const char* phase) {
  if (options.progress) options.progress(phase);
  detail::report_phase(phase);
}

/// Connection and field, on the triangles of the mesh.
void solve_on_mesh(const FieldRunOptions& options, const Surface& surface, FieldRun& run) {
  detail::Stopwatch watch;
  ConnectionOptions connection = options.connection;
  connection.n = options.n;
  run.surface = connect(surface, connection);
  run.times.connection = watch.lap();

  say(options, "solve");
  if (options.align) {
    detail::solve_aligned(options, run.surface, detail::features_of(options, run.surface), 1, run);
    return;
  }
  const SmoothestOptions smooth{.n = options.n, .s = options.s, .eigen = options.eigen};
  SmoothestResult result = smoothest_field(run.surface, smooth);
  run.field = std::move(result.field);
  run.eigen = std::move(result.components);
  if (options.modes > 1) run.modes = smoothest_modes(run.surface, options.modes, smooth);
  run.times.assembly = result.assembly_seconds;
  run.times.eigen = result.eigen_seconds + run.modes.seconds;
}

/// Solves on an intrinsic triangulation where that is wanted and works. Where it was not asked for by name and the
/// solvers fail on it, all is as before, and the run says so.
bool solved_on_intrinsic(const FieldRunOptions& options, const Surface& surface, FieldRun& run) {
  if (!detail::wants_intrinsic(surface, options.triangulation, options.connection)) return false;
  FieldRun before = run;
  const bool by_name = options.triangulation == Triangulation::intrinsic;
  try {
    const std::optional<double> connecting = detail::solve_on_intrinsic(options, surface, run);
    const bool converged = std::ranges::all_of(run.eigen, &EigenReport::converged);
    if (connecting && (converged || by_name)) {
      run.times.connection = *connecting;
      return true;
    }
  } catch (const SolveError&) {
    if (by_name) throw;
  }
  run = std::move(before);
  run.remarks.push_back(detail::own_triangles());
  return false;
}

/// Everything after the mesh.
void compute(const FieldRunOptions& options, FieldRun& run, detail::Stopwatch& watch, const Surface& surface) {
  for (Remark& remark : mesh_remarks(surface)) {
    const bool free_boundary = remark.code == "boundary";
    if (!(free_boundary && options.align && options.align->features.boundary)) run.remarks.push_back(std::move(remark));
  }
  run.times.mesh = watch.lap();

  say(options, "connection");
  if (!solved_on_intrinsic(options, surface, run)) solve_on_mesh(options, surface, run);
  const double solved = run.times.connection + run.times.assembly + run.times.eigen;
  const double frames = std::max(0.0, watch.lap() - solved);

  say(options, "analysis");
  run.indices = face_indices(run.surface, run.field);
  run.index_sums = index_sums(run.surface, run.field, run.indices);
  run.singularities = find_singularities(run.surface, run.field, run.indices);
  run.certificate = certify(run, options);
  if (run.features) detail::judge_aligned(options, run);
  if (run.triangulation) detail::remark_triangulation(*run.triangulation, run.singularities.size(), run.remarks);
  const Connection& connection = run.connection();
  const SolvedTriangulation* const other = run.triangulation ? &*run.triangulation : nullptr;
  detail::outcome_remarks(
      {.connection = other ? other->connection : connection.report,
       .parallel = other ? other->parallel : !connection.flat || connection.admits_parallel(options.n),
       .n = options.n,
       .eigen = run.eigen,
       .reached = [&](const EigenReport& e) { return within_tolerance(e, options.eigen); },
       .index_sums = run.index_sums,
       .finite = run.certificate.finite},
      run.remarks);
  if (options.normalise) run.field = normalised(std::move(run.field));
  run.times.analysis = frames + watch.lap();
}

/// A run under the control asked for, of the surface that `make` returns.
template <class Make>
FieldRun run_on(const FieldRunOptions& options, Make&& make) {
  if (options.modes < 1) throw OptionError("modes", options.modes, "must be at least 1");
  if (options.threads < 0 || options.threads > most_threads)
    throw OptionError("threads", options.threads, "must be 0 (all of the machine) or 1 to 4096");
  RunControl control = options.control;
  if (options.threads > 0) control.threads = options.threads;
  FieldRun run;
  controlled(control, [&] {
    const detail::ControlScope eigen(options.eigen.cancel);
    detail::Stopwatch watch;
    say(options, "mesh");
    compute(options, run, watch, make(run.remarks));
  });
  return run;
}

}  // namespace

std::vector<Remark> mesh_remarks(const Surface& surface) {
  const Topology& topology = surface.topology();
  std::vector<Remark> remarks;
  remark_unreferenced(surface.mesh(), remarks);
  remark_separate_pieces(surface, remarks);
  remark_slivers(surface, remarks);
  if (!topology.loops.empty()) {
    remarks.push_back(
        {.code = "boundary",
         .warning = false,
         .message = "the surface has " +
                    counted(static_cast<std::int64_t>(topology.loops.size()), "boundary loop", "boundary loops") +
                    "; a field that is not aligned with it is free there (natural boundary condition)",
         .count = static_cast<std::int64_t>(topology.loops.size())});
  }
  if (topology.components.size() > 1) {
    remarks.push_back({.code = "components",
                       .warning = false,
                       .message = "the mesh has " + std::to_string(topology.components.size()) +
                                  " components; each is solved on its own",
                       .count = static_cast<std::int64_t>(topology.components.size())});
  }
  return remarks;
}

FieldRun run_field(const Surface& surface, const FieldRunOptions& options) {
  if (!options.repairs.empty())
    throw OptionError("repairs", std::to_string(options.repairs.size()) + " repairs",
                      "work on points and triangles, before a surface is made of them");
  return run_on(options, [&](std::vector<Remark>&) { return surface; });
}

FieldRun detail::run_field(Positions<double> V, Faces F, const FieldRunOptions& options) {
  std::vector<Index> copies_of, face_of;
  FieldRun run = run_on(options, [&](std::vector<Remark>& remarks) {
    RepairedSurface repaired = repaired_surface(std::move(V), std::move(F),
                                                {.repairs = options.repairs, .weld_tolerance = options.weld_tolerance});
    for (Remark& r : repaired.remarks) remarks.push_back(std::move(r));
    copies_of = std::move(repaired.copies_of);
    face_of = std::move(repaired.face_of);
    return std::move(repaired.surface);
  });
  run.copies_of = std::move(copies_of);
  run.face_of = std::move(face_of);
  return run;
}

}  // namespace alcap
