// SPDX-License-Identifier: MIT
//
// design_intrinsic.cpp: designs that are solved on an intrinsic triangulation: what is asked on the mesh, there, and
// the field back on the mesh.
#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include "alcap/alignment.h"
#include "src/run/design_stages.h"

namespace alcap::detail {

void DesignStages::keep_edges(const std::vector<Index>& features) {
  if (options_.triangulation == Triangulation::extrinsic) return;
  // The boundary as well, so that it is known what became of its edges; designs may follow it.
  std::vector<Index> kept = sharp_edges(surface_, {.creases = false}).edges;
  kept.insert(kept.end(), features.begin(), features.end());
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  if (kept == kept_) return;
  kept_ = std::move(kept);
  triangulation_.reset();
  if (solve_ || needles_stay_) connection_text_.clear();  // made on another triangulation, or for want of one
}

FeatureGraph DesignStages::graph_there(const FeatureGraph& graph) const {
  return solve_ ? graph_on(solve_->triangulation(), kept_, graph) : graph;
}

bool DesignStages::connect_intrinsic(const ConnectionOptions& options) {
  solve_.reset();
  needles_stay_ = false;
  if (!wants_intrinsic(surface_, options_.triangulation, options)) return false;
  if (!triangulation_) triangulation_ = triangulate(surface_, options_.triangulation, options_.min_angle, kept_);
  needles_stay_ = !triangulation_;
  if (needles_stay_) return false;
  solve_ = std::make_unique<IntrinsicSolve>(surface_, *triangulation_, options);
  connected_ = solve_->surface();
  ConnectionOptions given = options;
  // In closed form: any other would take as long here as the triangulation saves.
  if (given.kind != ConnectionKind::polar) given.kind = ConnectionKind::local;
  given_ = alcap::connect(surface_, given);
  return true;
}

std::vector<DesignControl> DesignStages::carried(std::vector<DesignControl> controls, int n) const {
  if (!solve_) return controls;
  const IntrinsicTrace trace(surface_, solve_->triangulation());
  for (DesignControl& c : controls) {
    if (auto* const target = std::get_if<SingularityTarget>(&c.control)) {
      const std::array<double, 3> middle{1.0 / 3, 1.0 / 3, 1.0 / 3};
      const IntrinsicTrace::Place place = trace.point({target->face, target->pin.value_or(middle)});
      target->face = place.point.face;
      if (target->pin) target->pin = place.point.barycentric;
      // That of index 1 is a swirl, which has no direction in the face.
      if (target->sign * target->count != n) target->orientation += place.turn;
    } else if (auto* const fixed = std::get_if<VertexConstraint>(&c.control)) {
      fixed->value = solve_->from_given(fixed->vertex, fixed->value, n);
    } else if (auto* const stroke = std::get_if<Stroke>(&c.control)) {
      stroke->line = trace.line(stroke->line);
    } else if (auto* const features = std::get_if<FeatureAlignment>(&c.control)) {
      features->features = graph_there(features->features);
    }
  }
  return controls;
}

void DesignStages::carry_guidance(int n) {
  if (!guidance_.u) return;
  ComplexVectorX<double> u = solve_->from_given(*guidance_.u, n);
  const double size = root_mean_square(connected_, u);
  u /= size;
  guidance_.scale /= size;
  guidance_.u = std::make_shared<const ComplexVectorX<double>>(std::move(u));
}

void DesignStages::bring_back(DesignRun& run) const {
  run.field.n = run.design.n;
  run.field.frames = nullptr;
  run.triangulation = solve_->summary(run.field);
  run.field.u = solve_->to_given(run.field.u, run.design.n);
  run.field.frames = given_.frames();
  if (run.guidance)
    run.guidance = std::make_shared<const ComplexVectorX<double>>(solve_->to_given(*run.guidance, run.design.n));
}

}  // namespace alcap::detail
