// SPDX-License-Identifier: MIT
//
// curvature_means.h: the steps of curvature_field(), on one machine and over several ranks. Internal to src/field and
// src/distributed.
#pragma once

#include "alcap/alignment.h"
#include "alcap/connection.h"

namespace alcap::detail {

/// Per vertex.
struct CurvatureMeans {
  VectorX<double> area;      ///< a third of the faces around it
  ComplexVectorX<double> q;  ///< half the difference of the principal curvatures, its argument twice the direction's
  VectorX<double> mean;      ///< mean curvature times area, twice: the sign of the larger one
};

/// Throws OptionError.
void check_curvature_options(const CurvatureOptions& options);

/// Raw, right at vertices whose faces and their neighbours are all there.
[[nodiscard]] CurvatureMeans curvature_at_vertices(const Mesh& mesh, const Positions<double>& V,
                                                   const Geometry& geometry, const Connection& connection);

/// Each value becomes the mean over a vertex and its neighbours, carried to it by the connection.
void average_over_ring(const Mesh& mesh, const Connection& connection, CurvatureMeans& means);

/// The field's values.
[[nodiscard]] ComplexVectorX<double> curvature_components(const CurvatureMeans& means, const CurvatureOptions& options);

}  // namespace alcap::detail
