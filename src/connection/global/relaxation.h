// SPDX-License-Identifier: MIT
//
// relaxation.h: the faces' side of the globally optimal connection, in double. Every face gathers what it sees of its
// edges, moves its corners to their optimum (kernels/face_relaxation.h), and leaves the forces with which it pulls its
// edges. Pairs of faces turn the edge between them as well (src/connection/global/pairs.h).
#pragma once

#include "src/base/array.h"
#include "src/connection/construction.h"
#include "src/connection/global/edge_correction.h"
#include "src/connection/global/energy.h"
#include "src/connection/global/pairs.h"
#include "src/connection/global/system.h"
#include "src/simd/dispatch.h"

namespace alcap::detail {

/// The energy D_T + lambda D_E of a mesh.
struct FaceEnergy {
  static constexpr int N = simd::group_size;

  const Mesh& mesh;
  const Geometry& geometry;
  const HalfedgeWeights& weights;
  double lambda;

  /// The coefficients of the faces of halfedges first[0 ... N - 1], counted from these on. Boundaries have no weight:
  /// rho_{v->e} is free there and follows its face.
  void coefficients(const Index (&first)[N], simd::FaceGroup& c) const;
};

/// The lifted state that corrections add to. Without pointers it is at rest: zero everywhere.
struct LiftedState {
  const VectorX<double>* tau = nullptr;
  const LiftedResiduals* residuals = nullptr;
};

/// Relaxes all faces in a state whose edges are turned by `edges` (by their number in `faces`): `forces` receives those
/// on each row of the exchange of CorrectionSystem, `corners` what rho_{v->t} moves by. Edges between paired faces are
/// turned to their optimum.
class FaceRelaxation {
 public:
  using Inverse = simd::GroupArray[6];

  FaceRelaxation(const FaceEnergy& energy, const FacePairs& faces, const LiftedState& state,
                 Array<EdgeCorrection>& edges, Array<EdgeCorrection>& forces, Array<double>& corners)
      : energy_(energy), faces_(faces), state_(state), edges_(edges), forces_(forces), corners_(corners) {}

  void all(const CorrectionSystem<float>& system) const;

  /// Single faces i, i + 1, ..., or pairs, up to the last or to a whole group.
  void single(const CorrectionSystem<float>& system, std::int64_t i, const simd::FaceGroup& c) const;
  void pair(const CorrectionSystem<float>& system, std::int64_t i, const simd::FaceGroup (&c)[2],
            const Inverse& inverse) const;

  /// The force of both faces on outer edge i; open: it has no second face.
  [[nodiscard]] EdgeCorrection force(std::int64_t i, bool open) const;

 private:
  static constexpr int N = simd::group_size;

  void first_of_singles(std::int64_t i, Index (&first)[N]) const;
  void first_of_pairs(std::int64_t i, Index (&first)[2][N]) const;
  void gather(Index h, std::int64_t row, int k, int lane, simd::GroupState& v) const;
  void scatter(const simd::GroupState& v, int k, int lane, std::int64_t row) const;

  const FaceEnergy& energy_;
  const FacePairs& faces_;
  LiftedState state_;
  Array<EdgeCorrection>& edges_;
  Array<EdgeCorrection>& forces_;
  Array<double>& corners_;
  const simd::GroupLoops& loops_ = simd::loops().group;
};

}  // namespace alcap::detail
