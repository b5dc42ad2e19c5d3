// SPDX-License-Identifier: MIT
#include "src/distributed/design_place.h"

#include <algorithm>
#include <limits>

#include "src/base/array.h"
#include "src/base/numbers.h"
#include "src/curves/strokes/closest.h"
#include "src/design/file/problem.h"
#include "src/run/design_stages.h"

namespace alcap::detail::distributed {
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& value, const std::string& why) {
  throw OptionError(path, value,
                    why + "; over several ranks it is not available, alcap design takes it on one machine");
}

void refuse_connection(const DesignConnection& c) {
  if (c.balance) refuse("/connection/balance", "true", "cones would be placed one after the other");
  if (!c.holonomy.empty())
    refuse("/connection/holonomy", std::to_string(c.holonomy.size()) + " values",
           "generators of homology run over the whole surface");
  if (!c.target.levi_civita()) refuse("/connection/target", "given", "its arrays are those of the whole surface");
}

/// The best of what the ranks offer.
template <class Offer>
Offer best_of(const std::vector<Offer>& mine) {
  const std::vector<Offer> all = gather_all(mine);
  return *std::ranges::min_element(all, [](const Offer& a, const Offer& b) {
    return a.squared != b.squared ? a.squared < b.squared : a.number < b.number;
  });
}

struct NearVertex {
  double squared;
  Index number;
};
struct NearFace {
  double squared;
  Index number;
  std::array<double, 3> barycentric;
};

Eigen::RowVector3d row(const Vector3& x) { return {x[0], x[1], x[2]}; }

/// As nearest_vertex() of src/design/file/place.cpp.
Index nearest_vertex(const Stage& stage, const Vector3& to) {
  std::vector<NearVertex> best;
  for (Index v = 0; v < stage.patch.owned; ++v) {
    if (stage.components.of_vertex[at(v)] == none) continue;
    const double squared = (stage.patch.V.row(v) - row(to)).squaredNorm();
    if (best.empty() || squared < best[0].squared) best.assign(1, {squared, stage.patch.vertex[at(v)]});
  }
  return best_of(best).number;
}

/// As SurfaceLocator::closest(), without a tree: a design has few points.
SurfacePoint nearest_point(const Patch& patch, const Vector3& to) {
  std::vector<NearFace> best;
  for (Index t = 0; t < patch.mesh.faces(); ++t) {
    if (patch.mine[at(t)] == 0) continue;
    const auto f = patch.mesh.F().row(t);
    double squared = 0;
    const auto b = closest_in({patch.V.row(f(0)), patch.V.row(f(1)), patch.V.row(f(2))}, row(to), squared);
    if (best.empty() || squared < best[0].squared) best.assign(1, {squared, patch.face[at(t)], b});
  }
  const NearFace found = best_of(best);
  return {found.number, found.barycentric};
}

/// Of these vertices, those that no face uses.
std::vector<Index> unused(const Stage& stage, const std::vector<Index>& vertices) {
  std::vector<Index> mine;
  for (const Index v : vertices)
    if (const Index here = own_vertex(stage.patch, v); here != none && stage.components.of_vertex[at(here)] == none)
      mine.push_back(v);
  return gather_all(mine);
}

}  // namespace

Index own_face(const Patch& patch, Index face) {
  const auto found = std::ranges::lower_bound(patch.face, face);
  if (found == patch.face.end() || *found != face) return none;
  const auto t = static_cast<Index>(found - patch.face.begin());
  return patch.mine[at(t)] != 0 ? t : none;
}

Index own_vertex(const Patch& patch, Index vertex) {
  const auto end = patch.vertex.begin() + patch.owned;
  const auto found = std::lower_bound(patch.vertex.begin(), end, vertex);
  return found != end && *found == vertex ? static_cast<Index>(found - patch.vertex.begin()) : none;
}

void refuse_what_needs_one_machine(const DesignFile& design) {
  if (design.method == DesignMethod::eigen)
    refuse("/method", std::string(name(design.method)),
           "an eigen design has its controls in both matrices of an eigenproblem");
  refuse_connection(design.connection);
  for (std::size_t k = 0; k < design.strokes.size(); ++k)
    if (design.strokes[k].radius > 0)
      refuse(path_of("strokes", k) + "/radius", number_text(design.strokes[k].radius),
             "a footprint spreads over the surface");
  if (design.features.wanted) refuse("/features", "given", "lines of sharp edges are followed over the surface");
  if (!design.edits.empty())
    refuse("/edits", std::to_string(design.edits.size()) + " edits", "directions are carried over the surface");
  if (aligned_alone(design) == AlignedAlone::boundary)
    refuse("/boundary", "alone", "with nothing else but free lengths the field is solved for in steps; give guidance");
}

DesignFile place(const DesignFile& design, const MeshSlice& mesh, const Stage& stage) {
  const auto check_numbers = [&](const DesignFile& d) {
    const std::vector<Index> bad = unused(stage, vertices_of(d));
    agreed([&] {
      check_design_on(d, {mesh.vertices, mesh.faces, [&](Index v) { return std::ranges::find(bad, v) == bad.end(); }});
    });
  };
  check_numbers(design);
  DesignFile placed = design;
  place_points(placed, {.point = [&](const Vector3& at) { return nearest_point(stage.patch, at); },
                        .vertex = [&](const Vector3& at) { return nearest_vertex(stage, at); }});
  check_numbers(placed);  // two points may be nearest to one vertex
  return placed;
}

}  // namespace alcap::detail::distributed
