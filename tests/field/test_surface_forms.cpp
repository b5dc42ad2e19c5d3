// SPDX-License-Identifier: MIT
//
// Functions of fields, operators and energies give the same bits on a connected surface as on its parts, and keep their
// word on surfaces that lie in no space. Fields move to other frames with their vectors.
#include <doctest/doctest.h>

#include "alcap/alignment.h"
#include "alcap/connected_surface.h"
#include "alcap/energies.h"
#include "alcap/generators.h"
#include "alcap/operators.h"
#include "alcap/singularities.h"
#include "alcap/smoothest.h"
#include "alcap/streamlines.h"

using namespace alcap;

namespace {

ConnectedSurface bumpy() {
  const MeshData s = bumpy_sphere(3, 0.3, 3);
  return connect(Surface(s.V, s.F));
}

ConnectedSurface intrinsic() {
  const FlatTorus torus = flat_torus(8, 6);
  const Mesh mesh(torus.F, torus.vertices);
  VectorX<double> lengths(mesh.edges());
  for (Index e = 0; e < mesh.edges(); ++e) lengths[e] = torus.lengths.data()[mesh.halfedge(e)];
  return connect(Surface::from_lengths(mesh, lengths));
}

bool equal(const SparseMatrix<Complex<double>>& a, const SparseMatrix<Complex<double>>& b) {
  return a.nonZeros() == b.nonZeros() && (a - b).norm() == 0;
}

}  // namespace

TEST_CASE("a surface and its parts give the same bits") {
  const ConnectedSurface s = bumpy();
  const auto& mesh = s.mesh();
  const auto& geometry = s.geometry();
  const auto& connection = s.connection();
  for (const int n : {1, 4}) {
    CAPTURE(n);
    const SmoothestResult result = smoothest_field(s, {.n = n, .s = 0.5});
    const Field& field = result.field;
    CHECK(field.u == smoothest_field(mesh, geometry, connection, nullptr, {.n = n, .s = 0.5}).field.u);
    CHECK(field.frames == s.frames());

    const std::vector<int> indices = face_indices(s, field);
    CHECK(indices == face_indices(mesh, connection, field));
    CHECK(face_index(s, field, 5) == face_index(mesh, connection, field, 5));
    const auto found = find_singularities(s, field, indices);
    const auto expected = find_singularities(mesh, geometry, connection, field);
    REQUIRE(found.size() == expected.size());
    CHECK(find_singularities(s, field).size() == expected.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      CHECK(found[k].face == expected[k].face);
      CHECK(found[k].barycentric == expected[k].barycentric);
      CHECK(found[k].orientation == expected[k].orientation);
    }
    const auto sums = index_sums(s, field, indices);
    CHECK(sums[0].sum == 2 * n);
    CHECK(sums[0].expected == index_sums(mesh, geometry, connection, field, indices, s.topology())[0].expected);

    const OperatorOptions options{.n = n, .kind = OperatorKind::triangle};
    const FirstOrderOperators ops = first_order_operators(s, options);
    CHECK(ops.p == first_order_operators(mesh, geometry, connection, options).p);
    CHECK(ops.q == first_order_operators(mesh, geometry, connection, options).q);
    CHECK(operator_energies(s, ops, field.u).holomorphic ==
          operator_energies(mesh, geometry, ops, field.u).holomorphic);
    CHECK(face_field(s, n, field.u, 7).tau == face_field(mesh, geometry, connection, n, field.u, 7).tau);
    CHECK(field_energies(s, n, field.u).dirichlet == field_energies(mesh, geometry, connection, n, field.u).dirichlet);
    CHECK(flux_and_circulation(s, field.u, 11) == flux_and_circulation(mesh, geometry, connection, field.u, 11));

    const HermitianPattern pattern(mesh);
    StiffnessMass matrices = stiffness_and_mass(mesh, pattern, geometry, connection, n);
    CHECK(equal(energy_matrices(s, n).S, matrices.S));
    CHECK(equal(energy_matrices(s, n).M, matrices.M));
    apply_energy_family(mesh, pattern, geometry, connection, n, -0.5, matrices.S);
    CHECK(equal(energy_matrices(s, n, -0.5).S, matrices.S));
    CHECK(equal(curvature_and_boundary(s, n), curvature_and_boundary(mesh, pattern, geometry, connection, n)));
    CHECK(root_mean_square(s, field.u) == root_mean_square(mesh, geometry, field.u));
    const Field faces = at_faces(s, field);
    CHECK(*faces.frames == face_frames(s));
    CHECK(vertex_indices(s, faces) == vertex_indices(mesh, geometry, faces));
  }
  CHECK_THROWS_AS((void)energy_matrices(s, 1, 1.5), OptionError);
}

