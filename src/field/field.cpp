// SPDX-License-Identifier: MIT
#include "alcap/field.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "alcap/connected_surface.h"
#include "src/base/parallel.h"
#include "src/field/branches.h"
#include "src/simd/angles.h"

namespace alcap {
namespace {

void check_degree(int n) {
  if (n < 1) throw OptionError("n", n, "the degree of a field is at least 1");
}

void check_frames(const Field& field) {
  if (!field.frames || field.frames->X.rows() != field.u.size())
    throw OptionError("frames", field.frames ? std::to_string(field.frames->X.rows()) + " frames" : "none",
                      "vectors in space need one frame per value, " + std::to_string(field.u.size()));
}

/// The barycenter of a face as one of its corners sees it.
struct BarycenterSeen {
  Index corner = none;
  double distance = 0;
  double after = 0, before = 0;  ///< its angle from the corner's first edge, and to the second
  double weight = 0;             ///< the face's area, to begin with
};

BarycenterSeen barycenter_seen(const Mesh& mesh, const Geometry& geometry, Index h) {
  const double first = geometry.length(mesh.edge(h)), second = geometry.length(mesh.edge(Mesh::prev(h)));
  const Complex<double> way = first + std::polar(second, geometry.angle(h));
  return {h, std::abs(way) / 3, std::arg(way), geometry.angle(h) - std::arg(way), geometry.area(Mesh::face(h))};
}

// Mean value coordinates (Floater 2003) of an interior vertex in the polygon of its faces' barycenters, laid out with
// angles scaled to 2 pi: positive, and exact for linear functions there. Areas stay where a side of the polygon is seen
// under a straight angle or more.
void use_mean_values(double scale, std::vector<BarycenterSeen>& ring) {
  constexpr double widest = 0.99 * pi<double>;
  const auto seen = [&](std::size_t k) {
    return scale * (ring[k].before + ring[k + 1 == ring.size() ? 0 : k + 1].after);
  };
  for (std::size_t k = 0; k < ring.size(); ++k)
    if (!(seen(k) < widest)) return;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const double left = seen(k), right = seen(k == 0 ? ring.size() - 1 : k - 1);
    ring[k].weight = (std::tan(left / 2) + std::tan(right / 2)) / ring[k].distance;
  }
}

// The weighted mean of the ring's values, each carried from its barycenter to the vertex.
Complex<double> mean_at_vertex(const Connection& connection, const std::vector<BarycenterSeen>& ring,
                               const Field& face_field) {
  Complex<double> sum = 0;
  double total = 0;
  for (const BarycenterSeen& face : ring) {
    const Index h = face.corner;
    // tau along prev(h) runs towards the vertex: tau_ik = -tau_ki.
    const double angle = connection.rho_t[h] + (connection.tau[h] - connection.tau[Mesh::prev(h)]) / 3;
    sum += face.weight * detail::turned(face_field.u[Mesh::face(h)], std::polar(1.0, face_field.n * angle));
    total += face.weight;
  }
  return total > 0 ? sum / total : Complex<double>(0);
}

}  // namespace

Complex<double> Field::branch(Index v, int k) const {
  const int half = detail::independent_branches(n);
  const Complex<double> root = detail::principal_root(u[v], n);
  const Complex<double> z = detail::turned(root, detail::branch_turn(k % half, n));
  return k < half ? z : detail::opposite(z);
}

Positions<double> Field::vectors(int k) const {
  if (k < 0 || k >= n) throw OptionError("k", k, "branches are numbered 0 to n - 1");
  check_frames(*this);
  const detail::Branches branches(n);
  Positions<double> out(u.size(), 3);
  parallel_for(u.size(), [&](std::int64_t v) { out.row(v) = branches.at(*this, static_cast<Index>(v)).vector(k); });
  return out;
}

Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> Field::raw() const {
  check_frames(*this);
  const detail::Branches branches(n);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> out(u.size(), 3 * n);
  parallel_for(u.size(), [&](std::int64_t v) {
    const auto here = branches.at(*this, static_cast<Index>(v));
    for (int k = 0; k < n; ++k) out.template block<1, 3>(v, 3 * k) = here.vector(k);
  });
  return out;
}

