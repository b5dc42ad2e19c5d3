// SPDX-License-Identifier: MIT
//
// designer.cpp: live designs of the C interface.
#include "alcap/designer.h"

#include "alcap/connected_surface.h"
#include "alcap/strokes.h"
#include "c/handles.h"

namespace alcap::c {
namespace {

Control control_of(const Surface& surface, const alcap_control* given) {
  require(given, "control");
  const alcap_control c = versioned(given, alcap_control(ALCAP_CONTROL_INIT), "control");
  switch (c.kind) {
    case ALCAP_SINGULARITY: {
      SingularityTarget target{.face = c.face, .sign = c.sign, .orientation = c.orientation, .strength = c.strength};
      if (c.pinned != 0) target.pin = {c.pin[0], c.pin[1], c.pin[2]};
      return target;
    }
    case ALCAP_VERTEX:
      return VertexConstraint{
          .vertex = c.vertex, .value = {c.value[0], c.value[1]}, .direction_only = c.direction_only != 0};
    case ALCAP_STROKE: {
      if (c.vertex_count < 2 || c.vertex_count > (std::int64_t{1} << 31))
        throw OptionError("vertex_count", c.vertex_count, "must be at least 2");
      require(c.vertices, "vertices");
      const std::vector<Index> path(c.vertices, c.vertices + c.vertex_count);
      return Stroke{.weight = c.weight, .line = stroke_along_vertices(surface, path), .radius = c.radius};
    }
    case ALCAP_BOUNDARY:
      return BoundaryAlignment{.normal = c.normal != 0, .weight = c.weight};
    default:
      throw OptionError("kind", c.kind, "is not a value of alcap_control_kind");
  }
}

std::unique_ptr<alcap_designer> make(const Surface& surface, const alcap_field_options& given, double weight) {
  auto out = std::make_unique<alcap_designer>();
  controlled(watch_of(given), [&] { out->surface = connect(surface, connection_of(given)); });
  out->designer = std::make_unique<Designer>(out->surface, DesignerOptions{.n = given.n,
                                                                           .guidance_weight = weight,
                                                                           .s = given.s,
                                                                           .solver = solver_of(given),
                                                                           .control = watch_of(given)});
  return out;
}

using Complexes = Eigen::Map<ComplexVectorX<double>>;
using ConstComplexes = Eigen::Map<const ComplexVectorX<double>>;

void solve(alcap_designer& d, double* u) {
  const DesignResult result = d.designer->solve();
  Complexes(reinterpret_cast<Complex<double>*>(u), result.field.u.size()) = result.field.u;
  d.reports.clear();
  for (const ControlReport& r : result.controls)
    d.reports.push_back({static_cast<std::int32_t>(r.id), r.met, r.index, 0, r.error_degrees});
}

}  // namespace
}  // namespace alcap::c

using alcap::ControlId;
using alcap::c::guarded;
using alcap::c::require;

extern "C" {

alcap_status alcap_designer_create(const alcap_surface* surface, const alcap_field_options* options,
                                   double guidance_weight, alcap_designer** designer, alcap_error* error) {
  return guarded(error, [&] {
    require(designer, "designer");
    *designer = nullptr;
    require(surface, "surface");
    *designer = alcap::c::make(surface->surface, alcap::c::options_of(options), guidance_weight).release();
  });
}

void alcap_designer_free(alcap_designer* designer) { delete designer; }

alcap_status alcap_designer_add(alcap_designer* d, const alcap_control* control, std::int32_t* id, alcap_error* error) {
  return guarded(error, [&] {
    require(d, "designer");
    require(id, "id");
    *id = static_cast<std::int32_t>(d->designer->add(alcap::c::control_of(d->surface, control)));
  });
}
alcap_status alcap_designer_set(alcap_designer* d, std::int32_t id, const alcap_control* control, alcap_error* error) {
  return guarded(error, [&] {
    require(d, "designer");
    d->designer->set(ControlId{id}, alcap::c::control_of(d->surface, control));
  });
}
alcap_status alcap_designer_remove(alcap_designer* d, std::int32_t id, alcap_error* error) {
  return guarded(error, [&] {
    require(d, "designer");
    d->designer->remove(ControlId{id});
  });
}
alcap_status alcap_designer_guidance(alcap_designer* d, const double* u0, alcap_error* error) {
  return guarded(error, [&] {
    require(d, "designer");
    require(u0, "u0");
    const auto* values = reinterpret_cast<const alcap::Complex<double>*>(u0);
    d->designer->set_guidance(alcap::c::ConstComplexes(values, d->surface.mesh().vertices()));
  });
}
alcap_status alcap_designer_solve(alcap_designer* d, double* u, alcap_error* error) {
  return guarded(error, [&] {
    require(d, "designer");
    require(u, "u");
    alcap::c::solve(*d, u);
  });
}
std::int64_t alcap_designer_report_count(const alcap_designer* d) {
  return d != nullptr ? static_cast<std::int64_t>(d->reports.size()) : 0;
}
const alcap_control_report* alcap_designer_reports(const alcap_designer* d) {
  return d != nullptr ? d->reports.data() : nullptr;
}
}
