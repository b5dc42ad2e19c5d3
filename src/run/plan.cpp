// SPDX-License-Identifier: MIT
//
// plan.cpp: the model behind alcap/plan.h. Constants per triangle are those of perf_plan and perf_backends, on jittered
// spheres, tori and scans of 20K to 21M triangles; docs/scale.md has the figures that they come from.
#include "alcap/plan.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <string>
#include <utility>

#include "alcap/field_run.h"
#include "alcap/generators.h"
#include "src/base/limits.h"
#include "src/base/parallel.h"

namespace alcap {
namespace plan_model {
namespace {

// CPU microseconds per triangle.
constexpr double read_us = 0.1, mesh_us = 0.45, connection_us = 2.0, assembly_us = 0.45, analysis_us = 0.3;
/// Eigenvalues of degree 1 are simple or nearly so; for higher degrees blocks of vectors are needed.
constexpr double eigen_us_simple = 2.2, eigen_us_block = 4.4;
/// CPU microseconds of the field that relative_speed() computes, per triangle, on that machine.
constexpr double reference_us = 5.9;
// Bytes per triangle while a phase runs, of everything that is alive then.
constexpr double read_bytes = 60, mesh_bytes = 165, connection_bytes = 620, analysis_bytes = 625;
constexpr double solve_bytes_simple = 640, solve_bytes_block = 700, hardest_bytes = 830;
constexpr double program_bytes = 25e6;
/// Of a Cholesky factor: bytes per row and doubling of the rows (nested dissection: n log n).
constexpr double factor_bytes = 110;
/// Two threads do 1.9 times the work of one. Memory bandwidth is what more than eight share; not measured.
constexpr double parallel_share = 0.95;
constexpr int most_useful_threads = 8;

/// Bytes and CPU microseconds per triangle, a constant and a part for every branch of the field.
struct Format {
  const char* name;
  double bytes, bytes_per_branch, us, us_per_branch;
};
constexpr Format formats[] = {
    {"ply", 69, 0, 0.04, 0}, {"vtp", 76, 12, 0.04, 0.01}, {"rosy", 59, 0, 0.19, 0}, {"rawfield", 0.5, 60, 0.05, 0.12}};

const Format& format_of(const std::string& name) {
  std::string known;
  for (const Format& f : formats) {
    if (name == f.name) return f;
    known += (known.empty() ? "" : ", ") + std::string(f.name);
  }
  throw OptionError("formats", "'" + name + "'", "has no model; there are " + known);
}

void validate(const PlanOptions& o) {
  constexpr std::int64_t sane = std::int64_t{1} << 50;
  if (o.faces < 1 || o.faces > sane) throw OptionError("faces", std::to_string(o.faces), "must be in [1, 2^50]");
  if (o.vertices < 0 || o.vertices > sane)
    throw OptionError("vertices", std::to_string(o.vertices), "must be in [0, 2^50]");
  if (o.n < 1) throw OptionError("n", o.n, "must be at least 1");
  if (o.threads < 0) throw OptionError("threads", o.threads, "must be at least 0");
  if (!(o.speed > 0) || !std::isfinite(o.speed)) throw OptionError("speed", o.speed, "must be positive and finite");
  if (o.memory < 0) throw OptionError("memory", std::to_string(o.memory), "must be at least 0");
}

/// 0 where the system does not say.
double free_memory() {
  std::ifstream in("/proc/meminfo");
  for (std::string word; in >> word;) {
    if (word != "MemAvailable:") continue;
    double kilobytes = 0;
    in >> kilobytes;
    return 1024 * kilobytes;
  }
  return 0;
}

void count(const PlanOptions& o, std::int64_t vertices, RunPlan& plan) {
  plan.halfedges = 3 * o.faces;
  plan.edges = (plan.halfedges + 1) / 2;  // of a closed surface; a boundary of b edges adds b / 2
  plan.matrix_entries = vertices + 2 * plan.edges;
  const auto refuse = [&](std::int64_t number, const char* what, std::int64_t most) {
    if (number > most)
      plan.refusals.push_back(std::to_string(number) + " " + what + " are more than the " + std::to_string(most) +
                              " that " + std::to_string(detail::index_digits + 1) + "-bit indices can number");
  };
  refuse(o.faces, "faces", detail::most_faces);
  refuse(vertices, "vertices", detail::most_faces);
  refuse(plan.matrix_entries, "matrix entries", detail::most_entries);
}

void add_phases(const PlanOptions& o, RunPlan& plan) {
  const int threads = std::min(o.threads > 0 ? o.threads : thread_limit(), most_useful_threads);
  const double share = threads > 1 ? parallel_share * threads : 1;
  const auto faces = static_cast<double>(o.faces);
  const auto add = [&](const char* name, double us, double bytes, double disk, double at_once) {
    plan.phases.push_back({name, 1e-6 * us * faces / (o.speed * at_once), program_bytes + bytes * faces, disk * faces});
  };
  double written = 0;
  double write_us = 0;
  for (const std::string& name : o.formats) {
    const Format& f = format_of(name);
    written += f.bytes + o.n * f.bytes_per_branch;
    write_us += f.us + o.n * f.us_per_branch;
  }
  add("read", read_us, read_bytes, 0, share);
  add("mesh", mesh_us, mesh_bytes, 0, share);
  add("connection", connection_us, connection_bytes, 0, share);
  add("solve", assembly_us + (o.n == 1 ? eigen_us_simple : eigen_us_block),
      o.n == 1 ? solve_bytes_simple : solve_bytes_block, 0, share);
  add("analysis", analysis_us, analysis_bytes, 0, share);
  add("write", write_us, analysis_bytes, written, 1);
  for (const PhasePlan& phase : plan.phases) {
    plan.seconds += phase.seconds;
    plan.bytes = std::max(plan.bytes, phase.bytes);
    plan.disk += phase.disk;
  }
}

}  // namespace
}  // namespace plan_model

RunPlan plan_field(const PlanOptions& options) {
  using namespace plan_model;
  validate(options);
  RunPlan plan{};
  const std::int64_t vertices = options.vertices > 0 ? options.vertices : options.faces / 2 + 2;
  count(options, vertices, plan);
  add_phases(options, plan);
  const auto rows = static_cast<double>(vertices);
  plan.most_bytes = program_bytes + hardest_bytes * static_cast<double>(options.faces);
  plan.factor_bytes = factor_bytes * rows * std::log2(rows);
  plan.memory = options.memory > 0 ? static_cast<double>(options.memory) : free_memory();
  if (plan.memory > 0) {
    const double fit = std::max(0.0, (plan.memory - program_bytes) / hardest_bytes);
    // 3.5 entries per triangle of a closed surface.
    constexpr std::int64_t numbered = detail::most_entries / 7 * 2;
    plan.largest = std::min(static_cast<std::int64_t>(fit), numbered);
  }
  plan.factor_fits = plan.fits() && (plan.memory <= 0 || plan.most_bytes + plan.factor_bytes <= plan.memory);
  return plan;
}

double relative_speed() {
  const MeshData surface = jittered_sphere(5, 0.2, 1);
  double best = HUGE_VAL;
  for (int k = 0; k < 2; ++k) {
    const std::clock_t start = std::clock();
    static_cast<void>(run_field(surface.V, surface.F,
                                {.n = 4, .eigen = {.prove_smallest = Prove::never}, .control = {.threads = 1}}));
    best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  const double reference = 1e-6 * plan_model::reference_us * static_cast<double>(surface.F.rows());
  return reference / std::max(best, 1e-6);
}

}  // namespace alcap
