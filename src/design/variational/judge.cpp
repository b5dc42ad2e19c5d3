// SPDX-License-Identifier: MIT
//
// judge.cpp: how controls were met.
#include <cmath>

#include "alcap/singularities.h"
#include "src/design/variational/rows.h"

namespace alcap::detail {
namespace {

constexpr double in_degrees = 180 / pi<double>;

}  // namespace

ControlReport judge_target(const Mesh& mesh, const Connection& connection, const Field& field,
                           const SingularityTarget& target, const ControlLoad& load) {
  ControlReport report;
  Complex<double> value = 0;
  bool all = true;
  for (const TargetPart& part : load.parts) {
    const int index = face_index(mesh, connection, field, part.face);
    report.index += index;
    all = all && index == target.sign;
    Complex<double> here = 0;
    for (Index c = 0; c < 3; ++c)
      here += part.coefficient[static_cast<std::size_t>(c)] * field.u[mesh.F()(part.face, c)];
    if (here != Complex<double>(0)) value += here / std::abs(here);
  }
  const int turns = target_turns(field.n, target);
  report.error_degrees = std::abs(wrap(std::arg(value) - turns * target.orientation)) / std::abs(turns) * in_degrees;
  report.met = all && report.error_degrees <= target_met_degrees;
  return report;
}

ControlReport judge_fixed(const VertexConstraint& constraint, int n, Complex<double> value, double longest) {
  ControlReport report;
  const double size = std::abs(constraint.value) + longest;
  report.error_degrees = std::abs(wrap(std::arg(value) - std::arg(constraint.value))) / n * in_degrees;
  report.met = constraint.direction_only ? std::abs(value) > 1e-9 * size && report.error_degrees <= target_met_degrees
                                         : std::abs(value - constraint.value) <= 1e-6 * size;
  return report;
}

ControlReport Deviation::judge() const {
  ControlReport report;
  report.error_degrees = radians / weights * in_degrees;
  report.met = report.error_degrees <= stroke_met_degrees;
  return report;
}

}  // namespace alcap::detail
