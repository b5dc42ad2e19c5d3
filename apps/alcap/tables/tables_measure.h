// SPDX-License-Identifier: MIT
//
// tables_measure.h: what all tables measure with: many fields as columns of one matrix, P u and Q u of all of them at
// once, quadrature over curved faces, and rows with observed orders.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "alcap/connection.h"
#include "alcap/generators.h"
#include "alcap/operators.h"
#include "apps/alcap/tables/tables.h"
#include "apps/alcap/tables/tables_published.h"
#include "src/base/parallel.h"

namespace alcap::app {

using Row = Eigen::RowVector3d;
using Fields = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();
inline constexpr std::array connection_names = {"polar", "polar-barycenter", "local", "global"};
inline constexpr std::array kind_names = {"edge", "triangle"};

inline Connection make_connection(const Mesh& mesh, const Geometry& geometry, std::size_t which) {
  switch (which) {
    case 0:
      return polar(mesh, geometry, {PolarCenter::incenter});
    case 1:
      return polar(mesh, geometry, {PolarCenter::barycenter});
    case 2:
      return locally_optimal(mesh, geometry);
    default:
      return globally_optimal(mesh, geometry);
  }
}

/// Calls body(begin, end) over rows in blocks that do not depend on the number of threads.
template <class Body>
void for_row_blocks(Eigen::Index rows, Body&& body) {
  constexpr Eigen::Index block = 512;
  parallel_for((rows + block - 1) / block, [&](std::int64_t b) { body(b * block, std::min(rows, (b + 1) * block)); },
               1);
}

/// Rows times coefficients.
inline Fields combine(const Eigen::MatrixXcd& rows, const Eigen::MatrixXcd& coefficients) {
  Fields out(rows.rows(), coefficients.cols());
  for_row_blocks(rows.rows(), [&](Eigen::Index begin, Eigen::Index end) {
    out.middleRows(begin, end - begin).noalias() = rows.middleRows(begin, end - begin) * coefficients;
  });
  return out;
}

/// Nodes and weights of a rule on the unit triangle, exact for degree 2 points - 2: Gauss-Legendre collapsed at a
/// corner.
struct TriangleRule {
  struct Node {
    double x, y, weight;
  };
  std::vector<Node> nodes;
  explicit TriangleRule(int points) {
    std::vector<std::array<double, 2>> gauss;
    for (int i = 0; i < points; ++i) {
      double x = std::cos(pi<double> * (i + 0.75) / (points + 0.5)), slope = 1;
      for (int step = 0; step < 8; ++step) {  // Newton on the Legendre polynomial
        double before = 1, now = x;
        for (int k = 2; k <= points; ++k) {
          const double next = ((2 * k - 1) * x * now - (k - 1) * before) / k;
          before = now;
          now = next;
        }
        slope = points * (x * now - before) / (x * x - 1);
        x -= now / slope;
      }
      gauss.push_back({(1 + x) / 2, 1 / ((1 - x * x) * slope * slope)});
    }
    for (const auto& [x, wx] : gauss)
      for (const auto& [y, wy] : gauss) nodes.push_back({x, y * (1 - x), wx * wy * (1 - x)});
  }
};

/// A mesh on a smooth surface, and the exact integrals of div + i curl over the part of it above each face, #F x
/// fields.
struct Shape {
  std::string name;
  int level;
  MeshData surface;
  Mesh mesh;
  Geometry geometry;
  double mean_edge;
  Fields exact;

