// SPDX-License-Identifier: MIT
//
// operators.cpp: P and Q of every face from the kernels, and evaluation at points.
#include "alcap/operators.h"

#include <algorithm>
#include <string>

#include "kernels/basis.h"
#include "kernels/edge_operators.h"
#include "src/base/parallel.h"
#include "src/connection/edge_to_face.h"
#include "src/connection/triangle_frame.h"

namespace alcap {
namespace {

using kernels::Cplx;

Cplx<double> to_kernel(const Complex<double>& z) { return {z.real(), z.imag()}; }
Complex<double> from_kernel(const Cplx<double>& z) { return {z.re, z.im}; }
// Without the checks for infinities of the standard product.
Complex<double> product(const Complex<double>& a, const Complex<double>& b) {
  return from_kernel(to_kernel(a) * to_kernel(b));
}

void check_size(const char* name, std::int64_t size, std::int64_t expected, const char* rule) {
  if (size != expected)
    throw OptionError(name, std::to_string(size) + " entries", std::string(rule) + ", " + std::to_string(expected));
}
void check_vertices(const Mesh& mesh, std::int64_t size) {
  check_size("u", size, mesh.vertices(), "needs one entry per vertex of the mesh");
}
void check_coefficients(const Mesh& mesh, std::int64_t size) {
  check_size("coefficients", size, mesh.halfedges(), "needs three entries per face of the mesh");
}

void check_halfedge(const Mesh& mesh, Index h) {
  if (h < 0 || h >= mesh.halfedges())
    throw OptionError("h", h, "must be a halfedge, 0 to " + std::to_string(mesh.halfedges() - 1));
}

kernels::EdgeOperator<double> halfedge_operator(const Mesh& mesh, const Geometry& geometry,
                                                const Connection& connection, double n, Index h) {
  return kernels::edge_operator(geometry.length(mesh.edge(h)), connection.rho_start(mesh, h),
                                connection.rho_end(mesh, h), connection.eps_along(mesh, h), geometry.direction(h), n);
}

kernels::TriangleOperator<double> edge_based(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                                             double n, Index t) {
  kernels::TriangleOperator<double> sum{};
  for (Index c = 0; c < 3; ++c) {
    const Index h = 3 * t + c, next = (c + 1) % 3;
    kernels::EdgeOperator<double> e = halfedge_operator(mesh, geometry, connection, n, h);
    if (connection.alpha.size()) {
      // Values go from the edge to the face by edge_to_face = alpha - direction; the direction of dl stays.
      const Cplx<double> turn = kernels::unit(-(n * connection.alpha[h]));
      e = {turn * e.p_start, turn * e.p_end, turn * e.q_start, turn * e.q_end};
    }
    sum.p[c] = sum.p[c] + e.p_start;
    sum.q[c] = sum.q[c] + e.q_start;
    sum.p[next] = sum.p[next] + e.p_end;
    sum.q[next] = sum.q[next] + e.q_end;
  }
  return sum;
}

ComplexVectorX<double> per_face(const Mesh& mesh, const ComplexVectorX<double>& a, const ComplexVectorX<double>& u) {
  ComplexVectorX<double> out(mesh.faces());
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    Complex<double> sum = 0;
    for (Index h = static_cast<Index>(3 * t); h < 3 * t + 3; ++h) sum += product(a[h], u[mesh.tail(h)]);
    out[t] = sum;
  });
  return out;
}

}  // namespace

FirstOrderOperators first_order_operators(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                                          const OperatorOptions& options) {
  FirstOrderOperators out{options, ComplexVectorX<double>(mesh.halfedges()), ComplexVectorX<double>(mesh.halfedges())};
  const double n = static_cast<double>(options.n);
  parallel_for(
      mesh.faces(),
      [&](std::int64_t i) {
        const Index t = static_cast<Index>(i);
        const kernels::TriangleOperator<double> op =
            options.kind == OperatorKind::edge
                ? edge_based(mesh, geometry, connection, n, t)
                : kernels::triangle_operator(detail::triangle_frame(mesh, geometry, connection, t), geometry.area(t),
                                             n);
        for (Index c = 0; c < 3; ++c) {
          out.p[3 * t + c] = from_kernel(op.p[c]);
          out.q[3 * t + c] = from_kernel(op.q[c]);
        }
      },
      256);  // a face costs about a microsecond
  return out;
}

ComplexVectorX<double> apply(const Mesh& mesh, const ComplexVectorX<double>& coefficients,
                             const ComplexVectorX<double>& u) {
  check_coefficients(mesh, coefficients.size());
  check_vertices(mesh, u.size());
  return per_face(mesh, coefficients, u);
}

