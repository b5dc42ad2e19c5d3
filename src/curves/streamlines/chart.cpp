// SPDX-License-Identifier: MIT
//
// chart.cpp: from fields and connections to charts.
#include "src/curves/streamlines/chart.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <string>

#include "src/base/array.h"
#include "src/base/parallel.h"
#include "src/connection/edge_to_face.h"
#include "src/mesh/position.h"

namespace alcap::detail {
namespace {

void check_rows(const char* what, std::int64_t rows, std::int64_t expected) {
  if (rows != expected)
    throw OptionError(what, std::to_string(rows) + " rows", "must have " + std::to_string(expected) + " for this mesh");
}

}  // namespace

Flow::Flow(const ConnectedSurface& surface, const Field& field)
    : mesh_(surface.mesh()),
      V_(surface.positions()),
      geometry_(surface.geometry()),
      connection_(surface.connection()),
      field_(field) {
  if (field.n < 1) throw OptionError("field.n", field.n, "must be at least 1");
  check_rows("field.u", field.u.size(), mesh_.vertices());
  Eigen::RowVector3d low = Eigen::RowVector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (Index v = 0; v < mesh_.vertices(); ++v) {
    if (!mesh_.referenced(v)) continue;
    if (!V_.row(v).allFinite() || !std::isfinite(field.u[v].real()) || !std::isfinite(field.u[v].imag()))
      throw OptionError(V_.row(v).allFinite() ? "field.u" : "V", "not finite",
                        "vertex " + std::to_string(v) + " must have finite values");
    low = low.cwiseMin(V_.row(v));
    high = high.cwiseMax(V_.row(v));
  }
  diagonal_ = (high - low).norm();
  if (!(diagonal_ > 0) || !std::isfinite(diagonal_))
    throw OptionError("V", diagonal_, "the box around the vertices must have a diagonal");
  mean_edge_ = geometry_.lengths().mean();
  zeros_ = find_singularities(surface, field);
  zero_of_.assign(detail::at(mesh_.faces()), none);
  for (std::size_t k = 0; k < zeros_.size(); ++k) zero_of_[detail::at(zeros_[k].face)] = static_cast<Index>(k);
}

Flow::Kept Flow::kept(Index t) const {
  Kept out;
  out.corner = geometry_.length(mesh_.edge(3 * t + 2)) * kernels::unit(geometry_.angle(3 * t));
  for (int c = 0; c < 3; ++c) {
    const Index h = 3 * t + c;
    const Complex<double> u = field_.u[mesh_.tail(h)];
    out.value[c] = Cplx{u.real(), u.imag()} * kernels::unit(-field_.n * connection_.rho_t[h]);
  }
  return out;
}

void Flow::keep_charts() {
  constexpr Index most = 3 * (Index{1} << 19);
  if (mesh_.faces() > most) return;
  std::vector<Kept> all(detail::at(mesh_.faces()));
  parallel_for(mesh_.faces(), [&](std::int64_t k) {
    const auto t = static_cast<Index>(k);
    const Eigen::RowVector3d n = normal(t);
    all[detail::at(k)] = kept(t);
    all[detail::at(k)].normal = {n[0], n[1], n[2]};
  });
  kept_ = std::move(all);
}

FaceChart Flow::chart(Index t, int sign) const {
  FaceChart out;
  out.face = t;
  const Kept ready = kept_.empty() ? kept(t) : kept_[detail::at(t)];
  const double n = field_.n, l0 = geometry_.length(mesh_.edge(3 * t)), l1 = geometry_.length(mesh_.edge(3 * t + 1)),
               l2 = geometry_.length(mesh_.edge(3 * t + 2));
  out.size = std::max({l0, l1, l2});
  out.corner[0] = {0, 0};
  out.corner[1] = {l0, 0};
  out.corner[2] = ready.corner;
  const double half = 0.5 / geometry_.area(t), flip = sign < 0 && field_.n % 2 == 1 ? -1.0 : 1.0;
  for (int c = 0; c < 3; ++c) {
    const Index h = 3 * t + c;
    out.grad[c] = half * kernels::times_i(out.corner[(c + 2) % 3] - out.corner[(c + 1) % 3]);
    out.turn[c] = n * connection_.tau[h];
    out.value[c] = flip * ready.value[c];
  }
  return out;
}

Cplx Flow::across(Index h, double s) const {
  // Seen from the twin the edge points the other way.
  return -kernels::unit(edge_to_face_at(mesh_, connection_, h, s) -
                        edge_to_face_at(mesh_, connection_, mesh_.twin(h), 1 - s));
}

Straight Flow::straight_on(const SurfacePoint& p, Cplx w, double length, std::int64_t most,
                           std::vector<SurfacePoint>& crossed, Cplx& turned) const {
  // A bound for walks around a vertex in ever thinner faces.
  const std::int64_t most_faces = std::min({most, std::int64_t{100'000}, 1000 + 4 * std::int64_t{mesh_.faces()}});
  constexpr double off_vertex = 1e-9;  // of an edge: vertices are passed by
  SurfacePoint at = p;
  crossed.push_back(p);
  turned = {1, 0};
  Index entry = none;
  for (std::int64_t k = 0; k < most_faces; ++k) {
    const FaceChart here = chart(at.face);
    Index exit = none;
    double ahead = std::numeric_limits<double>::infinity();
    for (Index c = 0; c < 3; ++c) {
      const double rate = dot(here.grad[c], w), b = at.barycentric[detail::at(c)];
      if (c == entry || !(rate < 0) || -b / rate >= ahead) continue;
      exit = c;
      ahead = -b / rate;
    }
    if (exit == none || ahead >= length) {
      if (exit == none) return Straight::lost;
      at.barycentric = clamped(here.moved(at.barycentric, length * w));
      crossed.push_back(at);
      return Straight::there;
    }
    length -= ahead;
    at.barycentric = here.moved(at.barycentric, ahead * w);
    at.barycentric[detail::at(exit)] = 0;
    at.barycentric = clamped(at.barycentric);
    const Index h = 3 * at.face + (exit + 1) % 3, g = mesh_.twin(h);
    if (g == none) return Straight::boundary;
    crossed.push_back(at);
    const double s = std::clamp(at.barycentric[detail::at((exit + 2) % 3)], off_vertex, 1 - off_vertex);
    const Cplx turn = kernels::unit(geometry_.direction(g) + pi<double> - geometry_.direction(h));
    w = w * turn;
    turned = turned * turn;
    at = on_halfedge(g, 1 - s);
    entry = (g + 2) % 3;
  }
  return Straight::lost;
}

Eigen::RowVector3d Flow::position(Index t, const Barycentric& b) const { return detail::position(mesh_, V_, {t, b}); }

Eigen::RowVector3d Flow::direction(const FaceChart& chart, const Cplx& v) const {
  return position(chart.face, {dot(chart.grad[0], v), dot(chart.grad[1], v), dot(chart.grad[2], v)});
}

Eigen::RowVector3d Flow::normal(Index t) const {
  if (!kept_.empty()) return Eigen::RowVector3d::Map(kept_[detail::at(t)].normal.data());
  const Eigen::RowVector3d a = V_.row(mesh_.F()(t, 0));
  return (Eigen::RowVector3d(V_.row(mesh_.F()(t, 1))) - a)
      .cross(Eigen::RowVector3d(V_.row(mesh_.F()(t, 2))) - a)
      .stableNormalized();
}

}  // namespace alcap::detail
