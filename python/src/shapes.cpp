// SPDX-License-Identifier: MIT
//
// shapes.cpp: generated meshes.
#include "alcap/generators.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"

namespace alcap::python {
namespace {

py::tuple pair(MeshData mesh) { return py::make_tuple(moved_rows(std::move(mesh.V)), moved_faces(std::move(mesh.F))); }

}  // namespace

void bind_shapes(py::module_& m) {
  m.def("tetrahedron", [] { return pair(tetrahedron()); });
  m.def("cube", [] { return pair(cube()); });
  m.def("icosphere", [](int level) { return pair(icosphere(level)); });
  m.def("bumpy_sphere", [](int level, double a, double f) { return pair(bumpy_sphere(level, a, f)); });
  m.def("noisy_scan", [](int level, double noise, std::uint64_t seed) { return pair(noisy_scan(level, noise, seed)); });
  m.def("single_triangle", [] { return pair(single_triangle()); });
  m.def("fan", [](int count) { return pair(fan(count)); });
  m.def("jittered_sphere",
        [](int level, double amount, std::uint64_t seed) { return pair(jittered_sphere(level, amount, seed)); });
  m.def("torus_random_diagonals", [](int nu, int nv, double R, double r, std::uint64_t seed) {
    return pair(torus_random_diagonals(nu, nv, R, r, seed));
  });
  m.def("torus", [](int nu, int nv, double R, double r) { return pair(torus(nu, nv, R, r)); });
  m.def("genus_surface", [](int genus, int resolution) { return pair(genus_surface(genus, resolution)); });
  m.def("grid", [](int nx, int ny, double w, double h) { return pair(grid(nx, ny, w, h)); });
  m.def("disk", [](int rings) { return pair(disk(rings)); });
  m.def("cylinder",
        [](int nu, int nv, double radius, double height) { return pair(cylinder(nu, nv, radius, height)); });
  m.def("cad_like", [](int segments, int steps) { return pair(cad_like(segments, steps)); });
}

}  // namespace alcap::python
