// SPDX-License-Identifier: MIT
//
// directional_reader.h: raw fields and singularities as the library Directional reads them, and its principal matching,
// in space: no frames and no complex numbers of alcap.
#pragma once

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <map>

#include "alcap/surface.h"
#include "tests/support/folder.h"

namespace alcap::test {

namespace fs = std::filesystem;
using Row = Eigen::RowVector3d;

// A raw field as Directional reads it: n and the number of rows, then 3 n numbers a row with operator>>, and the stream
// must still be good afterwards.
struct Raw {
  int n = 0;
  Eigen::MatrixXd rows;
  [[nodiscard]] Row at(Eigen::Index i, int k) const { return rows.block<1, 3>(i, 3 * k); }
};
inline Raw read_raw(const fs::path& path) {
  std::ifstream in(path);
  int count = 0;
  Raw raw;
  in >> raw.n >> count;
  raw.rows.resize(count, 3 * raw.n);
  for (Eigen::Index i = 0; i < raw.rows.rows(); ++i) {
    for (Eigen::Index j = 0; j < raw.rows.cols(); ++j) in >> raw.rows(i, j);
  }
  CHECK(in.good());
  std::string rest;
  in >> rest;
  CHECK(rest.empty());
  return raw;
}

inline std::map<int, int> read_sings(const fs::path& path, int& n) {
  std::ifstream in(path);
  int count = -1;
  in >> n >> count;
  std::map<int, int> out;
  for (int i = 0, element = 0, index = 0; i < count; ++i) {
    in >> element >> index;
    CHECK(out.emplace(element, index).second);
  }
  CHECK(in.good());
  return out;
}

inline Row face_normal(const Surface& s, Index t) {
  const Row a = s.V().row(s.F()(t, 0)), b = s.V().row(s.F()(t, 1)), d = s.V().row(s.F()(t, 2));
  return (b - a).cross(d - a).normalized();
}

// Principal matching in space: unfold the face of h over prev(h) into the next face, take the branch that is nearest to
// branch 0 there, sum the angles around the vertex and add the angle defect. No frames and no complex numbers.
inline int index_by_matching(const Surface& s, const Raw& raw, Index v) {
  const Mesh& mesh = s.mesh();
  double turn = s.geometry().defect(mesh, v);
  mesh.for_each_outgoing(v, [&](Index h) {
    const Index shared = Mesh::prev(h), f = Mesh::face(h), g = Mesh::face(mesh.twin(shared));
    const Row from = face_normal(s, f), to = face_normal(s, g);
    const Row axis = (s.V().row(mesh.tip(shared)) - s.V().row(mesh.tail(shared))).normalized();
    const double fold = std::atan2(from.cross(to).dot(axis), from.dot(to));
    const Row unfolded = (Eigen::AngleAxisd(fold, axis.transpose()) * raw.at(f, 0).transpose()).transpose();
    double best = 10;
    for (int k = 0; k < raw.n; ++k) {
      const Row other = raw.at(g, k);
      const double angle = std::atan2(unfolded.cross(other).dot(to), unfolded.dot(other));
      if (std::abs(angle) < std::abs(best)) best = angle;
    }
    turn += best;
  });
  const double index = turn * raw.n / (2 * pi<double>);
  CHECK(std::abs(index - std::round(index)) < 1e-6);
  return static_cast<int>(std::lround(index));
}

}  // namespace alcap::test
