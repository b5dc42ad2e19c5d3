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

/// An n-vector field: one complex number per vertex, and the frames that give it meaning.
struct Field {
  int n = 1;                             ///< degree
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
/// field does not have one value per vertex.
[[nodiscard]] Field at_faces(const ConnectedSurface& surface, const Field& field);

/// The other way: a field given per face in face frames (#F), as a field at the vertices (#V). A vertex takes a mean of
/// its faces' values, each carried from the face's barycenter to the vertex by the connection,
///   u_v = sum_t w_t u_t exp(i n (rho_{v->t} + (tau_ij + tau_ik) / 3)) / sum_t w_t,
/// the inverse of the phases that at_faces() has there. The weights are mean value coordinates (Floater 2003) of the
/// vertex among the barycenters: positive, so that no mean is longer than what it is made of, and exact for linear
/// functions, so that the error of a smooth field is of second order; at boundary vertices, and where a barycenter sees
/// the next one behind the vertex, they are areas, and the error is of first order. Fields that are parallel around a
/// vertex come back to the last digits. Zero at vertices that no face uses. Throws OptionError when the field has not
/// one value per face.
[[nodiscard]] Field at_vertices(const ConnectedSurface& surface, const Field& face_field);

}  // namespace alcap
