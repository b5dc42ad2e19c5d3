// SPDX-License-Identifier: MIT
//
// energy.h: the deviation from Levi-Civita that the globally optimal connection minimises (LTGD 2016, Sec. 5.3),
//
//   D_T + lambda D_E,  D_T = sum over faces of int_t omega_t ^ *omega_t = tau' W tau,
//   D_E = sum over halfedges h = i -> j of w_h int_0^1 r(x)^2 dx = w_h (r_i^2 + r_i r_j + r_j^2) / 3,
//
// with r the difference of eqs. 9 and 10, linear along the edge, and w_h = min(tan(angle opposite h), cap) times a
// length factor: the inverse of the cotangent weight of the face. Kernels: kernels/connection_energy.h.
#pragma once

#include <vector>

#include "alcap/connection.h"
#include "src/connection/construction.h"

namespace alcap::detail {

/// Throws OptionError for values out of range.
void validate(const GlobalOptions& options);

/// The w_h of D_E. Computed where they are needed, which costs less than to store and read them.
class HalfedgeWeights {
 public:
  HalfedgeWeights(const Mesh& mesh, const Geometry& geometry, const GlobalOptions& options);

  [[nodiscard]] double operator()(Index h) const;
  [[nodiscard]] double length_factor(Index h) const;
  [[nodiscard]] double cap() const { return cap_; }

 private:
  const Mesh& mesh_;
  const Geometry& geometry_;
  double cap_;
  LengthFactor factor_;
  std::vector<double> per_length_;     // 1 over the mean edge length, per component
  std::vector<Index> face_component_;  // empty where there is only one
};

/// tau and K as close_faces() of construction.h, and the deviations of the state in the same pass.
void close_faces(const Mesh& mesh, const Geometry& geometry, const HalfedgeWeights& weights,
                 const LiftedResiduals& residuals, Connection& connection);

}  // namespace alcap::detail
