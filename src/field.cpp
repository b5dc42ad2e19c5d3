// SPDX-License-Identifier: MIT
#include "alcap/field.h"

#include <string>

#include "alcap/operators.h"
#include "alcap/parallel.h"

namespace alcap {
namespace {

void check_degree(int n) {
  if (n < 1) throw OptionError("n", std::to_string(n), "the degree of a field is at least 1");
}

template <class T>
void check_frames(const Field<T>& field) {
  if (!field.frames || field.frames->X.rows() != field.u.size())
    throw OptionError("frames", field.frames ? std::to_string(field.frames->X.rows()) + " frames" : "none",
                      "vectors in space need one frame per value, " + std::to_string(field.u.size()));
}

}  // namespace

template <class T>
Complex<T> Field<T>::branch(Index v, int k) const {
  const T modulus = std::abs(u[v]);
  if (modulus == T(0)) return 0;
  return std::polar(std::pow(modulus, T(1) / T(n)), (std::arg(u[v]) + T(2) * pi<T> * T(k)) / T(n));
}

template <class T>
Positions<T> Field<T>::vectors(int k) const {
  if (k < 0 || k >= n) throw OptionError("k", std::to_string(k), "branches are numbered 0 to n - 1");
  check_frames(*this);
  Positions<T> out(u.size(), 3);
  parallel_for(u.size(), [&](std::int64_t v) {
    out.row(v) = frames->vector(static_cast<Index>(v), branch(static_cast<Index>(v), k));
  });
  return out;
}

template <class T>
Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> Field<T>::raw() const {
  check_frames(*this);
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> out(u.size(), 3 * n);
  parallel_for(u.size(), [&](std::int64_t v) {
    for (int k = 0; k < n; ++k)
      out.template block<1, 3>(v, 3 * k) = frames->vector(static_cast<Index>(v), branch(static_cast<Index>(v), k));
  });
  return out;
}

template <class T>
Field<T> normalised(Field<T> field) {
  parallel_for(field.u.size(), [&](std::int64_t v) {
    const T modulus = std::abs(field.u[v]);
    if (modulus > T(0)) field.u[v] /= modulus;
  });
  return field;
}

template <class T>
Field<T> from_vectors(int n, const Positions<T>& vectors, std::shared_ptr<const Frames<T>> frames) {
  check_degree(n);
  Field<T> field{n, ComplexVectorX<T>(vectors.rows()), std::move(frames)};
  check_frames(field);
  parallel_for(vectors.rows(), [&](std::int64_t v) {
    const Complex<T> z = field.frames->component(static_cast<Index>(v), vectors.row(v));
    field.u[v] = std::polar(std::pow(std::abs(z), T(n)), T(n) * std::arg(z));
  });
  return field;
}

template <class T>
Field<T> at_faces(const Mesh& mesh, const Geometry<T>& geometry, const Connection<T>& connection, const Field<T>& field,
                  std::shared_ptr<const Frames<T>> face_frames) {
  Field<T> out{field.n, ComplexVectorX<T>(mesh.faces()), std::move(face_frames)};
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    const FaceField<T> face = face_field(mesh, geometry, connection, field.n, field.u, static_cast<Index>(t));
    out.u[t] = face.at({T(1) / 3, T(1) / 3, T(1) / 3}).u;
  });
  return out;
}

#define ALCAP_INSTANTIATE(T)                                                                         \
  template struct Field<T>;                                                                          \
  template Field<T> normalised(Field<T>);                                                            \
  template Field<T> from_vectors(int, const Positions<T>&, std::shared_ptr<const Frames<T>>);        \
  template Field<T> at_faces(const Mesh&, const Geometry<T>&, const Connection<T>&, const Field<T>&, \
                             std::shared_ptr<const Frames<T>>);
ALCAP_INSTANTIATE(float)
ALCAP_INSTANTIATE(double)
#undef ALCAP_INSTANTIATE

}  // namespace alcap
