// SPDX-License-Identifier: MIT
//
// test_output.cpp: what is written is what an independent reader finds, and .ply comes back bit for bit. VTK's own
// reader checks the .vtp files: read_vtp.py. Errors: test_output_broken.cpp.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <sstream>
#include <string>

#include "src/base/parallel.h"
#include "tests/io/directional_reader.h"
#include "tests/io/output_fixture.h"

namespace {

using namespace alcap;
using namespace alcap::test;

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

}  // namespace

TEST_CASE("a field in .ply comes back bit for bit, with its mesh, frames, n and connection") {
  const Folder folder;
  for (const int n : {1, 2, 4, 7}) {
    Case c(with_unreferenced(noisy_scan(3, 0.2, 5)), n);
    if (n == 2) c.connection = globally_optimal(c.mesh, c.geometry);
    c.randomise(static_cast<std::uint64_t>(n));
    c.field.u[3] = {5e-324, -0.0};
    c.field.u[4] = {-1.7976931348623157e308, 1e-308};
    const fs::path path = folder.path / "field.ply";
    CHECK(write_field(c.output(), path) == std::vector<fs::path>{path});
    const FieldFile back = read_field(path);
    CHECK(back.connection == c.connection.kind);
    CHECK(back.field.n == n);
    CHECK(back.F == c.surface.F);
    REQUIRE(back.V.rows() == c.surface.V.rows());
    REQUIRE(back.field.u.size() == c.field.u.size());
    bool same = true;
    for (Index v = 0; v < c.mesh.vertices(); ++v) {
      same = same && same_bits(back.field.u[v].real(), c.field.u[v].real()) &&
             same_bits(back.field.u[v].imag(), c.field.u[v].imag());
      for (int k = 0; k < 3; ++k) {
        same = same && same_bits(back.V(v, k), c.surface.V(v, k)) &&
               same_bits(back.field.frames->X(v, k), c.field.frames->X(v, k)) &&
               same_bits(back.field.frames->N(v, k), c.field.frames->N(v, k));
      }
    }
    CHECK(same);
    for (const Index v : {Index{0}, static_cast<Index>(c.mesh.vertices() - 1)}) {
      CHECK(back.field.u[v] == 0.0);
      CHECK(back.field.frames->X.row(v).isZero(0));
    }
  }
}

TEST_CASE("a .ply holds the connection of its field: made again it is the same, bit for bit") {
  const Folder folder;
  const MeshData sphere = jittered_sphere(3, 0.2, 4), ring = torus(20, 12, 1, 0.4), tube = cylinder(16, 8);
  const GlobalOptions weights{.detail = 0.3, .length_factor = LengthFactor::metric, .tan_cap = 7};
  const std::vector<std::pair<MeshData, ConnectionOptions>> cases = {
      {sphere, {.kind = ConnectionKind::global, .global = weights}},
      {sphere, {.kind = ConnectionKind::polar, .polar = {.center = PolarCenter::barycenter}}},
      {sphere, {.kind = ConnectionKind::local}},
      {sphere, {.kind = ConnectionKind::trivial, .balance_cones = true, .n = 4}},
      {ring, {.kind = ConnectionKind::trivial, .cones = {{3, 0.25}, {90, -0.25}}, .n = 4}},
      {tube, {.kind = ConnectionKind::trivial, .global = weights, .cones = {{40, 1.0 / 3}}, .n = 3}},
      {sphere, {.kind = ConnectionKind::metric, .cones = {{40, 0.1}, {200, 1.9}}}},
      {ring, {.kind = ConnectionKind::metric, .cones = {{3, 0.3}, {90, -0.3}}, .generator_holonomy = {0.1, 0.7}}}};
  for (const auto& [data, options] : cases) {
    const ConnectedSurface s = connect(Surface(data.V, data.F), options);
    const Field field{.n = options.n, .u = ComplexVectorX<double>::Ones(s.mesh().vertices()), .frames = s.frames()};
    write_field({.surface = s, .field = field}, folder.path / "f.ply");
    const FieldFile back = read_field(folder.path / "f.ply");
    CHECK(back.connection == options.kind);
    CHECK(back.connection_known);
    const ConnectedSurface again = connect(Surface(back.V, back.F), back.how);
    const std::string kind(name(options.kind));
    CAPTURE(kind);
    if (options.kind == ConnectionKind::metric) {
      CHECK((again.connection().rho_t - s.connection().rho_t).cwiseAbs().maxCoeff() < 1e-9);
    } else {
      CHECK(again.connection().rho_t == s.connection().rho_t);
      CHECK(again.connection().K == s.connection().K);
    }
    CHECK(again.connection().options.detail == s.connection().options.detail);
  }
  // A target is not kept, and the file says so.
  const Surface surface(sphere.V, sphere.F);
  const ConnectedSurface s(
      surface,
      nearest_connection(surface, {.adjustment = VectorX<double>::Constant(surface.mesh().halfedges(), 0.01)}));
  const Field field{.n = 1, .u = ComplexVectorX<double>::Ones(s.mesh().vertices()), .frames = s.frames()};
  write_field({.surface = s, .field = field}, folder.path / "f.ply");
  CHECK(!read_field(folder.path / "f.ply").connection_known);
}

