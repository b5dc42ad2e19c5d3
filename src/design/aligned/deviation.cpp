// SPDX-License-Identifier: MIT
//
// deviation.cpp: how well a field follows features.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "src/design/feature_rows.h"

namespace alcap {
namespace {

/// Collects edges.
class Deviations {
 public:
  void add(double degrees, double length, bool at_corner) {
    out_.length += length;
    if (at_corner) {
      ++out_.corner_edges;
      out_.corner_worst_degrees = std::max(out_.corner_worst_degrees, degrees);
      return;
    }
    degrees_.push_back(degrees);
    weighted_ += degrees * length;
    measured_ += length;
  }
  void add_singularity() { ++out_.singularities; }

  [[nodiscard]] LineDeviation finish() {
    out_.edges = static_cast<Index>(degrees_.size());
    if (degrees_.empty()) return out_;
    std::sort(degrees_.begin(), degrees_.end());
    out_.mean_degrees = weighted_ / measured_;
    out_.worst_degrees = degrees_.back();
    out_.p95_degrees = degrees_[(degrees_.size() * 95 + 99) / 100 - 1];
    return out_;
  }

 private:
  LineDeviation out_;
  std::vector<double> degrees_;
  double weighted_ = 0, measured_ = 0;
};

void check(const ConnectedSurface& surface, const Field& field, const FeatureGraph& features) {
  const Mesh& mesh = surface.mesh();
  if (field.u.size() != mesh.vertices())
    throw OptionError("field", std::to_string(field.u.size()) + " values", "needs one per vertex");
  if (field.n % 2 != 0) throw OptionError("n", field.n, "must be even: a feature has no sense of direction");
  detail::check_features(mesh, features, field.n);
}

}  // namespace

FeatureReport measure_features(const ConnectedSurface& surface, const Field& field, const FeatureGraph& features,
                               const std::vector<Singularity>& singularities, bool across) {
  check(surface, field, features);
  const Mesh& mesh = surface.mesh();
  const auto corner = [&](Index v) { return features.vertices[static_cast<std::size_t>(v)] == FeatureVertex::corner; };
  FeatureReport report;
  std::vector<char> singular(static_cast<std::size_t>(mesh.faces()), 0);
  for (const Singularity& s : singularities) {
    const bool at_corner = corner(mesh.F()(s.face, 0)) || corner(mesh.F()(s.face, 1)) || corner(mesh.F()(s.face, 2));
    report.singularities_at_corners += at_corner ? 1 : 0;
    singular[static_cast<std::size_t>(s.face)] = at_corner ? 0 : 1;
  }
  Deviations all;
  for (const FeatureLine& line : features.lines) {
    Deviations here;
    for (const Index e : line.edges) {
      const detail::EdgeRow row = detail::edge_row(mesh, surface.geometry(), surface.connection(), field.n, across, e);
      const double degrees = std::abs(std::arg(row.at(field.u) * std::conj(row.target))) / field.n * 180 / pi<double>;
      const bool at_corner = corner(row.i) || corner(row.j);
      here.add(degrees, row.weight, at_corner);
      all.add(degrees, row.weight, at_corner);
      for (const Index h : {mesh.halfedge(e), mesh.twin(mesh.halfedge(e))}) {
        if (h == none || singular[static_cast<std::size_t>(Mesh::face(h))] == 0) continue;
        here.add_singularity();
        all.add_singularity();
      }
    }
    report.lines.push_back(here.finish());
  }
  report.all = all.finish();
  return report;
}

}  // namespace alcap
