// SPDX-License-Identifier: MIT
//
// rows.h: what strokes and singularities measure of a field, as real-linear functionals. Internal to
// eigen_design.
#pragma once

#include <array>
#include <vector>

#include "alcap/connected_surface.h"
#include "alcap/strokes.h"
#include "src/design/stroke_band.h"

namespace alcap::detail {

/// sum_k Re(conj(coefficient_k) u[vertex_k]). The square root of its weight in the quadratic form is multiplied in.
struct RealRow {
  std::vector<Index> vertex = {};
  std::vector<Complex<double>> coefficient = {};

  void add(Index v, Complex<double> c) {
    vertex.push_back(v);
    coefficient.push_back(c);
  }
};

struct DesignRows {
  std::vector<RealRow> across;  ///< added to the stiffness: what should be small
  std::vector<RealRow> along;   ///< added to the mass: what should be large
  /// A row on all vertices, empty without guidance: (Re(follow* u))^2 is taken from the stiffness.
  ComplexVectorX<double> follow = {};
};

/// A point of a stroke: weight ds, and conj(c^n) u there as coefficients of the face's corners.
struct StrokeSample {
  double ds = 0;
  std::array<Index, 3> vertex{};
  std::array<Complex<double>, 3> coefficient{};

  [[nodiscard]] Complex<double> at(const ComplexVectorX<double>& u) const {
    return coefficient[0] * u[vertex[0]] + coefficient[1] * u[vertex[1]] + coefficient[2] * u[vertex[2]];
  }
};

/// conj(c^n) u at the fraction s of a segment.
[[nodiscard]] StrokeSample sample_at(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                                     const SurfaceSegment& segment, double s);

/// Three Gauss points on every segment; their weights add up to the length.
[[nodiscard]] std::vector<StrokeSample> samples_along(const Mesh& mesh, const Geometry& geometry,
                                                      const Connection& connection, int n, const SurfacePolyline& line);

/// A stroke with a radius: every vertex of its band, weighted by its share of the length.
[[nodiscard]] std::vector<StrokeSample> samples_of_band(const std::vector<BandVertex>& band, int n);

/// Squares of `across` sum up to int (d/ds p)^2 + offset p^2 ds, p = Im(conj(c^n) u), those of `along` to
/// int (Re(conj(c^n) u))^2 ds.
[[nodiscard]] DesignRows stroke_rows(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                                     const SurfacePolyline& given, double offset);

/// The same spread over a band, with share for ds, hat / radius for the density of faces that lie in it, and d/ds p the
/// derivative, along the line's tangent carried there, of p interpolated linearly between vertices. `quarter`: the
/// band's angles are a quarter turn ahead of that tangent.
[[nodiscard]] DesignRows band_rows(const ConnectedSurface& surface, int n, const std::vector<BandVertex>& band,
                                   double offset, bool quarter);

}  // namespace alcap::detail