TEST_CASE("a .ply of an earlier version, which names the kind of connection alone, is read") {
  const Folder folder;
  Case c(jittered_sphere(2, 0.2, 4), 4);
  c.randomise(3);
  write_field(c.output(), folder.path / "f.ply");
  std::string bytes = contents(folder.path / "f.ply");
  for (const char* key : {"obj_info detail", "obj_info length_factor", "obj_info tan_cap"}) {
    const std::size_t at = bytes.find(key);
    REQUIRE(at != std::string::npos);
    bytes.erase(at, bytes.find('\n', at) + 1 - at);
  }
  std::ofstream(folder.path / "old.ply", std::ios::binary) << bytes;
  const FieldFile old = read_field(folder.path / "old.ply");
  CHECK(old.connection == ConnectionKind::local);
  CHECK(old.how.kind == ConnectionKind::local);
  CHECK(!old.connection_known);
  CHECK(old.field.u == c.field.u);
}

TEST_CASE("rawfield: n tangent vectors per face, counter-clockwise, whose n-th power is the field at the barycenter") {
  const Folder folder;
  for (const int n : {1, 2, 4, 6}) {
    Case c(with_unreferenced(noisy_scan(3, 0.2, 8)), n);
    c.randomise(11);
    write_field(c.output(), folder.path / "f.rawfield");
    CHECK(folder.names() == std::set<std::string>{"f.rawfield", "f.sings"});
    const Raw raw = read_raw(folder.path / "f.rawfield");
    REQUIRE(raw.n == n);
    REQUIRE(raw.rows.rows() == c.mesh.faces());
    const ConnectedSurface surface = c.output().surface;
    const Field faces = at_faces(surface, c.field);
    for (Index t = 0; t < c.mesh.faces(); ++t) {
      const Row normal = face_normal(surface, t);
      const Row x = (c.surface.V.row(c.mesh.F()(t, 1)) - c.surface.V.row(c.mesh.F()(t, 0))).normalized();
      const double size = std::pow(std::abs(faces.u[t]), 1.0 / n);
      for (int k = 0; k < n; ++k) {
        const Row d = raw.at(t, k);
        CHECK(std::abs(d.dot(normal)) < 1e-12 * size);
        const Complex<double> z(d.dot(x), d.dot(normal.cross(x)));
        CHECK(std::abs(std::pow(z, n) - faces.u[t]) < 1e-10 * std::abs(faces.u[t]));
        const Row next = raw.at(t, (k + 1) % n);
        const Row turned = std::cos(2 * pi<double> / n) * d + std::sin(2 * pi<double> / n) * normal.cross(d);
        CHECK((next - turned).norm() < 1e-12 * size);
      }
    }
  }
}

