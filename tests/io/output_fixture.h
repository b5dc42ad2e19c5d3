// SPDX-License-Identifier: MIT
//
// output_fixture.h: a surface with all that a FieldOutput refers to, and a folder to write into, for the tests of
// output.
#pragma once

#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "alcap/generators.h"
#include "alcap/output.h"
#include "src/base/random.h"
#include "tests/support/folder.h"

namespace alcap::test {

namespace fs = std::filesystem;

inline std::string contents(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  REQUIRE(in.is_open());
  return {std::istreambuf_iterator<char>(in), {}};
}

// A surface with everything that a FieldOutput refers to.
struct Case {
  MeshData surface;
  Mesh mesh;
  Geometry geometry;
  Connection connection;
  Field field;
  std::vector<Singularity> singularities;
  std::vector<double> extra;
  std::vector<FaceScalars> scalars;

  Case(MeshData s, int n) : surface(std::move(s)) {
    mesh = Mesh(surface.F, surface.V.rows());
    geometry = Geometry(mesh, surface.V);
    connection = locally_optimal(mesh, geometry);
    field.n = n;
    field.u = ComplexVectorX<double>::Zero(mesh.vertices());
    field.frames = std::make_shared<const Frames>(vertex_frames(mesh, surface.V, connection));
  }
  void randomise(std::uint64_t seed) {
    detail::Random random(seed);
    for (Index v = 0; v < mesh.vertices(); ++v) {
      if (mesh.referenced(v)) field.u[v] = std::polar(std::exp(random.uniform(-30, 30)), random.uniform(-4, 4));
    }
    singularities = find_singularities(mesh, geometry, connection, field);
  }
  // The cross-field-like pattern u = (unit position in the plane)^n of a flat mesh around the origin; zero there.
  void radial(bool mirrored) {
    Positions<double> d = surface.V;
    for (Index v = 0; v < mesh.vertices(); ++v) {
      if (mirrored) d(v, 1) = -d(v, 1);
    }
    field = from_vectors(field.n, d, field.frames);
  }
  [[nodiscard]] FieldOutput output() const {
    return {.surface = {Surface(surface.V, surface.F), connection},
            .field = field,
            .singularities = singularities,
            .face_scalars = scalars};
  }
};

// Vertices 0, one in the middle and the last are used by no face.
inline MeshData with_unreferenced(const MeshData& s) {
  const Eigen::Index half = s.V.rows() / 2;
  MeshData out;
  out.V.resize(s.V.rows() + 3, 3);
  out.V.row(0) << 9, 9, 9;
  out.V.middleRows(1, half) = s.V.topRows(half);
  out.V.row(half + 1) << -7, 0.1, 1e-9;
  out.V.middleRows(half + 2, s.V.rows() - half) = s.V.bottomRows(s.V.rows() - half);
  out.V.row(out.V.rows() - 1) << 0, 0, 0;
  out.F = s.F.unaryExpr([&](Index v) { return static_cast<Index>(v < half ? v + 1 : v + 2); });
  return out;
}

}  // namespace alcap::test
