// SPDX-License-Identifier: MIT
//
// tables_harmonics.h: real spherical harmonics with their gradients, and random combinations of them.
//
// Numbered by l = 1, 2, ... and m = -l ... l: k = l^2 - 1 + l + m. Orthonormal on the unit sphere. The vector harmonics
// grad Y / sqrt(l(l+1)) and n x grad Y / sqrt(l(l+1)) are orthonormal as well; as n x is multiplication by i in any
// tangent frame, one complex coefficient per k holds a field of both.
#pragma once

#include <cmath>
#include <cstdint>

#include <Eigen/Core>

#include "src/base/numbers.h"

namespace alcap::app {

inline constexpr int max_harmonics = 48;  // l = 1 ... 6

/// l of harmonic k.
inline int harmonic_degree(int k) { return detail::to_integer(std::sqrt(k + 1.5), 0, 46340); }

/// Y_k at a point of the unit sphere, k < values.size() <= max_harmonics.
void harmonics(const Eigen::RowVector3d& p, Eigen::Ref<Eigen::VectorXd> values);

/// Gradients of Y_k / sqrt(l(l+1)) in the tangent plane at a point of the unit sphere, one row per k.
void harmonic_gradients(const Eigen::RowVector3d& p, Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, 3>> gradients);

/// count x fields complex Gaussian coefficients, each column of norm 1: fields of unit L2 norm.
[[nodiscard]] Eigen::MatrixXcd random_coefficients(int count, int fields, std::uint64_t seed);

}  // namespace alcap::app