TEST_CASE("sings: what principal matching finds in the very rows of the rawfield; the sum is n chi") {
  const Folder folder;
  struct Shape {
    MeshData surface;
    int euler;  // 99: with boundary
  };
  const Shape shapes[] = {{jittered_sphere(3, 0.2, 1), 2},
                          {torus_random_diagonals(20, 11, 1, 0.4, 3), 0},
                          {genus_surface(2, 1), -2},
                          {with_unreferenced(noisy_scan(3, 0.2, 4)), 99},
                          {tetrahedron(), 2},
                          {single_triangle(), 99}};
  for (const Shape& shape : shapes) {
    for (const int n : {1, 2, 4, 5}) {
      Case c(shape.surface, n);
      c.randomise(21);
      write_field(c.output(), folder.path / "f.rawfield");
      const Raw raw = read_raw(folder.path / "f.rawfield");
      int degree = 0, sum = 0;
      const std::map<int, int> found = read_sings(folder.path / "f.sings", degree);
      const Surface surface(c.surface.V, c.surface.F);
      CHECK(degree == n);
      for (Index v = 0; v < c.mesh.vertices(); ++v) {
        const bool inside = c.mesh.referenced(v) && !c.mesh.boundary_vertex(v);
        const int expected = inside ? index_by_matching(surface, raw, v) : 0;
        CHECK((found.count(v) ? found.at(v) : 0) == expected);
        sum += expected;
      }
      if (shape.euler != 99) CHECK(sum == n * shape.euler);
      for (const auto& [element, index] : found) CHECK(index != 0);
    }
  }
}

TEST_CASE("sings: a radial pattern has index 1 at its centre, the mirrored one -1, a constant one none") {
  const Folder folder;
  for (const int n : {1, 2}) {
    Case c(disk(4), n);
    c.radial(false);
    write_field(c.output(), folder.path / "f.rawfield");
    CHECK(contents(folder.path / "f.sings") == std::to_string(n) + " 1\n0 " + std::to_string(n) + "\n");
    c.radial(true);
    write_field(c.output(), folder.path / "f.rawfield");
    CHECK(contents(folder.path / "f.sings") == std::to_string(n) + " 1\n0 " + std::to_string(-n) + "\n");
    Positions<double> constant = Positions<double>::Zero(c.mesh.vertices(), 3);
    constant.col(0).setConstant(2);
    c.field = from_vectors(n, constant, c.field.frames);
    write_field(c.output(), folder.path / "f.rawfield");
    CHECK(contents(folder.path / "f.sings") == std::to_string(n) + " 0\n");
    const Raw raw = read_raw(folder.path / "f.rawfield");
    for (Index t = 0; t < c.mesh.faces(); ++t) {
      double nearest = 9;
      for (int k = 0; k < n; ++k) nearest = std::min(nearest, (raw.at(t, k) - Row(2, 0, 0)).norm());
      CHECK(nearest < 1e-12);
    }
  }
}

TEST_CASE("vertex.rawfield: the branches of every vertex bit for bit, zeros where no face is, and singular faces") {
  const Folder folder;
  Case c(with_unreferenced(jittered_sphere(2, 0.2, 9)), 4);
  c.randomise(33);
  REQUIRE(c.singularities.size() > 3);
  const std::vector<fs::path> written = write_field(c.output(), folder.path / "f.vertex.rawfield");
  CHECK(written == std::vector<fs::path>{folder.path / "f.vertex.rawfield", folder.path / "f.vertex.sings"});
  const Raw raw = read_raw(folder.path / "f.vertex.rawfield");
  REQUIRE(raw.n == 4);
  REQUIRE(raw.rows.rows() == c.mesh.vertices());
  for (int k = 0; k < 4; ++k) CHECK(raw.rows.middleCols(3 * k, 3) == c.field.vectors(k));
  int unused = 0;
  for (Index v = 0; v < c.mesh.vertices(); ++v) {
    if (c.mesh.referenced(v)) continue;
    ++unused;
    CHECK(raw.rows.row(v).isZero(0));
  }
  CHECK(unused == 3);
  std::istringstream text(contents(folder.path / "f.vertex.rawfield"));
  std::string line;
  std::getline(text, line), std::getline(text, line);
  CHECK(line == "0 0 0 0 0 0 0 0 0 0 0 0");  // never "-0"

  int degree = 0;
  const std::map<int, int> found = read_sings(folder.path / "f.vertex.sings", degree);
  CHECK(degree == 4);
  CHECK(found.size() == c.singularities.size());
  for (const Singularity& s : c.singularities) CHECK(found.at(s.face) == s.index);
}

