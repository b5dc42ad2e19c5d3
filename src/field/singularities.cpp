// SPDX-License-Identifier: MIT
#include "alcap/singularities.h"

#include <algorithm>
#include <optional>
#include <string>

#include "alcap/operators.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"

namespace alcap {
namespace {

using Barycentric = std::array<double, 3>;

double argument(const Complex<double>& z) { return z == Complex<double>(0) ? 0.0 : std::arg(z); }

// Change of the field's argument along halfedge h, in [-pi, pi], from the arguments at its ends.
double turn(const Mesh& mesh, const Connection& connection, int n, Index h, double tail, double tip) {
  return wrap(tip - tail + n * connection.rho_along(mesh, h));
}
double turn_along(const Mesh& mesh, const Connection& connection, const Field& field, Index h) {
  return turn(mesh, connection, field.n, h, argument(field.u[mesh.tail(h)]), argument(field.u[mesh.tip(h)]));
}

// A field that is not finite has no turns.
int to_count(double turns) { return detail::rounded<int>(turns / (2 * pi<double>)).value_or(0); }

bool inside(const Barycentric& b) {
  constexpr double slack = 1e-12;
  return b[0] >= -slack && b[1] >= -slack && b[2] >= -slack;
}

// Newton's method from a start; at a zero the covariant derivative is the derivative. Steps are cut so that an iterate
// stays within a triangle's size of the face. `scale` is the largest modulus at the corners.
std::optional<Barycentric> newton(const FaceField& f, double scale, Barycentric b) {
  constexpr int max_steps = 40;
  for (int step = 0; step < max_steps; ++step) {
    const FieldValue at = f.at(b);
    if (std::abs(at.u) <= 1e-14 * scale) return b;
    const double det = (std::conj(at.d1) * at.d2).imag();
    if (det == 0.0) return std::nullopt;
    const double dx = (at.u * std::conj(at.d2)).imag() / det, dy = (at.d1 * std::conj(at.u)).imag() / det;
    Barycentric change;
    double largest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      change[i] = f.grad[i].real() * dx + f.grad[i].imag() * dy;
      largest = std::max(largest, std::abs(change[i]));
    }
    if (!std::isfinite(largest)) return std::nullopt;
    const double cut = largest > 0.5 ? 0.5 / largest : 1.0;
    for (std::size_t i = 0; i < 3; ++i) b[i] += cut * change[i];
    if (largest <= 1e-15) return b;
  }
  return std::abs(f.at(b).u) <= 1e-10 * scale ? std::optional(b) : std::nullopt;
}

std::optional<Barycentric> find_zero(const FaceField& f) {
  double scale = 0;
  for (const Complex<double>& u : f.u) scale = std::max(scale, std::abs(u));
  if (scale == 0) return std::nullopt;
  // A lattice of starts, the middle first: a field of index one in the face is nearly linear there and the first
  // succeeds.
  constexpr int n = 6;
  std::vector<Barycentric> starts{{1.0 / 3, 1.0 / 3, 1.0 / 3}};
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      const double a = (i + 1.0 / 3) / n, b = (j + 1.0 / 3) / n;
      starts.push_back({a, b, 1 - a - b});
    }
  for (const Barycentric& start : starts)
    if (const auto zero = newton(f, scale, start); zero && inside(*zero)) return zero;
  return std::nullopt;
}

void check_indices(const Mesh& mesh, const std::vector<int>& indices) {
  if (static_cast<Index>(indices.size()) != mesh.faces())
    throw OptionError("indices", std::to_string(indices.size()) + " entries", "needs one per face");
}

double positive_remainder(double angle, double period) {
  const double r = std::fmod(angle, period);
  return r < 0 ? r + period : r;
}

}  // namespace

