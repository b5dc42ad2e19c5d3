// SPDX-License-Identifier: MIT
//
// angles.h: how far a field is from another one, angle by angle.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <set>
#include <vector>

#include "alcap/arrays.h"
#include "alcap/conventions.h"
#include "alcap/mesh.h"

namespace alcap::test {

/// Degrees between the phases of two vectors after the second is turned to agree best by M, divided by n.
struct AngleError {
  double rms = 0;       ///< of the sine of the angle in M's metric
  double vertices = 0;  ///< the largest among vertices where |u| is a tenth of its root mean square or more
};

template <class Matrix>
AngleError angle_error(const Matrix& M, double area, const ComplexVectorX<double>& u, const ComplexVectorX<double>& v,
                       int n) {
  const ComplexVectorX<double> Mv = M * v;
  const std::complex<double> overlap = u.dot(Mv) / std::sqrt(v.dot(Mv).real());
  const double length = std::sqrt(u.dot(M * u).real());
  // From the difference: 1 - cos loses half of the digits.
  const std::complex<double> phase = overlap / std::abs(overlap);
  const ComplexVectorX<double> turned = v * std::conj(phase) / std::sqrt(v.dot(Mv).real());
  const ComplexVectorX<double> d = u / length - turned;
  const double chord = std::sqrt(std::max(0.0, d.dot(M * d).real()));
  const double degrees = 180 / pi<double> / n;
  AngleError error{.rms = 2 * std::asin(std::min(1.0, chord / 2)) * degrees};
  for (Eigen::Index i = 0; i < u.size(); ++i)
    if (std::abs(u[i]) / length >= 0.1 / std::sqrt(area))
      error.vertices = std::max(error.vertices, std::abs(std::arg(u[i] * std::conj(turned[i]))) * degrees);
  return error;
}

/// Faces of other indices whose change is no step of a singularity into a neighbour across an edge or a corner: around
/// each the sum of the indices has changed.
inline std::vector<Index> moved_singularities(const Mesh& mesh, const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<Index> moved;
  for (Index t = 0; t < mesh.faces(); ++t) {
    if (a[static_cast<std::size_t>(t)] == b[static_cast<std::size_t>(t)]) continue;
    std::set<Index> around;
    for (Index k = 0; k < 3; ++k) {
      const Index v = mesh.tail(3 * t + k);
      mesh.for_each_outgoing(v, [&](Index h) { around.insert(Mesh::face(h)); });
    }
    int sum = 0;
    for (const Index s : around) sum += a[static_cast<std::size_t>(s)] - b[static_cast<std::size_t>(s)];
    if (sum != 0) moved.push_back(t);
  }
  return moved;
}

}  // namespace alcap::test