TEST_CASE("numbers in text are those of std::to_chars, whatever their size") {
  const Folder folder;
  for (const int n : {1, 2}) {
    Case c(icosphere(5), n);
    detail::Random random(17);
    auto frames = std::make_shared<Frames>(*c.field.frames);
    for (Index v = 0; v < c.mesh.vertices(); ++v) {
      // Random digits of everyday size, of any size, and numbers of few digits, powers of two and their neighbours.
      const double size = v % 2 == 0 ? random.uniform(-6, 8) : random.uniform(-150, 150);
      c.field.u[v] = std::pow(10, size);
      frames->X.row(v) = Row(random.uniform(-1, 1), std::round(random.uniform(-1, 1) * 1000) / 1000,
                             std::exp2(std::round(random.uniform(-60, 10))));
      if (v % 3 == 0) frames->X(v, 2) = std::nextafter(frames->X(v, 2), v % 6 == 0 ? 0 : 2000);
      if (v % 5 == 0) c.field.u[v] = 1;
    }
    c.field.frames = frames;
    write_field(c.output(), folder.path / "f.vertex.rawfield");
    std::istringstream text(contents(folder.path / "f.vertex.rawfield"));
    std::string token;
    text >> token >> token;
    std::vector<Positions<double>> d;
    for (int k = 0; k < n; ++k) d.push_back(c.field.vectors(k));
    std::int64_t different = 0;
    for (Index v = 0; v < c.mesh.vertices(); ++v) {
      for (int k = 0; k < n; ++k) {
        for (int axis = 0; axis < 3; ++axis) {
          std::array<char, 32> digits;
          const double value = d[static_cast<std::size_t>(k)](v, axis);
          const double x = k > 0 && value == 0 ? 0.0 : value;  // opposites of zeros have no sign
          const char* const end = std::to_chars(digits.data(), digits.data() + digits.size(), x).ptr;
          text >> token;
          different += token != std::string_view(digits.data(), static_cast<std::size_t>(end - digits.data()));
        }
      }
    }
    CHECK(different == 0);
    CHECK(text.good());
  }
}

TEST_CASE("the branches of an even n come in exact opposites, in memory and in text") {
  const Folder folder;
  for (const int n : {2, 4, 6, 10}) {
    CAPTURE(n);
    Case c(icosphere(2), n);
    c.randomise(static_cast<std::uint64_t>(n));
    c.field.u[0] = {-1, 0};  // its roots lie on axes: zeros have no sign
    c.field.u[1] = {0, -1};
    write_field(c.output(), folder.path / "f.vertex.rawfield");
    const Raw raw = read_raw(folder.path / "f.vertex.rawfield");
    for (int k = 0; k < n / 2; ++k) {
      CHECK(raw.rows.middleCols(3 * k, 3) == -raw.rows.middleCols(3 * (k + n / 2), 3));
      CHECK(raw.rows.middleCols(3 * k, 3) == c.field.vectors(k));
      for (Index v = 0; v < c.mesh.vertices(); ++v) CHECK(c.field.branch(v, k) == -c.field.branch(v, k + n / 2));
    }
  }
}