TEST_CASE("on a surface that lies in no space fields have no frames, and what needs points is refused") {
  const ConnectedSurface s = intrinsic();
  const SmoothestResult result = smoothest_field(s, {.n = 4});
  CHECK(result.field.frames == nullptr);
  CHECK(std::abs(result.components[0].lambda) < 1e-8);
  CHECK(face_indices(s, result.field) == std::vector<int>(static_cast<std::size_t>(s.mesh().faces()), 0));
  CHECK(energy_matrices(s, 4).S.rows() == s.mesh().vertices());
  CHECK_THROWS_AS((void)curvature_field(s), OptionError);
  CHECK_THROWS_AS((void)at_faces(s, result.field), OptionError);
  CHECK_THROWS_AS((void)streamlines(s, result.field), OptionError);
  CHECK_THROWS_AS((void)SurfaceLocator(s), OptionError);
  CHECK_THROWS_AS((void)stroke_through_points(s, {{0, {1, 0, 0}}, {1, {0, 1, 0}}}), OptionError);
  CHECK(stroke_along_vertices(s, {0, 1}).length() > 0);
}

TEST_CASE("a field on other frames keeps its directions in space and its lengths; on equal ones its bits") {
  const ConnectedSurface s = bumpy(), other = connect(s, {.kind = ConnectionKind::polar});
  for (const int n : {1, 2, 4}) {
    const Field field = smoothest_field(s, {.n = n}).field;
    const Field moved = on_frames(field, other.frames());
    CHECK(moved.n == n);
    CHECK(moved.frames == other.frames());
    CHECK_FALSE(*moved.frames == *field.frames);
    for (Index v = 0; v < s.mesh().vertices(); ++v) {
      CHECK(std::abs(moved.u[v]) == doctest::Approx(std::abs(field.u[v])).epsilon(1e-12));
      // Normals are the same: one of the branches points where the first one did.
      const Eigen::RowVector3d d = field.frames->vector(v, field.branch(v));
      double least = 10;
      for (int k = 0; k < n; ++k)
        least = std::min(least, (moved.frames->vector(v, moved.branch(v, k)) - d).norm() / d.norm());
      CHECK(least < 1e-12);
    }
    const auto equal_frames = std::make_shared<const Frames>(*field.frames);
    const Field same = on_frames(field, equal_frames);
    CHECK(same.u == field.u);
    CHECK(same.frames == equal_frames);
  }
}

TEST_CASE("lengths stay where the tangent planes differ") {
  const ConnectedSurface s = bumpy();
  Frames tilted = *s.frames();
  for (Index v = 0; v < s.mesh().vertices(); ++v) {
    tilted.N.row(v) = (tilted.N.row(v) + 0.3 * tilted.X.row(v)).normalized();
    tilted.X.row(v) = (tilted.X.row(v) - tilted.X.row(v).dot(tilted.N.row(v)) * tilted.N.row(v)).normalized();
  }
  const Field field = smoothest_field(s, {.n = 4}).field;
  const Field moved = on_frames(field, std::make_shared<const Frames>(tilted));
  const Field projected = from_vectors(4, field.vectors(0), std::make_shared<const Frames>(tilted));
  double shortened = 1;
  for (Index v = 0; v < s.mesh().vertices(); ++v) {
    CHECK(std::abs(moved.u[v]) == doctest::Approx(std::abs(field.u[v])).epsilon(1e-12));
    CHECK(std::abs(wrap(std::arg(moved.u[v]) - std::arg(projected.u[v]))) < 1e-9);
    shortened = std::min(shortened, std::abs(projected.u[v]) / std::abs(field.u[v]));
  }
  CHECK(shortened < 0.9);  // projection alone would have lost them
  CHECK_THROWS_AS((void)on_frames(field, std::make_shared<const Frames>()), OptionError);
}