Field normalised(Field field) {
  parallel_for(field.u.size(), [&](std::int64_t v) {
    const double modulus = std::abs(field.u[v]);
    if (modulus > double(0)) field.u[v] /= modulus;
  });
  return field;
}

Field from_vectors(int n, const Positions<double>& vectors, std::shared_ptr<const Frames> frames) {
  check_degree(n);
  Field field{n, ComplexVectorX<double>(vectors.rows()), std::move(frames)};
  check_frames(field);
  parallel_for(vectors.rows(), [&](std::int64_t v) {
    const Complex<double> z = field.frames->component(static_cast<Index>(v), vectors.row(v));
    field.u[v] = std::polar(std::pow(std::abs(z), double(n)), double(n) * std::arg(z));
  });
  return field;
}

Field on_frames(const Field& field, std::shared_ptr<const Frames> frames) {
  check_frames(field);
  if (frames && *field.frames == *frames) return {field.n, field.u, std::move(frames)};
  Field moved = from_vectors(field.n, field.vectors(0), std::move(frames));
  parallel_for(moved.u.size(),
               [&](std::int64_t v) { moved.u[v] = std::polar(std::abs(field.u[v]), std::arg(moved.u[v])); });
  return moved;
}

Field at_faces(const ConnectedSurface& surface, const Field& field) {
  const Mesh& mesh = surface.mesh();
  const Connection& connection = surface.connection();
  if (field.u.size() != mesh.vertices())
    throw OptionError("u", std::to_string(field.u.size()) + " entries",
                      "needs one entry per vertex of the mesh, " + std::to_string(mesh.vertices()));
  // kernels/basis.h at the barycenter, the phases of many corners at a time.
  constexpr std::int64_t block = 256;
  Field out{field.n, ComplexVectorX<double>(mesh.faces()), std::make_shared<const Frames>(face_frames(surface))};
  parallel_ranges(mesh.faces(), block, [&](std::int64_t begin, std::int64_t end) {
    std::array<double, 3 * block> angles;
    std::array<Complex<double>, 3 * block> phases;
    for (std::int64_t first = begin; first < end; first += block) {
      const std::int64_t count = std::min(block, end - first);
      const double* const rho = connection.rho_t.data() + 3 * first;
      const double* const tau = connection.tau.data() + 3 * first;
      for (std::int64_t i = 0; i < 3 * count; i += 3)
        for (std::int64_t c = 0; c < 3; ++c)
          angles[static_cast<std::size_t>(i + c)] = rho[i + c] + (tau[i + c] - tau[i + (c + 2) % 3]) / 3;
      detail::unit_numbers(3 * count, angles.data(), -double(field.n), phases.data());
      for (std::int64_t i = 0; i < count; ++i) {
        Complex<double> sum = 0;
        for (std::int64_t c = 0; c < 3; ++c)
          sum += detail::turned(field.u[mesh.F()(first + i, c)], phases[static_cast<std::size_t>(3 * i + c)]);
        out.u[first + i] = sum / double(3);
      }
    }
  });
  return out;
}

Field at_vertices(const ConnectedSurface& surface, const Field& face_field) {
  const Mesh& mesh = surface.mesh();
  const Connection& connection = surface.connection();
  check_degree(face_field.n);
  if (face_field.u.size() != mesh.faces())
    throw OptionError("u", std::to_string(face_field.u.size()) + " entries",
                      "needs one entry per face of the mesh, " + std::to_string(mesh.faces()));
  Field out{face_field.n, ComplexVectorX<double>(mesh.vertices()), surface.in_space() ? surface.frames() : nullptr};
  parallel_ranges(mesh.vertices(), 256, [&](std::int64_t begin, std::int64_t end) {
    std::vector<BarycenterSeen> ring;
    for (auto v = static_cast<Index>(begin); v < end; ++v) {
      ring.clear();
      mesh.for_each_outgoing(v, [&](Index h) { ring.push_back(barycenter_seen(mesh, surface.geometry(), h)); });
      if (!mesh.boundary_vertex(v)) use_mean_values(2 * pi<double> / surface.geometry().angle_sum(v), ring);
      out.u[v] = mean_at_vertex(connection, ring, face_field);
    }
  });
  return out;
}

}  // namespace alcap
