// SPDX-License-Identifier: MIT
//
// element_tables.cpp: the columns of the tables of directions and frames. docs/file-formats.md describes them.
#include "src/io/field/element_tables.h"

#include "src/field/branches.h"

namespace alcap::detail {
namespace {

/// Where an element lies, e1 along branch 0, e2 = e3 x e1, e3 the normal, the angle of e1 and the length of a branch.
/// A zero has no direction: e1 is the axis, and the length 0.
void put_element(const Field& field, Index i, const Eigen::RowVector3d& position, double* to) {
  const Frames& frames = *field.frames;
  const double angle = field.u[i] == Complex<double>(0) ? 0.0 : std::arg(field.u[i]) / field.n;
  const Eigen::RowVector3d x = frames.X.row(i), y = frames.Y(i), n = frames.N.row(i);
  const double c = std::cos(angle), s = std::sin(angle);
  for (const Eigen::RowVector3d& row :
       {position, Eigen::RowVector3d(c * x + s * y), Eigen::RowVector3d(c * y - s * x), n})
    for (int k = 0; k < 3; ++k) *to++ = row[k];
  *to++ = angle * 180 / pi<double>;
  *to = std::abs(principal_root(field.u[i], field.n));
}

}  // namespace

Table element_table(const FieldJob& job, bool faces) {
  Table table{
      faces ? "face" : "vertex",
      faces ? job.out.surface.mesh().faces() : job.out.surface.mesh().vertices(),
      {"x", "y", "z", "e1_x", "e1_y", "e1_z", "e2_x", "e2_y", "e2_z", "e3_x", "e3_y", "e3_z", "theta", "length"},
      {}};
  const Field& field = faces ? job.at_faces() : job.out.field;
  const Faces& F = job.out.surface.F();
  const Positions<double>& V = job.out.surface.V();
  table.row = [&, faces](std::int64_t i, double* to) {
    Eigen::RowVector3d position = V.row(faces ? F(i, 0) : i);
    if (faces) position = (position + V.row(F(i, 1)) + V.row(F(i, 2))) / 3;
    put_element(field, static_cast<Index>(i), position, to);
  };
  return table;
}

}  // namespace alcap::detail