TEST_CASE("rosy: face count, n, and the unit vector along the first direction of each face") {
  const Folder folder;
  Case c(noisy_scan(3, 0.2, 2), 4);
  c.randomise(7);
  for (Index k = 0; k < 3; ++k) c.field.u[c.mesh.F()(5, k)] = 0;  // face 5 has no direction
  const fs::path both[] = {folder.path / "f.rosy", folder.path / "f.rawfield"};
  write_field(c.output(), both);
  const Raw raw = read_raw(both[1]);
  std::ifstream in(both[0]);
  int faces = 0, n = 0;
  in >> faces >> n;
  REQUIRE(faces == c.mesh.faces());
  CHECK(n == 4);
  for (Index t = 0; t < faces; ++t) {
    Row d;
    in >> d[0] >> d[1] >> d[2];
    if (t == 5) {
      CHECK(d == Row::Zero());
    } else {
      CHECK((d - raw.at(t, 0).normalized()).norm() < 1e-14);
    }
  }
  CHECK(in.good());
}

TEST_CASE("vtp: declared offsets, lengths and contents of the appended data agree") {
  const Folder folder;
  Case c(with_unreferenced(jittered_sphere(2, 0.1, 3)), 3);
  c.randomise(5);
  write_field(c.output(), folder.path / "f.vtp");
  CHECK(folder.names() == std::set<std::string>{"f.vtp", "f_singularities.vtp"});
  for (const char* name : {"f.vtp", "f_singularities.vtp"}) {
    const std::string text = contents(folder.path / name);
    const std::string marker = "<AppendedData encoding=\"raw\">\n_";
    std::size_t data = text.find(marker), at = 0;
    REQUIRE(data != std::string::npos);
    data += marker.size();
    std::size_t expected = 0;
    int arrays = 0;
    while ((at = text.find("offset=\"", at)) < data) {
      at += 8;
      REQUIRE(std::strtoull(text.c_str() + at, nullptr, 10) == expected);
      std::uint64_t length = 0;
      std::memcpy(&length, text.data() + data + expected, 8);
      expected += 8 + length;
      ++arrays;
    }
    CHECK(arrays >= 7);
    CHECK(text.substr(data + expected) == "\n  </AppendedData>\n</VTKFile>\n");
  }
}

TEST_CASE("files do not depend on the number of threads, nor on what is written together with them") {
  const Folder folder;
  Case c(noisy_scan(5, 0.1, 6), 4);
  c.randomise(3);
  std::vector<fs::path> together, alone;
  for (const std::string& format : field_formats()) {
    together.push_back(folder.path / ("together." + format));
    alone.push_back(folder.path / ("alone." + format));
  }
  std::vector<fs::path> first, second;
  run_with_threads(4, [&] { first = write_field(c.output(), together); });
  run_with_threads(1, [&] {
    for (const auto& path : alone) {
      for (auto& written : write_field(c.output(), path)) second.push_back(std::move(written));
    }
  });
  REQUIRE(first.size() == second.size());
  CHECK(first.size() == folder.names().size() / 2);
  for (std::size_t i = 0; i < first.size(); ++i) CHECK(contents(first[i]) == contents(second[i]));
}

