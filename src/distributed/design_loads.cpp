// SPDX-License-Identifier: MIT
#include "src/distributed/design_loads.h"

#include <algorithm>
#include <exception>

#include "src/base/array.h"
#include "src/curves/strokes/trace.h"
#include "src/design/file/problem.h"
#include "src/distributed/design_place.h"
#include "src/distributed/region.h"
#include "src/mesh/surface_points.h"

namespace alcap::detail::distributed {
namespace {

using Type = DesignOutcome::Type;

/// A control as plain numbers: every rank learns what the one that has it found.
struct PlainControl {
  std::size_t number;
  double angle, re, im;  // orientation of a target; value of a constraint
};

/// What is found by walking over the surface, by all ranks together; faces are the user's.
struct Walked {
  /// Of each singularity with several zeros: those, and the target on every rank.
  std::vector<std::vector<SingularityPart>> parts;
  std::vector<SingularityTarget> targets;
  std::vector<double> areas;           ///< of their targets' faces
  std::vector<SurfacePolyline> lines;  ///< of each stroke through points
};

/// The zeros of singularity k, in a region that grows until the walk does not leave it.
void find_zeros(const DesignFile& placed, const Patch& patch, std::size_t k, Walked& walked) {
  const DesignSingularity& s = placed.singularities[k];
  const std::string path = path_of("singularities", k);
  constexpr int first_rings = 16;
  for (int rings = first_rings;; rings *= 2) {
    const Region region = gather_region(patch, faces_near(patch, {s.face}, rings));
    DesignSingularity here = s;
    here.face = region.find(s.face);
    SingularityTarget target = target_of(here, path, region.mesh, region.V);
    bool left = false;
    std::vector<SingularityPart> parts;
    std::exception_ptr failed;
    try {
      at_path(path, [&] {
        check_target(region.mesh, target);
        parts = singularity_parts(region.mesh, region.geometry, placed.n, target,
                                  [&](Index t) { left = left || region.torn[at(t)] != 0; });
      });
    } catch (const OptionError&) {
      failed = std::current_exception();
    }
    if (left) continue;
    if (failed) std::rethrow_exception(failed);
    for (SingularityPart& part : parts) part.face = region.face[at(part.face)];
    walked.areas[k] = region.geometry.area(target.face);
    target.face = s.face;
    walked.targets[k] = target;
    walked.parts[k] = std::move(parts);
    return;
  }
}

/// The component of each of these faces of the user's.
std::vector<Index> components_of(const Stage& stage, const std::vector<Index>& faces) {
  struct Found {
    std::size_t number;
    Index component;
  };
  std::vector<Found> mine;
  for (std::size_t k = 0; k < faces.size(); ++k)
    if (const Index t = own_face(stage.patch, faces[k]); t != none)
      mine.push_back({k, stage.components.of_vertex[at(stage.patch.mesh.F()(t, 0))]});
  std::vector<Index> all(faces.size(), none);
  for (const Found& found : gather_all(mine)) all[found.number] = found.component;
  return all;
}

/// As stroke_through_points(), in the faces that its planes cross.
SurfacePolyline trace_stroke(const DesignFile& placed, const Stage& stage, std::size_t k) {
  const Patch& patch = stage.patch;
  const std::string path = path_of("strokes", k);
  std::vector<Index> faces;
  for (const DesignPoint& p : placed.strokes[k].points) faces.push_back(p.face);
  const std::vector<Index> component = components_of(stage, faces);
  std::vector<char> chosen = faces_near(patch, faces, 0);
  const Region around = gather_region(patch, chosen);
  StrokePoints points;
  at_path(path, [&] {
    std::vector<SurfacePoint> given;
    for (const DesignPoint& p : placed.strokes[k].points) given.push_back({around.find(p.face), p.barycentric});
    points = distinct_points(around.mesh, given);
  });
  for (std::size_t i = 0; i + 1 < points.at.size(); ++i) {
    const bool turn = traced_backwards(points.at[i], points.at[i + 1]);
    mark_crossed(patch.mesh, patch.V,
                 ends_of(around.mesh, around.V, points.at[turn ? i + 1 : i], points.at[turn ? i : i + 1]), chosen);
  }
  const Region region = gather_region(patch, chosen);
  for (SurfacePoint& p : points.at) p.face = region.find(around.face[at(p.face)]);
  SurfacePolyline line;
  at_path(path, [&] {
    line = stroke_through(region.mesh, region.V, region.geometry, points, [&](std::size_t i) {
      return component[points.number[i]] == component[points.number[i + 1]];
    });
  });
  for (SurfaceSegment& segment : line.segments) segment.face = region.face[at(segment.face)];
  return line;
}

Walked walk_together(const DesignFile& placed, const Stage& stage) {
  Walked walked;
  const std::size_t count = placed.singularities.size();
  walked.parts.resize(count);
  walked.targets.resize(count);
  walked.areas.resize(count, 0);
  for (std::size_t k = 0; k < count; ++k)
    if (placed.singularities[k].count > 1) find_zeros(placed, stage.patch, k, walked);
  for (std::size_t k = 0; k < placed.strokes.size(); ++k)
    walked.lines.push_back(placed.strokes[k].vertices.empty() ? trace_stroke(placed, stage, k) : SurfacePolyline{});
  return walked;
}

class Maker {
 public:
  Maker(const DesignFile& placed, const Walked& walked, const Stage& stage, const Frames& frames,
        const FirstOrderOperators& operators, double total_area)
      : placed_(placed), walked_(walked), stage_(stage), patch_(stage.patch), frames_(frames), loads_{patch_.mesh,
                                                                                                      patch_.V,
                                                                                                      patch_.geometry,
                                                                                                      stage.connection,
                                                                                                      operators,
                                                                                                      placed.n,
                                                                                                      total_area} {}

