// SPDX-License-Identifier: MIT
//
// Surfaces: every kind of array gives the same one, bad arrays are refused by name, and what is moved in is not copied.
#include "alcap/surface.h"

#include <doctest/doctest.h>

#include <cstring>
#include <limits>
#include <utility>

#include "alcap/generators.h"

using namespace alcap;

namespace {

/// The same mesh and geometry, bit for bit.
bool same(const Surface& a, const Surface& b) {
  const auto bits = [](const auto& x, const auto& y) {
    return x.size() == y.size() &&
           std::memcmp(x.data(), y.data(), sizeof(x[0]) * static_cast<std::size_t>(x.size())) == 0;
  };
  return a.V() == b.V() && a.F() == b.F() && bits(a.geometry().lengths(), b.geometry().lengths()) &&
         bits(a.geometry().angles(), b.geometry().angles()) && a.mesh().edges() == b.mesh().edges() &&
         a.topology().euler() == b.topology().euler();
}

/// Numbers row by row.
template <class T, class Matrix>
std::vector<T> row_by_row(const Matrix& m) {
  std::vector<T> out;
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    for (Eigen::Index k = 0; k < 3; ++k) out.push_back(static_cast<T>(m(i, k)));
  return out;
}

template <class T, class Matrix>
std::vector<std::array<T, 3>> rows_of(const Matrix& m) {
  std::vector<std::array<T, 3>> out;
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    out.push_back({static_cast<T>(m(i, 0)), static_cast<T>(m(i, 1)), static_cast<T>(m(i, 2))});
  return out;
}

template <class T>
void check_faces_of(const MeshData& s, const Surface& expected) {
  using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  using RowMatrix = Eigen::Matrix<T, Eigen::Dynamic, 3, Eigen::RowMajor>;
  const Matrix columns = s.F.cast<T>();
  const RowMatrix rows = s.F.cast<T>();
  const Matrix transposed = columns.transpose();
  Matrix wide(columns.rows() + 2, 5);
  wide.setConstant(7);
  wide.block(1, 2, columns.rows(), 3) = columns;
  const std::vector<T> numbers = row_by_row<T>(s.F);
  const std::vector<std::array<T, 3>> triples = rows_of<T>(s.F);
  CHECK(same(Surface(s.V, columns), expected));
  CHECK(same(Surface(s.V, rows), expected));
  CHECK(same(Surface(s.V, transposed.transpose()), expected));
  CHECK(same(Surface(s.V, wide.block(1, 2, columns.rows(), 3)), expected));
  CHECK(same(Surface(s.V, Eigen::Map<const RowMatrix>(numbers.data(), s.F.rows(), 3)), expected));
  CHECK(same(Surface(s.V, numbers), expected));
  CHECK(same(Surface(s.V, std::span(numbers)), expected));
  CHECK(same(Surface(s.V, triples), expected));
}

template <class T>
void check_points_of(const MeshData& s, const Surface& expected) {
  using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  const Matrix columns = s.V.cast<T>();
  const Positions<T> rows = s.V.cast<T>();
  const Matrix transposed = columns.transpose();
  Matrix wide(columns.rows(), 6);
  wide.setConstant(-3);
  for (Eigen::Index k = 0; k < 3; ++k) wide.col(2 * k) = columns.col(k);
  const std::vector<T> numbers = row_by_row<T>(columns);
  const std::vector<std::array<T, 3>> triples = rows_of<T>(columns);
  const Eigen::Map<const Matrix, 0, Eigen::OuterStride<>> strided(wide.data(), columns.rows(), 3,
                                                                  Eigen::OuterStride<>(2 * wide.rows()));
  CHECK(same(Surface(columns, s.F), expected));
  CHECK(same(Surface(rows, s.F), expected));
  CHECK(same(Surface(transposed.transpose(), s.F), expected));
  CHECK(same(Surface(strided, s.F), expected));
  CHECK(same(Surface(numbers, s.F), expected));
  CHECK(same(Surface(std::span(numbers), s.F), expected));
  CHECK(same(Surface(triples, s.F), expected));
}

template <class Call>
std::string option_error(Call&& call) {
  try {
    call();
  } catch (const OptionError& e) {
    return e.what();
  }
  return "nothing was thrown";
}

template <class T>
void check_refused(const MeshData& s, T index) {
  Eigen::Matrix<T, Eigen::Dynamic, 3> F = s.F.cast<T>();
  F(2, 1) = index;
  F(4, 0) = index;
  try {
    const Surface surface(s.V, F);
    FAIL("an index that no vertex has was accepted");
  } catch (const MeshError& e) {
    CHECK(e.defect() == Defect::index_out_of_range);
    CHECK(e.element() == Element::face);
    CHECK(e.count() == 2);
    CHECK(e.first() == std::vector<Index>{2, 4});
    // One that can be held is refused as every other without a vertex; else it is named.
    const bool held = std::cmp_greater_equal(index, 0) && std::cmp_less_equal(index, std::numeric_limits<Index>::max());
    CHECK((held || std::string(e.what()).find(std::to_string(index)) != std::string::npos));
  }
}

}  // namespace

TEST_CASE("every kind of array gives the same surface") {
  MeshData s = jittered_sphere(2, 0.2, 1);
  const Surface expected(s.V, s.F);
  CHECK(expected.V() == s.V);
  CHECK(expected.F() == s.F);
  check_faces_of<std::int32_t>(s, expected);
  check_faces_of<std::uint32_t>(s, expected);
  check_faces_of<std::int64_t>(s, expected);
  check_faces_of<std::uint64_t>(s, expected);
  check_points_of<double>(s, expected);
  s.V = s.V.cast<float>().cast<double>();  // what floats can hold
  check_points_of<float>(s, Surface(s.V, s.F));
}