std::vector<int> face_indices(const Mesh& mesh, const Connection& connection, const Field& field) {
  VectorX<double> arguments(mesh.vertices());
  parallel_for(mesh.vertices(), [&](std::int64_t v) { arguments[v] = argument(field.u[v]); });
  std::vector<int> indices(static_cast<std::size_t>(mesh.faces()));
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    double turns = field.n * connection.K[t];
    for (Index h = static_cast<Index>(3 * t); h < 3 * t + 3; ++h)
      turns += turn(mesh, connection, field.n, h, arguments[mesh.tail(h)], arguments[mesh.tip(h)]);
    indices[static_cast<std::size_t>(t)] = to_count(turns);
  });
  return indices;
}

int face_index(const Mesh& mesh, const Connection& connection, const Field& field, Index t) {
  double turns = field.n * connection.K[t];
  for (Index h = 3 * t; h < 3 * t + 3; ++h) turns += turn_along(mesh, connection, field, h);
  return to_count(turns);
}

std::vector<Singularity> find_singularities(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                                            const Field& field) {
  return find_singularities(mesh, geometry, connection, field, face_indices(mesh, connection, field));
}

std::vector<Singularity> find_singularities(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                                            const Field& field, const std::vector<int>& indices) {
  check_indices(mesh, indices);
  std::vector<Singularity> found;
  for (std::size_t t = 0; t < indices.size(); ++t)
    if (indices[t] != 0) found.push_back({.face = static_cast<Index>(t), .index = indices[t]});
  parallel_for(
      static_cast<std::int64_t>(found.size()),
      [&](std::int64_t i) {
        Singularity& s = found[static_cast<std::size_t>(i)];
        const FaceField f = face_field(mesh, geometry, connection, field.n, field.u, s.face);
        const std::optional<Barycentric> zero = find_zero(f);
        s.located = zero.has_value();
        s.barycentric = zero.value_or(Barycentric{1.0 / 3, 1.0 / 3, 1.0 / 3});
        // Near the zero u = a w + b conj(w), a half of div + i curl, b half of the reflected pair.
        const FieldValue at = f.at(s.barycentric);
        if (s.index > 0) {
          const double angle = std::arg(at.div_curl());
          s.orientation =
              field.n == 1 ? angle : positive_remainder(angle / (field.n - 1), 2 * pi<double> / (field.n - 1));
        } else {
          s.orientation = positive_remainder(std::arg(at.reflected()) / (field.n + 1), 2 * pi<double> / (field.n + 1));
        }
      },
      16);
  return found;
}

std::vector<IndexSum> index_sums(const Mesh& mesh, const Geometry&, const Connection& connection, const Field& field,
                                 const std::vector<int>& indices, const Topology& topology) {
  check_indices(mesh, indices);
  std::vector<IndexSum> sums(topology.components.size());
  for (std::size_t c = 0; c < sums.size(); ++c) sums[c].expected = field.n * std::int64_t{topology.components[c].euler};
  if (sums.size() == 1) {
    sums[0].sum =
        parallel_sum<std::int64_t>(mesh.faces(), [&](std::int64_t t) { return indices[static_cast<std::size_t>(t)]; });
  } else {
    for (std::size_t t = 0; t < indices.size(); ++t)
      sums[static_cast<std::size_t>(topology.face_component[t])].sum += indices[t];
  }
  // Turns of the field relative to the tangent of each boundary loop, the surface on the left.
  for (const Loop& loop : topology.loops) {
    double turns = 0;
    for (std::size_t k = 0; k < loop.halfedges.size(); ++k) {
      const Index h = loop.halfedges[k], next = loop.halfedges[(k + 1) % loop.halfedges.size()];
      // The corner as the connection sees it. Directions of edges grow around a vertex without a modulus: a connection
      // may turn its corners by more than half a turn.
      const double tangent = 2 * pi<double> + connection.rho_start(mesh, next) - connection.rho_end(mesh, h);
      turns += turn_along(mesh, connection, field, h) - field.n * (connection.eps_along(mesh, h) + tangent);
    }
    sums[static_cast<std::size_t>(loop.component)].expected += to_count(turns);
  }
  return sums;
}

}  // namespace alcap
