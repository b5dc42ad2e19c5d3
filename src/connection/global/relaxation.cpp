// SPDX-License-Identifier: MIT
#include "src/connection/global/relaxation.h"

#include <algorithm>

#include "src/base/parallel.h"

namespace alcap::detail {

void FaceEnergy::coefficients(const Index (&first)[N], simd::FaceGroup& c) const {
  simd::FaceShapes shapes;
  for (int l = 0; l < N; ++l) {
    Index h = first[l];
    for (int k = 0; k < 3; ++k, h = Mesh::next(h)) {
      shapes.cot[k][l] = geometry.cot(h);
      shapes.factor[k][l] = mesh.boundary_halfedge(h) ? 0 : lambda * weights.length_factor(h);
    }
  }
  simd::loops().group.coefficients(shapes, weights.cap(), c);
}

// The first halfedges of single faces i, i + 1, ...; beyond the last one, lanes repeat it.
void FaceRelaxation::first_of_singles(std::int64_t i, Index (&first)[N]) const {
  for (int l = 0; l < N; ++l) first[l] = 3 * faces_.single[std::min<std::int64_t>(i + l, faces_.singles - 1)];
}

// Both sides of the edges between pairs i, i + 1, ...
void FaceRelaxation::first_of_pairs(std::int64_t i, Index (&first)[2][N]) const {
  const Mesh& mesh = energy_.mesh;
  for (int l = 0; l < N; ++l) {
    first[0][l] = mesh.halfedge(faces_.between[std::min<std::int64_t>(i + l, faces_.pairs - 1)]);
    first[1][l] = mesh.twin(first[0][l]);
  }
}

// What halfedge h sees of its edge, into halfedge k of lane `lane`: mean and difference of (r_i, r_j), and tau. The
// second face of an edge, at odd rows of the exchange, sees difference and rotation with the other sign.
void FaceRelaxation::gather(Index h, std::int64_t row, int k, int lane, simd::GroupState& v) const {
  const EdgeCorrection& u = edges_[row / 2];
  const double sign = row % 2 != 0 ? -1.0 : 1.0;
  const double start = state_.residuals == nullptr ? 0 : state_.residuals->start[h];
  const double end = state_.residuals == nullptr ? 0 : state_.residuals->end[h];
  v.mean[k][lane] = (start + end) / 2 - u.mean;
  v.difference[k][lane] = end - start - sign * u.difference;
  v.tau[k][lane] = (state_.tau == nullptr ? 0 : (*state_.tau)[h]) + sign * u.rotation;
}

void FaceRelaxation::scatter(const simd::GroupState& v, int k, int lane, std::int64_t row) const {
  forces_[row] = {v.mean[k][lane], v.difference[k][lane], v.tau[k][lane]};
}

void FaceRelaxation::all(const CorrectionSystem<float>& system) const {
  constexpr std::int64_t grain = 256;  // groups: 50K triangles keep two threads equally busy
  parallel_for((std::int64_t{faces_.singles} + N - 1) / N,
               [&](std::int64_t group) {
                 Index first[N];
                 simd::FaceGroup c;
                 first_of_singles(group * N, first);
                 energy_.coefficients(first, c);
                 single(system, group * N, c);
               },
               grain);
  parallel_for((std::int64_t{faces_.pairs} + N - 1) / N,
               [&](std::int64_t group) {
                 Index first[2][N];
                 simd::FaceGroup c[2];
                 Inverse inverse;
                 first_of_pairs(group * N, first);
                 for (int side = 0; side < 2; ++side) energy_.coefficients(first[side], c[side]);
                 loops_.between(c, inverse);
                 pair(system, group * N, c, inverse);
               },
               grain);
}

void FaceRelaxation::single(const CorrectionSystem<float>& system, std::int64_t i, const simd::FaceGroup& c) const {
  const auto count = static_cast<int>(std::min<std::int64_t>(N, faces_.singles - i));
  Index first[N];
  simd::GroupState v;
  simd::GroupArray moved[3];
  std::int64_t row[3][N];
  first_of_singles(i, first);
  for (int l = 0; l < N; ++l)
    for (int k = 0; k < 3; ++k) {
      row[k][l] = system.single_row(i + std::min(l, count - 1), k);
      gather(first[l] + k, row[k][l], k, l, v);
    }
  loops_.relax(c, v, moved);
  for (int l = 0; l < count; ++l)
    for (int k = 0; k < 3; ++k) {
      scatter(v, k, l, row[k][l]);
      corners_[first[l] + k] = moved[k][l];
    }
}

void FaceRelaxation::pair(const CorrectionSystem<float>& system, std::int64_t i, const simd::FaceGroup (&c)[2],
                          const Inverse& inverse) const {
  const auto count = static_cast<int>(std::min<std::int64_t>(N, faces_.pairs - i));
  Index first[2][N];
  simd::GroupState v[2];
  simd::GroupArray moved[2][3], between[3];
  std::int64_t row[2][3][N];
  first_of_pairs(i, first);
  for (int side = 0; side < 2; ++side)
    for (int l = 0; l < N; ++l) {
      const std::int64_t last = i + std::min(l, count - 1);
      Index h = first[side][l];
      row[side][0][l] = 2 * (faces_.outer + last) + side;
      for (int k = 1; k < 3; ++k) row[side][k][l] = system.pair_row(last, side, k);
      for (int k = 0; k < 3; ++k, h = Mesh::next(h)) gather(h, row[side][k][l], k, l, v[side]);
    }
  loops_.relax_pair(c, inverse, v, moved, between);
  for (int l = 0; l < count; ++l) {
    // What the first face sees falls by mean and difference, and rises by the rotation.
    EdgeCorrection& edge = edges_[faces_.outer + i + l];
    edge = {edge.mean - between[0][l], edge.difference - between[1][l], edge.rotation + between[2][l]};
    for (int side = 0; side < 2; ++side) {
      Index h = first[side][l];
      for (int k = 0; k < 3; ++k, h = Mesh::next(h)) {
        if (k > 0) scatter(v[side], k, l, row[side][k][l]);
        corners_[h] = moved[side][k][l];
      }
    }
  }
}

EdgeCorrection FaceRelaxation::force(std::int64_t i, bool open) const {
  const EdgeCorrection& first = forces_[2 * i];
  if (open) return {first.mean, first.difference, -first.rotation};
  const EdgeCorrection& second = forces_[2 * i + 1];
  return {first.mean + second.mean, first.difference - second.difference, second.rotation - first.rotation};
}

}  // namespace alcap::detail
