// SPDX-License-Identifier: MIT
//
// field.h: the result of every design: an n-vector field, one complex number per vertex together with the frames that
// give it meaning and n. u[v] = z^n where z is any of the n branches in the frame of vertex v: a vector field for n =
// 1, a line field for n = 2, a cross field for n = 4. Zero at vertices that no face uses.
//
//   Eigen::MatrixXd d = field.vectors(0);          // #V x 3, the first branch
//   auto unit = alcap::normalised(field);          // n-direction field (n-RoSy)
#pragma once

#include <vector>

#include "alcap/frames.h"

namespace alcap {

class ConnectedSurface;

struct Field {
  int n = 1;
  ComplexVectorX<double> u;              ///< #V, the n-th power of any branch, in vertex frames
  std::shared_ptr<const Frames> frames;  ///< of the vertices; empty only on surfaces that lie in no space

  /// Branch k (0 <= k < n) at vertex v: the n-th root of u[v] with argument (arg u + 2 pi k) / n.
  [[nodiscard]] Complex<double> branch(Index v, int k = 0) const;
  /// Branch k as vectors in space, #V x 3. Throws OptionError when k is out of range or there are no frames.
  [[nodiscard]] Positions<double> vectors(int k = 0) const;
  /// All n branches side by side, #V x 3n (the layout of raw fields).
  [[nodiscard]] Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> raw() const;
};

/// The n-direction field of an n-vector field: |u| = 1 wherever u is not zero.
[[nodiscard]] Field normalised(Field field);

/// From vectors in space (#V x 3, one branch each; projected to the tangent planes).
[[nodiscard]] Field from_vectors(int n, const Positions<double>& vectors, std::shared_ptr<const Frames> frames);

/// The same field in other frames of the same elements, such as those of another connection: its vectors in space,
/// projected to the tangent planes of the new frames where those differ, with |u| as it was. In equal frames the
/// numbers stay as they are, bit for bit. Throws OptionError when a field or its frames are of another size.
[[nodiscard]] Field on_frames(const Field& field, std::shared_ptr<const Frames> frames);

/// The field at the barycenters of the faces in face frames (#F): the closed-form basis of LTGD 2016, Sec. 4.3.
/// `frames` of the result are those of the faces. Throws OptionError on a surface that lies in no space and when the
/// field has not one value per vertex.
[[nodiscard]] Field at_faces(const ConnectedSurface& surface, const Field& field);

}  // namespace alcap
