// SPDX-License-Identifier: MIT
//
// intrinsic.cpp: other triangles on the same surface.
#include "alcap/intrinsic.h"

#include "python/src/arrays.h"
#include "python/src/bindings.h"
#include "python/src/features.h"
#include "python/src/long_call.h"

namespace alcap::python {

py::dict quality_dict(const TriangleQuality& q) {
  return py::dict("angle_min"_a = q.angle_min, "angle_max"_a = q.angle_max, "cotangent_min"_a = q.cotangent_min,
                  "not_delaunay"_a = q.not_delaunay, "slivers"_a = q.slivers);
}

namespace {

using Handle = std::shared_ptr<IntrinsicTriangulation>;

void bind_figures(py::class_<IntrinsicTriangulation, Handle>& c) {
  using T = IntrinsicTriangulation;
  c.def_readonly("given_vertices", &T::given_vertices, "int: how many vertices the given surface has.");
  c.def_property_readonly(
      "before", [](const T& t) { return quality_dict(t.before); },
      "dict: the given triangles, see triangle_quality().");
  c.def_property_readonly(
      "after", [](const T& t) { return quality_dict(t.after); }, "dict: the new triangles, see triangle_quality().");
  c.def_readonly("flips", &T::flips, "int: edges flipped.");
  c.def_readonly("added", &T::added, "int: vertices added; they come behind the given ones.");
  c.def_readonly("barred", &T::barred,
                 "int: edges that are not Delaunay because a flip would join two vertices twice, or one to itself.");
  c.def_readonly("complete", &T::complete, "bool: False where most_flips or most_vertices ended it.");
  c.def_readonly("seconds", &T::seconds, "float: wall clock.");
}

}  // namespace

void bind_intrinsic(py::module_& m) {
  py::class_<IntrinsicTriangulation, Handle> c(
      m, "IntrinsicTriangulation",
      "Other triangles on a surface, see intrinsic_delaunay(). Lengths, angles and curvature of the surface are the\n"
      "same; vertices keep their numbers and know where their axes were, so values at vertices carry over.");
  c.def_readonly(
      "surface", &IntrinsicTriangulation::surface,
      "Surface: the given vertices, then the added ones. It lies in no space: edges are not straight there.");
  c.def_property_readonly(
      "turn", [](const Handle& t) { return shared(t->turn.data(), {t->turn.size()}, t); },
      "(#V,) float64, read-only, no copy: the direction of the first new halfedge of every given vertex, radians in "
      "the\n"
      "polar angles of the given surface.");
  c.def_property_readonly(
      "kept",
      [](const Handle& t) {
        py::list out;
        for (const auto& line : t->kept) out.append(moved(std::vector<Index>(line)));
        return out;
      },
      "list of (k,) int32: for every kept edge the vertices along it.");
  bind_figures(c);
  c.def(
      "to_given",
      [](const IntrinsicTriangulation& t, const py::object& u, int n) {
        return moved(t.to_given(complex_of(u, "u", t.surface.mesh().vertices()), n));
      },
      py::arg("u"), py::arg("n"),
      "(#V,) complex128: values u of an n-field at the vertices of `surface`, relative to a connection made there, at\n"
      "the given vertices, relative to the same kind of connection made on the given surface.");
  c.def(
      "from_given",
      [](const IntrinsicTriangulation& t, const py::object& u, int n) {
        return moved(t.from_given(complex_of(u, "u", t.given_vertices), n));
      },
      py::arg("u"), py::arg("n"), "(#V,) complex128: the other way; 0 at added vertices.");
  m.def("intrinsic_delaunay", [](const Surface& s, const py::dict& d, const py::object& progress, int threads) {
    const IntrinsicOptions options{.keep = indices_of(d["keep"], "keep"),
                                   .min_angle = as<double>(d["min_angle"], "min_angle"),
                                   .max_radius = as<double>(d["max_radius"], "max_radius"),
                                   .most_flips = as<double>(d["most_flips"], "most_flips"),
                                   .most_vertices = as<double>(d["most_vertices"], "most_vertices")};
    return std::make_shared<IntrinsicTriangulation>(
        watched(progress, threads, [&] { return intrinsic_delaunay(s, options); }));
  });
  m.def("triangle_quality", [](const Surface& s) { return quality_dict(triangle_quality(s)); });
}

}  // namespace alcap::python
