// SPDX-License-Identifier: MIT
#include "src/distributed/design_loads.h"

#include <algorithm>

#include "src/base/array.h"
#include "src/design/file/problem.h"
#include "src/distributed/design_place.h"
#include "src/mesh/surface_points.h"

namespace alcap::detail::distributed {
namespace {

using Type = DesignOutcome::Type;

/// A control as plain numbers: every rank learns what the one that has it found.
struct PlainControl {
  std::size_t number;
  double angle, re, im;  // orientation of a target; value of a constraint
};

class Maker {
 public:
  Maker(const DesignFile& placed, const Stage& stage, const Frames& frames, const FirstOrderOperators& operators,
        double total_area)
      : placed_(placed), stage_(stage), patch_(stage.patch), frames_(frames), loads_{patch_.mesh,     patch_.V,
                                                                                     patch_.geometry, stage.connection,
                                                                                     operators,       placed.n,
                                                                                     total_area} {}

  [[nodiscard]] LocalControl singularity(std::size_t k) const {
    DesignSingularity s = placed_.singularities[k];
    LocalControl out{Type::singularity, path_of("singularities", k), label(s), {}, {}, {}, none};
    s.face = own_face(patch_, s.face);
    if (s.face == none) return out;
    const SingularityTarget target = target_of(s, out.path, patch_.mesh, patch_.V);
    out.here = target;
    out.component = stage_.components.of_vertex[at(patch_.mesh.F()(s.face, 0))];
    at_path(out.path, [&] { out.load = loads_(target); });
    return out;
  }

  [[nodiscard]] LocalControl fixed(std::size_t k) const {
    DesignFixed f = placed_.fixed[k];
    LocalControl out{Type::fixed, path_of("fixed", k), label(f), {}, {}, {}, none};
    f.vertex = own_vertex(patch_, f.vertex);
    if (f.vertex == none) return out;
    const VertexConstraint constraint = constraint_of(f, out.path, placed_.n, frames_);
    out.here = constraint;
    out.component = stage_.components.of_vertex[at(f.vertex)];
    at_path(out.path, [&] { out.load = loads_(constraint); });
    return out;
  }

  /// Every edge of the stroke by the rank that owns its smaller vertex.
  [[nodiscard]] LocalControl stroke(std::size_t k) const {
    const DesignStroke& s = placed_.strokes[k];
    LocalControl out{Type::stroke, path_of("strokes", k), label(s, k), {}, {}, {}, none};
    if (std::ranges::count(s.vertices, s.vertices[0]) == count_of(s.vertices))
      throw OptionError(out.path, "vertices " + std::to_string(s.vertices.size()) + " vertices",
                        "a stroke has at least two different ones");
    SurfacePolyline line;
    for (std::size_t i = 0; i + 1 < s.vertices.size(); ++i) {
      const Index a = s.vertices[i], b = s.vertices[i + 1];
      const Index here = own_vertex(patch_, std::min(a, b));
      if (a == b || here == none) continue;
      const Index e = edge_to(here, std::max(a, b));
      if (e == none)
        throw OptionError(out.path + "/vertices", std::to_string(a) + " and " + std::to_string(b),
                          "no edge joins these vertices; over several ranks no path between them is searched for");
      const Index h = patch_.mesh.halfedge(e);
      SurfacePoint tail = on_halfedge(h, 0), tip = on_halfedge(h, 1);
      if (patch_.vertex[at(patch_.mesh.tail(h))] != a) std::swap(tail, tip);
      append_segment(line, patch_.mesh, patch_.geometry, Mesh::face(h), tail.barycentric, tip.barycentric);
      out.component = stage_.components.of_vertex[at(here)];
    }
    at_path(out.path, [&] {
      for (const SurfaceSegment& segment : line.segments)
        out.load.rows.push_back(loads_.segment_row(segment, s.weight));
    });
    return out;
  }

  [[nodiscard]] LocalControl boundary() const {
    LocalControl out{Type::boundary, "/boundary", label(placed_.boundary), {}, {}, {}, none};
    if (patch_.empty()) return out;
    for (ControlRow& row : loads_.boundary_rows({.normal = placed_.boundary.normal, .weight = placed_.boundary.weight}))
      if (row.vertex[0] < patch_.owned) out.load.rows.push_back(row);
    return out;
  }

 private:
  /// The edge from an owned vertex to a user's.
  [[nodiscard]] Index edge_to(Index v, Index other) const {
    Index found = none;
    patch_.mesh.for_each_outgoing(v, [&](Index h) {
      const Index p = Mesh::prev(h);
      if (patch_.vertex[at(patch_.mesh.tip(h))] == other) found = patch_.mesh.edge(h);
      if (patch_.vertex[at(patch_.mesh.tail(p))] == other) found = patch_.mesh.edge(p);
    });
    return found;
  }

  const DesignFile& placed_;
  const Stage& stage_;
  const Patch& patch_;
  const Frames& frames_;
  ControlLoads loads_;
};

/// Tells all ranks what was asked for where it is known on one only.
void share_asked(const DesignFile& placed, std::vector<LocalControl>& controls) {
  std::vector<PlainControl> mine;
  for (std::size_t k = 0; k < controls.size(); ++k) {
    if (!controls[k].here) continue;
    if (const auto* target = std::get_if<SingularityTarget>(&*controls[k].here))
      mine.push_back({k, target->orientation, 0, 0});
    if (const auto* fixed = std::get_if<VertexConstraint>(&*controls[k].here))
      mine.push_back({k, 0, fixed->value.real(), fixed->value.imag()});
  }
  const std::size_t first_fixed = placed.singularities.size();
  for (const PlainControl& c : gather_all(mine)) {
    if (c.number < first_fixed) {
      const DesignSingularity& s = placed.singularities[c.number];
      controls[c.number].asked = SingularityTarget{.face = s.face,
                                                   .sign = index_of(s.kind),
                                                   .count = s.count,
                                                   .orientation = c.angle,
                                                   .strength = s.strength,
                                                   .pin = s.pin ? s.barycentric : std::nullopt};
    } else {
      const DesignFixed& f = placed.fixed[c.number - first_fixed];
      controls[c.number].asked =
          VertexConstraint{.vertex = f.vertex, .value = {c.re, c.im}, .direction_only = f.free_length};
    }
  }
}

}  // namespace

std::vector<LocalControl> local_controls(const DesignFile& placed, const Stage& stage, const Frames& frames,
                                         double total_area) {
  std::vector<LocalControl> controls;
  agreed([&] {
    FirstOrderOperators operators;
    if (!stage.patch.empty() && !placed.singularities.empty())
      operators = first_order_operators(stage.patch.mesh, stage.patch.geometry, stage.connection,
                                        {.n = placed.n, .kind = DesignerOptions().kind});
    const Maker maker(placed, stage, frames, operators, total_area);
    for (std::size_t k = 0; k < placed.singularities.size(); ++k) controls.push_back(maker.singularity(k));
    for (std::size_t k = 0; k < placed.fixed.size(); ++k) controls.push_back(maker.fixed(k));
    for (std::size_t k = 0; k < placed.strokes.size(); ++k) controls.push_back(maker.stroke(k));
    if (placed.boundary.wanted) controls.push_back(maker.boundary());
  });
  if (placed.boundary.wanted && !any(!controls.back().load.rows.empty()))
    throw OptionError("/boundary", "boundary none", "this mesh has no boundary to align with");
  share_asked(placed, controls);
  return controls;
}

}  // namespace alcap::detail::distributed
