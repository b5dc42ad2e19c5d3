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

void TargetTally::add(const Mesh& mesh, const Connection& connection, const Field& field,
                      const SingularityTarget& target, const ControlLoad& load) {
  for (const TargetPart& part : load.parts) {
    const int here = face_index(mesh, connection, field, part.face);
    index += here;
    all = all && here == target.sign;
    Complex<double> sum = 0;
    for (Index c = 0; c < 3; ++c)
      sum += part.coefficient[static_cast<std::size_t>(c)] * field.u[mesh.F()(part.face, c)];
    if (sum != Complex<double>(0)) value += sum / std::abs(sum);
  }
}

ControlReport TargetTally::judge(int n, const SingularityTarget& target, const ControlTolerances& tolerances) const {
  ControlReport report;
  const int turns = target_turns(n, target);
  report.index = index;
  report.error_degrees = std::abs(wrap(std::arg(value) - turns * target.orientation)) / std::abs(turns) * in_degrees;
  report.met = all && report.error_degrees <= tolerances.singularity_degrees;
  return report;
}

ControlReport judge_target(const Mesh& mesh, const Connection& connection, const Field& field,
                           const SingularityTarget& target, const ControlLoad& load,
                           const ControlTolerances& tolerances) {
  TargetTally tally;
  tally.add(mesh, connection, field, target, load);
  return tally.judge(field.n, target, tolerances);
}

ControlReport judge_fixed(const VertexConstraint& constraint, int n, Complex<double> value, double longest,
                          const ControlTolerances& tolerances) {
  ControlReport report;
  const double size = std::abs(constraint.value) + longest;
  report.error_degrees = std::abs(wrap(std::arg(value) - std::arg(constraint.value))) / n * in_degrees;
  report.met = constraint.direction_only
                   ? std::abs(value) > 1e-9 * size && report.error_degrees <= tolerances.fixed_degrees
                   : std::abs(value - constraint.value) <= tolerances.fixed_value * size;
  return report;
}

ControlReport Deviation::judge(double tolerance_degrees) const {
  ControlReport report;
  report.error_degrees = radians / weights * in_degrees;
  report.met = report.error_degrees <= tolerance_degrees;
  return report;
}

}  // namespace alcap::detail