  [[nodiscard]] LocalControl singularity(std::size_t k) const {
    DesignSingularity s = placed_.singularities[k];
    LocalControl out{Type::singularity, path_of("singularities", k), label(s), {}, {}, {}, {}, none};
    if (s.count > 1) {
      add_zeros(k, out);
      return out;
    }
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
    LocalControl out{Type::fixed, path_of("fixed", k), label(f), {}, {}, {}, {}, none};
    f.vertex = own_vertex(patch_, f.vertex);
    if (f.vertex == none) return out;
    const VertexConstraint constraint = constraint_of(f, out.path, placed_.n, frames_);
    out.here = constraint;
    out.component = stage_.components.of_vertex[at(f.vertex)];
    at_path(out.path, [&] { out.load = loads_(constraint); });
    return out;
  }

  /// Every edge of the stroke by the rank that owns its smaller vertex, every segment by the one that has its face.
  [[nodiscard]] LocalControl stroke(std::size_t k) const {
    const DesignStroke& s = placed_.strokes[k];
    LocalControl out{Type::stroke, path_of("strokes", k), label(s, k), {}, {}, {}, {}, none};
    if (s.vertices.empty()) {
      for (SurfaceSegment segment : walked_.lines[k].segments) {
        segment.face = own_face(patch_, segment.face);
        if (segment.face != none)
          at_path(out.path, [&] { out.load.rows.push_back(loads_.segment_row(segment, s.weight)); });
      }
      return out;
    }
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
    LocalControl out{Type::boundary, "/boundary", label(placed_.boundary), {}, {}, {}, {}, none};
    if (patch_.empty()) return out;
    for (ControlRow& row : loads_.boundary_rows({.normal = placed_.boundary.normal, .weight = placed_.boundary.weight}))
      if (row.vertex[0] < patch_.owned) out.load.rows.push_back(row);
    return out;
  }

 private:
  /// The zeros of singularity k that are this rank's.
  void add_zeros(std::size_t k, LocalControl& out) const {
    SingularityTarget target = walked_.targets[k];
    out.asked = target;
    target.face = own_face(patch_, target.face);
    out.load.density = loads_.target_density(target, walked_.areas[k]);
    for (std::size_t i = 0; i < walked_.parts[k].size(); ++i) {
      SingularityPart part = walked_.parts[k][i];
      part.face = own_face(patch_, part.face);
      if (part.face == none) continue;
      loads_.add_part(part, target, walked_.areas[k], out.load);
      if (target.pin) out.row_order.push_back(static_cast<Index>(i));
      out.here = target;
      out.component = stage_.components.of_vertex[at(patch_.mesh.F()(part.face, 0))];
    }
  }

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
  const Walked& walked_;
  const Stage& stage_;
  const Patch& patch_;
  const Frames& frames_;
  ControlLoads loads_;
};

/// Tells all ranks what was asked for where it is known on one only.
void share_asked(const DesignFile& placed, std::vector<LocalControl>& controls) {
  std::vector<PlainControl> mine;
  for (std::size_t k = 0; k < controls.size(); ++k) {
    if (!controls[k].here || controls[k].asked) continue;
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
  const Walked walked = walk_together(placed, stage);
  agreed([&] {
    FirstOrderOperators operators;
    if (!stage.patch.empty() && !placed.singularities.empty())
      operators = first_order_operators(stage.patch.mesh, stage.patch.geometry, stage.connection,
                                        {.n = placed.n, .kind = DesignerOptions().kind});
    const Maker maker(placed, walked, stage, frames, operators, total_area);
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