  Shape(std::string name_, int level_, MeshData s)
      : name(std::move(name_)),
        level(level_),
        surface(std::move(s)),
        mesh(surface.F, surface.V.rows()),
        geometry(mesh, surface.V),
        mean_edge(geometry.lengths().mean()) {}
};

/// Per field, over some faces.
struct Sums {
  Eigen::ArrayXd div2, curl2, max_div, max_curl, antiholomorphic, holomorphic;
  double face_div = 0, face_curl = 0;  ///< largest root mean square over the fields, at one face
  explicit Sums(Eigen::Index fields)
      : div2(Eigen::ArrayXd::Zero(fields)),
        curl2(div2),
        max_div(div2),
        max_curl(div2),
        antiholomorphic(div2),
        holomorphic(div2) {}
  static Sums join(Sums a, const Sums& b) {
    a.div2 += b.div2;
    a.curl2 += b.curl2;
    a.max_div = a.max_div.max(b.max_div);
    a.max_curl = a.max_curl.max(b.max_curl);
    a.face_div = std::max(a.face_div, b.face_div);
    a.face_curl = std::max(a.face_curl, b.face_curl);
    a.antiholomorphic += b.antiholomorphic;
    a.holomorphic += b.holomorphic;
    return a;
  }
};

/// P u and Q u of all fields at once; against `exact` where it is given (P only).
inline Sums measure(const Mesh& mesh, const Geometry& geometry, const FirstOrderOperators& ops, const Fields& u,
                    const Fields* exact) {
  return parallel_reduce(
      mesh.faces(), Sums(u.cols()),
      [&](std::int64_t begin, std::int64_t end) {
        Sums s(u.cols());
        Eigen::Array<std::complex<double>, 1, Eigen::Dynamic> p(u.cols()), q(u.cols());
        for (std::int64_t t = begin; t < end; ++t) {
          p.setZero();
          q.setZero();
          for (Index h = static_cast<Index>(3 * t); h < 3 * t + 3; ++h) {
            p += ops.p[h] * u.row(mesh.tail(h)).array();
            q += ops.q[h] * u.row(mesh.tail(h)).array();
          }
          const double area = geometry.area(static_cast<Index>(t));
          s.antiholomorphic += p.abs2().transpose() / (2 * area);
          s.holomorphic += q.abs2().transpose() / (2 * area);
          if (!exact) continue;
          p -= exact->row(t).array();
          s.div2 += p.real().square().transpose();
          s.curl2 += p.imag().square().transpose();
          s.max_div = s.max_div.max(p.real().abs().transpose() / area);
          s.max_curl = s.max_curl.max(p.imag().abs().transpose() / area);
          s.face_div = std::max(s.face_div, std::sqrt(p.real().square().mean()) / area);
          s.face_curl = std::max(s.face_curl, std::sqrt(p.imag().square().mean()) / area);
        }
        return s;
      },
      Sums::join);
}

inline double order(double coarse, double fine, double lengths) {
  return coarse > 0 && fine > 0 ? std::log(coarse / fine) / std::log(lengths) : nan;
}

/// Fills the orders of the last row from the previous one of the same sphere, connection and kind.
template <class R, class Same>
const R* coarser(const std::vector<R>& rows, Same&& same) {
  for (auto r = rows.rbegin(); r != rows.rend(); ++r)
    if (same(*r)) return &*r;
  return nullptr;
}

inline void add_operator_row(const Shape& shape, const char* connection, const char* kind, const Sums& s,
                             const Eigen::ArrayXd& exact_energy, std::vector<OperatorRow>& rows) {
  OperatorRow row{.sphere = shape.name,
                  .level = shape.level,
                  .vertices = shape.mesh.vertices(),
                  .mean_edge = shape.mean_edge,
                  .connection = connection,
                  .kind = kind,
                  .l2_div = s.div2.sqrt().mean(),
                  .l2_curl = s.curl2.sqrt().mean(),
                  .linf_div = s.max_div.mean(),
                  .linf_curl = s.max_curl.mean(),
                  .face_div = s.face_div,
                  .face_curl = s.face_curl,
                  .energy = ((s.antiholomorphic + s.holomorphic) / 2 - exact_energy).abs().mean()};
  const published::Operators paper = published::operators(row.sphere, row.vertices, row.connection, row.kind);
  row.paper_l2_div = paper.l2_div;
  row.paper_l2_curl = paper.l2_curl;
  row.paper_linf_div = paper.linf_div;
  row.paper_linf_curl = paper.linf_curl;
  row.paper_energy = paper.energy;
  const OperatorRow* before = coarser(rows, [&](const OperatorRow& r) {
    return r.sphere == row.sphere && r.connection == row.connection && r.kind == row.kind;
  });
  const auto observed = [&](double OperatorRow::*error) {
    return before ? order(before->*error, row.*error, before->mean_edge / row.mean_edge) : nan;
  };
  row.order_l2_div = observed(&OperatorRow::l2_div);
  row.order_l2_curl = observed(&OperatorRow::l2_curl);
  row.order_linf_div = observed(&OperatorRow::linf_div);
  row.order_linf_curl = observed(&OperatorRow::linf_curl);
  row.order_energy = observed(&OperatorRow::energy);
  rows.push_back(row);
}

}  // namespace alcap::app