ComplexVectorX<double> apply_adjoint(const Mesh& mesh, const ComplexVectorX<double>& coefficients,
                                     const ComplexVectorX<double>& faces) {
  check_coefficients(mesh, coefficients.size());
  check_size("faces", faces.size(), mesh.faces(), "needs one entry per face of the mesh");
  ComplexVectorX<double> out(mesh.vertices());
  parallel_for(mesh.vertices(), [&](std::int64_t v) {
    Complex<double> sum = 0;
    mesh.for_each_outgoing(static_cast<Index>(v),
                           [&](Index h) { sum += product(std::conj(coefficients[h]), faces[Mesh::face(h)]); });
    out[v] = sum;
  });
  return out;
}

FaceVertexMatrix face_vertex_matrix(const Mesh& mesh, const ComplexVectorX<double>& coefficients) {
  check_coefficients(mesh, coefficients.size());
  FaceVertexMatrix A(mesh.faces(), mesh.vertices());
  A.resizeNonZeros(mesh.halfedges());
  parallel_for(std::int64_t{mesh.faces()} + 1,
               [&](std::int64_t t) { A.outerIndexPtr()[t] = static_cast<Index>(3 * t); });
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    std::array<Index, 3> order;
    for (Index c = 0; c < 3; ++c) order[static_cast<std::size_t>(c)] = static_cast<Index>(3 * t + c);
    std::sort(order.begin(), order.end(), [&](Index a, Index b) { return mesh.tail(a) < mesh.tail(b); });
    std::int64_t slot = 3 * t;
    for (const Index h : order) {
      A.innerIndexPtr()[slot] = mesh.tail(h);
      A.valuePtr()[slot++] = coefficients[h];
    }
  });
  return A;
}

OperatorEnergies operator_energies(const Mesh& mesh, const Geometry& geometry, const FirstOrderOperators& operators,
                                   const ComplexVectorX<double>& u) {
  const auto half_squares = [&](const ComplexVectorX<double>& coefficients) {
    const ComplexVectorX<double> f = apply(mesh, coefficients, u);
    return 0.5 * parallel_sum<double>(mesh.faces(), [&](std::int64_t t) {
             return static_cast<double>(std::norm(f[t]) / geometry.area(static_cast<Index>(t)));
           });
  };
  return {half_squares(operators.p), half_squares(operators.q)};
}

Complex<double> flux_and_circulation(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                                     const ComplexVectorX<double>& u, Index h) {
  check_vertices(mesh, u.size());
  const kernels::EdgeOperator<double> e = halfedge_operator(mesh, geometry, connection, double(1), h);
  return product(from_kernel(e.p_start), u[mesh.tail(h)]) + product(from_kernel(e.p_end), u[mesh.tip(h)]);
}

FaceField face_field(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                     const ComplexVectorX<double>& u, Index t) {
  check_vertices(mesh, u.size());
  if (t < 0 || t >= mesh.faces()) throw OptionError("t", t, "must be a face, 0 to " + std::to_string(mesh.faces() - 1));
  const kernels::TriangleFrame<double> f = detail::triangle_frame(mesh, geometry, connection, t);
  FaceField out;
  out.n = static_cast<double>(n);
  for (std::size_t c = 0; c < 3; ++c) {
    out.rho[c] = f.rho[c];
    out.tau[c] = f.tau[c];
    out.grad[c] = from_kernel(f.grad[c]);
    out.u[c] = u[mesh.F()(t, static_cast<Eigen::Index>(c))];
  }
  return out;
}

FieldValue FaceField::at(const std::array<double, 3>& barycentric) const {
  kernels::TriangleFrame<double> f;
  Cplx<double> corner[3];
  double b[3];
  for (std::size_t c = 0; c < 3; ++c) {
    f.rho[c] = rho[c];
    f.tau[c] = tau[c];
    f.grad[c] = to_kernel(grad[c]);
    corner[c] = to_kernel(u[c]);
    b[c] = barycentric[c];
  }
  const kernels::FieldAt<double> x = kernels::field_at(f, corner, b, n);
  return {from_kernel(x.value), from_kernel(x.d1), from_kernel(x.d2)};
}

EdgeField edge_field(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                     const ComplexVectorX<double>& u, Index h) {
  check_vertices(mesh, u.size());
  check_halfedge(mesh, h);
  return {.n = static_cast<double>(n),
          .rho_tail = connection.rho_start(mesh, h),
          .rho_tip = connection.rho_end(mesh, h),
          .eps = connection.eps_along(mesh, h),
          .length = geometry.length(mesh.edge(h)),
          .u_tail = u[mesh.tail(h)],
          .u_tip = u[mesh.tip(h)]};
}

EdgeValue EdgeField::at(double s) const {
  const Complex<double> tail = product(u_tail, from_kernel(kernels::unit(-n * (rho_tail + eps * s))));
  const Complex<double> tip = product(u_tip, from_kernel(kernels::unit(-n * (rho_tip - eps * (1 - s)))));
  return {(1 - s) * tail + s * tip, (tip - tail) / length};
}

double edge_to_face(const Mesh& mesh, const Connection& connection, Index h, double s) {
  check_halfedge(mesh, h);
  return detail::edge_to_face_at(mesh, connection, h, s);
}

}  // namespace alcap