TEST_CASE("write samples for VTK" * doctest::skip()) {
  const char* const folder = std::getenv("ALCAP_SAMPLE_FOLDER");
  REQUIRE(folder != nullptr);
  const auto sample = [&](const std::string& name, Case& c) {
    detail::Random random(77);
    c.extra.resize(static_cast<std::size_t>(c.mesh.faces()));
    for (double& x : c.extra) x = random.uniform(-1, 1);
    c.scalars = {{"a < \"b\" & c>", c.extra}};
    const fs::path files[] = {fs::path(folder) / (name + ".vtp"), fs::path(folder) / (name + ".ply")};
    write_field(c.output(), files);

    // "array FILE PLACE COMPONENTS ROWS NAME", then the numbers.
    std::FILE* const out = std::fopen((fs::path(folder) / (name + ".txt")).c_str(), "w");
    REQUIRE(out != nullptr);
    const auto array = [&](const char* file, const char* place, int components, std::int64_t rows, const char* title,
                           auto&& value) {
      std::fprintf(out, "array %s %s %d %lld %s\n", file, place, components, static_cast<long long>(rows), title);
      for (std::int64_t i = 0; i < rows; ++i) {
        for (int k = 0; k < components; ++k) std::fprintf(out, "%.17g ", static_cast<double>(value(i, k)));
        std::fprintf(out, "\n");
      }
    };
    const std::int64_t V = c.mesh.vertices(), F = c.mesh.faces(), S = static_cast<std::int64_t>(c.singularities.size());
    const auto sing = [&](std::int64_t i) { return c.singularities[static_cast<std::size_t>(i)]; };
    array("surface", "points", 3, V, "-", [&](auto i, int k) { return c.surface.V(i, k); });
    array("surface", "polys", 3, F, "-", [&](auto i, int k) { return c.surface.F(i, k); });
    for (int b = 0; b < c.field.n; ++b) {
      const Positions<double> d = c.field.vectors(b);
      array("surface", "point", 3, V, ("d_" + std::to_string(b)).c_str(), [&](auto i, int k) { return d(i, k); });
    }
    array("surface", "point", 1, V, "magnitude", [&](auto i, int) { return std::abs(c.field.u[i]); });
    array("surface", "point", 2, V, "u", [&](auto i, int k) { return k ? c.field.u[i].imag() : c.field.u[i].real(); });
    array("surface", "point", 3, V, "axis", [&](auto i, int k) { return c.field.frames->X(i, k); });
    array("surface", "point", 3, V, "normal", [&](auto i, int k) { return c.field.frames->N(i, k); });
    array("surface", "cell", 1, F, "K", [&](auto i, int) { return c.connection.K[i]; });
    const std::vector<int> indices = face_indices(c.mesh, c.connection, c.field);
    array("surface", "cell", 1, F, "index", [&](auto i, int) { return indices[static_cast<std::size_t>(i)]; });
    // Orange above zero, blue below, as in every picture.
    const auto colour = [](int sign, int channel) {
      constexpr int colours[3][3] = {{0, 114, 178}, {235, 229, 216}, {213, 94, 0}};
      return colours[sign < 0 ? 0 : sign == 0 ? 1 : 2][channel];
    };
    array("surface", "cell", 3, F, "index_rgb",
          [&](auto i, int k) { return colour(indices[static_cast<std::size_t>(i)], k); });
    array("surface", "cell", 1, F, c.scalars[0].name.c_str(),
          [&](auto i, int) { return c.extra[static_cast<std::size_t>(i)]; });
    array("surface", "field", 1, 1, "n", [&](auto, int) { return c.field.n; });
    array("singularities", "points", 3, S, "-", [&](auto i, int k) {
      double x = 0;
      for (int j = 0; j < 3; ++j) {
        x += sing(i).barycentric[static_cast<std::size_t>(j)] * c.surface.V(c.surface.F(sing(i).face, j), k);
      }
      return x;
    });
    array("singularities", "verts", 1, S, "-", [](auto i, int) { return i; });
    array("singularities", "point", 1, S, "index", [&](auto i, int) { return sing(i).index; });
    array("singularities", "point", 3, S, "index_rgb", [&](auto i, int k) { return colour(sing(i).index, k); });
    array("singularities", "point", 1, S, "orientation", [&](auto i, int) { return sing(i).orientation; });
    array("singularities", "point", 1, S, "face", [&](auto i, int) { return sing(i).face; });
    array("singularities", "point", 3, S, "barycentric",
          [&](auto i, int k) { return sing(i).barycentric[static_cast<std::size_t>(k)]; });
    array("singularities", "point", 1, S, "located", [&](auto i, int) { return sing(i).located ? 1 : 0; });
    array("singularities", "field", 1, 1, "n", [&](auto, int) { return c.field.n; });
    std::fclose(out);
  };
  Case busy(with_unreferenced(noisy_scan(3, 0.2, 5)), 4);
  busy.randomise(12);
  sample("busy", busy);
  Case plain(single_triangle(), 1);  // no singularity: empty arrays
  plain.field = from_vectors(1, Positions<double>(Positions<double>::Ones(3, 3)), plain.field.frames);
  plain.singularities = find_singularities(plain.mesh, plain.geometry, plain.connection, plain.field);
  REQUIRE(plain.singularities.empty());
  sample("plain", plain);
}
