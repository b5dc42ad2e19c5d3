// SPDX-License-Identifier: MIT
//
// edge_correction.h: the unknowns of one edge of the globally optimal connection.
#pragma once

namespace alcap::detail {

/// Corrections of an edge's angles: the mean of those of rho_{v->e} at its two ends, their difference along the
/// canonical halfedge (far end less near end), and that of rho_ij. As a force: minus half of the energy's derivatives
/// in them.
struct EdgeCorrection {
  double mean, difference, rotation;

  friend bool operator==(const EdgeCorrection&, const EdgeCorrection&) = default;
  friend EdgeCorrection operator+(const EdgeCorrection& a, const EdgeCorrection& b) {
    return {a.mean + b.mean, a.difference + b.difference, a.rotation + b.rotation};
  }
  friend EdgeCorrection operator-(const EdgeCorrection& a, const EdgeCorrection& b) {
    return {a.mean - b.mean, a.difference - b.difference, a.rotation - b.rotation};
  }
  friend EdgeCorrection operator*(double s, const EdgeCorrection& a) {
    return {s * a.mean, s * a.difference, s * a.rotation};
  }
};

[[nodiscard]] inline double dot(const EdgeCorrection& a, const EdgeCorrection& b) {
  return a.mean * b.mean + a.difference * b.difference + a.rotation * b.rotation;
}

}  // namespace alcap::detail
