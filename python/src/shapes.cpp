// SPDX-License-Identifier: MIT
//
// shapes.cpp: generated meshes.
#include "alcap/generators.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"

namespace alcap::python {
namespace {

py::tuple pair(MeshData mesh) {
  const py::ssize_t faces = mesh.F.rows();
  return py::make_tuple(moved_rows(std::move(mesh.V)), moved(std::move(mesh.F), {faces, 3}));
}

}  // namespace

void bind_shapes(py::module_& m) {
  m.def("tetrahedron", [] { return pair(tetrahedron()); });
  m.def("cube", [] { return pair(cube()); });
  m.def("icosphere", [](int level) { return pair(icosphere(level)); });
  m.def("bumpy_sphere", [](int level, double a, double f) { return pair(bumpy_sphere(level, a, f)); });
  m.def("noisy_scan", [](int level, double noise, std::uint64_t seed) { return pair(noisy_scan(level, noise, seed)); });
  m.def("torus", [](int nu, int nv, double R, double r) { return pair(torus(nu, nv, R, r)); });
  m.def("genus_surface", [](int genus, int resolution) { return pair(genus_surface(genus, resolution)); });
  m.def("grid", [](int nx, int ny, double w, double h) { return pair(grid(nx, ny, w, h)); });
  m.def("disk", [](int rings) { return pair(disk(rings)); });
  m.def("cylinder",
        [](int nu, int nv, double radius, double height) { return pair(cylinder(nu, nv, radius, height)); });
  m.def("cad_like", [](int segments, int steps) { return pair(cad_like(segments, steps)); });
}

}  // namespace alcap::python
