// SPDX-License-Identifier: MIT
//
// run.cpp: whole runs of the C interface, with the report of the command line.
#include <limits>

#include "alcap/design_run.h"
#include "alcap/mesh_io.h"
#include "alcap/output.h"
#include "apps/alcap/report/design_report.h"
#include "apps/alcap/report/report.h"
#include "c/handles.h"

namespace alcap::c {
namespace {

std::vector<alcap_singularity> plain(const std::vector<Singularity>& list) {
  std::vector<alcap_singularity> out;
  for (const Singularity& s : list)
    out.push_back({s.face, s.index, {s.barycentric[0], s.barycentric[1], s.barycentric[2]}, s.orientation});
  return out;
}

alcap_certificate certificate(const auto& c, bool controls_met) {
  return {sizeof(alcap_certificate),
          c.holds(),
          c.connection_converged,
          c.eigen_converged,
          c.residual_small,
          c.index_sums_match,
          c.finite,
          controls_met};
}

std::string report(const FieldRun& run, const FieldRunOptions& options) {
  app::Json json = app::field_report({}, {}, run, options);
  json["input"] = nullptr;
  return app::text_of(json);
}

std::string report(const DesignRun& run, const DesignFile& asked) {
  std::vector<Remark> all = mesh_remarks(run.surface);
  all.insert(all.end(), run.remarks.begin(), run.remarks.end());
  return app::text_of(app::design_report(nullptr, asked, run, all));
}

std::unique_ptr<alcap_run> handle(auto run, bool controls_met, std::string text) {
  auto out = std::make_unique<alcap_run>();
  out->singularities = plain(run.singularities);
  out->certificate = certificate(run.certificate, controls_met);
  out->report = std::move(text);
  out->surface = std::move(run.surface);
  out->field = std::move(run.field);
  out->indices = std::move(run.indices);
  out->found = std::move(run.singularities);
  out->eigen = std::move(run.eigen);
  return out;
}

std::unique_ptr<alcap_run> field(const Surface& surface, const alcap_field_options& given) {
  FieldRunOptions options{.n = given.n,
                          .s = given.s,
                          .connection = connection_of(given),
                          .normalise = given.normalise != 0,
                          .control = watch_of(given)};
  options.eigen.solver = solver_of(given);
  if (given.tolerance != 0) options.eigen.tolerance = given.tolerance;
  if (given.max_iterations != 0) options.eigen.max_iterations = given.max_iterations;
  FieldRun run = run_field(surface, options);
  std::string text = report(run, options);
  return handle(std::move(run), true, std::move(text));
}

std::unique_ptr<alcap_run> design(const Surface& surface, const char* json, const alcap_field_options& given) {
  const DesignFile asked = parse_design(json);
  DesignRunOptions options{.solver = solver_of(given), .normalise = given.normalise != 0, .control = watch_of(given)};
  if (given.tolerance != 0) options.residual = given.tolerance;
  DesignRun run = run_design(surface, asked, options);
  std::string text = report(run, asked);
  const bool met = std::all_of(run.outcomes.begin(), run.outcomes.end(), [](const auto& o) { return o.met; });
  return handle(std::move(run), met, std::move(text));
}

double of_component(const alcap_run* run, std::int64_t component, double EigenReport::*member) {
  if (run == nullptr || component < 0 || component >= static_cast<std::int64_t>(run->eigen.size()))
    return std::numeric_limits<double>::quiet_NaN();
  return run->eigen[static_cast<std::size_t>(component)].*member;
}

}  // namespace
}  // namespace alcap::c

using alcap::c::guarded;
using alcap::c::options_of;
using alcap::c::require;

extern "C" {

alcap_status alcap_field_solve(const alcap_surface* surface, const alcap_field_options* options, alcap_run** run,
                               alcap_error* error) {
  return guarded(error, [&] {
    require(run, "run");
    *run = nullptr;
    require(surface, "surface");
    *run = alcap::c::field(surface->surface, options_of(options)).release();
  });
}

alcap_status alcap_design_solve(const alcap_surface* surface, const char* design, const alcap_field_options* options,
                                alcap_run** run, alcap_error* error) {
  return guarded(error, [&] {
    require(run, "run");
    *run = nullptr;
    require(surface, "surface");
    require(design, "design");
    *run = alcap::c::design(surface->surface, design, options_of(options)).release();
  });
}

void alcap_run_free(alcap_run* run) { delete run; }

std::int32_t alcap_run_n(const alcap_run* run) { return run != nullptr ? run->field.n : 0; }
const double* alcap_run_u(const alcap_run* run) {
  return run != nullptr ? reinterpret_cast<const double*>(run->field.u.data()) : nullptr;
}
const double* alcap_run_frames_X(const alcap_run* run) {
  return run != nullptr && run->field.frames ? run->field.frames->X.data() : nullptr;
}
const double* alcap_run_frames_N(const alcap_run* run) {
  return run != nullptr && run->field.frames ? run->field.frames->N.data() : nullptr;
}
alcap_status alcap_run_vectors(const alcap_run* run, std::int32_t k, double* vectors, alcap_error* error) {
  return guarded(error, [&] {
    require(run, "run");
    require(vectors, "vectors");
    const alcap::Positions<double> rows = run->field.vectors(k);
    std::copy_n(rows.data(), rows.size(), vectors);
  });
}
const std::int32_t* alcap_run_indices(const alcap_run* run) { return run != nullptr ? run->indices.data() : nullptr; }
std::int64_t alcap_run_singularity_count(const alcap_run* run) {
  return run != nullptr ? static_cast<std::int64_t>(run->singularities.size()) : 0;
}
const alcap_singularity* alcap_run_singularities(const alcap_run* run) {
  return run != nullptr ? run->singularities.data() : nullptr;
}
std::int64_t alcap_run_eigen_count(const alcap_run* run) {
  return run != nullptr ? static_cast<std::int64_t>(run->eigen.size()) : 0;
}
double alcap_run_lambda(const alcap_run* run, std::int64_t component) {
  return alcap::c::of_component(run, component, &alcap::EigenReport::lambda);
}
double alcap_run_residual(const alcap_run* run, std::int64_t component) {
  return alcap::c::of_component(run, component, &alcap::EigenReport::residual);
}
alcap_status alcap_run_certificate(const alcap_run* run, alcap_certificate* certificate, alcap_error* error) {
  return guarded(error, [&] {
    require(run, "run");
    alcap::c::fill(certificate, run->certificate, "certificate");
  });
}
const char* alcap_run_report(const alcap_run* run) { return run != nullptr ? run->report.c_str() : nullptr; }
alcap_status alcap_run_write(const alcap_run* run, const char* path, alcap_error* error) {
  return guarded(error, [&] {
    require(run, "run");
    require(path, "path");
    alcap::write_field({.surface = run->surface, .field = run->field, .singularities = run->found}, path);
  });
}
}