TEST_CASE("arrays of other shapes are refused, naming the array") {
  const MeshData s = icosphere(1);
  const Eigen::MatrixXd four = Eigen::MatrixXd::Zero(s.V.rows(), 4);
  const Eigen::MatrixXi two = Eigen::MatrixXi::Zero(8, 2);
  const std::vector<double> numbers(7);
  CHECK(option_error([&] { Surface(four, s.F); }) ==
        "option 'V' = 4 columns: needs three, one point or triangle a row");
  CHECK(option_error([&] { Surface(s.V, two); }) == "option 'F' = 2 columns: needs three, one point or triangle a row");
  CHECK(option_error([&] { Surface(numbers, s.F); }) == "option 'V' = 7 numbers: needs three per row");
  const std::vector<int> none_at_all;
  CHECK_THROWS_AS(Surface(s.V, none_at_all), MeshError);
  CHECK_THROWS_AS(Surface(std::vector<float>{}, s.F), MeshError);
}

#ifndef ALCAP_INDEX_64
TEST_CASE("wide indices that 32 bits do not hold are refused, naming the faces") {
  const MeshData s = tetrahedron();
  std::vector<std::int64_t> wide(s.F.data(), s.F.data() + s.F.size());
  CHECK_NOTHROW(Surface(s.V, wide));
  wide[4] += std::int64_t{1} << 32;  // the same in 32 bits
  wide[11] = -1;
  try {
    Surface(s.V, wide);
    FAIL("was not refused");
  } catch (const MeshError& e) {
    CHECK(e.defect() == Defect::index_out_of_range);
    CHECK(e.element() == Element::face);
    CHECK(e.count() == 2);
    CHECK(e.first() == std::vector<Index>{1, 3});
    CHECK(std::string(e.what()).find("face 1 has the index " + std::to_string(wide[4])) != std::string::npos);
  }
}
#endif

TEST_CASE("indices that no vertex has are refused, naming the faces") {
  const MeshData s = icosphere(1);
  check_refused<std::int32_t>(s, -1);
  check_refused<std::int64_t>(s, -1);
  check_refused<std::uint32_t>(s, 0xffffffffU);
  check_refused<std::int64_t>(s, std::int64_t{1} << 31);
  check_refused<std::int64_t>(s, std::int64_t{1} << 40);
  check_refused<std::int64_t>(s, (std::int64_t{1} << 32) + 1);  // 1, were it cut to 32 bits
  check_refused<std::uint64_t>(s, std::uint64_t{1} << 40);
  check_refused<std::uint64_t>(s, std::numeric_limits<std::uint64_t>::max());
}

TEST_CASE("what is moved in is not copied, and everything else is") {
  MeshData s = icosphere(2);
  const Positions<double> V = s.V;
  const double* const points = s.V.data();
  const Index* const faces = s.F.data();
  const Surface copied(s.V, s.F);
  CHECK(copied.V().data() != points);
  CHECK(s.V.rows() == V.rows());
  const Surface moved(std::move(s.V), std::move(s.F));
  CHECK(moved.V().data() == points);
  CHECK(moved.F().data() == faces);
  CHECK(same(copied, moved));
}

TEST_CASE("a handle keeps the parts alive, and copies share them") {
  const Mesh* mesh = nullptr;
  Surface last;
  {
    const MeshData s = icosphere(2);
    const Surface first(s.V, s.F);
    mesh = &first.mesh();
    last = first;
  }
  CHECK(&last.mesh() == mesh);
  CHECK(last.mesh().vertices() == 162);
  CHECK(last.topology().euler() == 2);
}

TEST_CASE("an intrinsic surface has mesh, geometry and topology, and refuses what needs points") {
  const FlatTorus torus = flat_torus(6, 4);
  const Mesh mesh(torus.F, torus.vertices);
  VectorX<double> lengths(mesh.edges());
  for (Index e = 0; e < mesh.edges(); ++e) lengths[e] = torus.lengths.data()[mesh.halfedge(e)];
  const Surface surface = Surface::from_lengths(mesh, lengths);
  CHECK_FALSE(surface.in_space());
  CHECK(surface.geometry().total_area() == doctest::Approx(1));
  CHECK(surface.topology().components[0].genus == 1);
  CHECK(homology_generators(surface).size() == 2);
  CHECK(option_error([&] { (void)surface.positions(); }) ==
        "option 'surface' = edge lengths alone: needs positions in space");
  CHECK_THROWS_AS((void)extract_component(surface, 0), OptionError);
  CHECK_THROWS_AS((void)split_components(surface), OptionError);

  // With points it can be drawn; lengths stay what they are.
  const Positions<double> V = Positions<double>::Random(mesh.vertices(), 3);
  const Surface drawn = Surface::from_lengths(mesh, lengths, V);
  CHECK(drawn.in_space());
  CHECK(drawn.V() == V);
  CHECK(drawn.geometry().lengths() == surface.geometry().lengths());
  CHECK_THROWS_AS((void)Surface::from_lengths(mesh, lengths, Positions<double>::Zero(3, 3)), OptionError);
}

TEST_CASE("functions of the topology are the same on a surface as on its parts") {
  const MeshData s = torus(12, 8, 1, 0.4);
  const Surface surface(s.V, s.F);
  const Mesh& mesh = surface.mesh();
  const Topology topology = find_topology(mesh);
  const std::vector<Loop> a = homology_generators(surface), b = homology_generators(mesh, topology);
  REQUIRE(a.size() == b.size());
  for (std::size_t k = 0; k < a.size(); ++k) CHECK(a[k].halfedges == b[k].halfedges);
  CHECK(extract_component(surface, 0).V == extract_component(mesh, s.V, topology, 0).V);
  CHECK(split_components(surface).size() == 1);
}
