// SPDX-License-Identifier: MIT
//
// field.cpp: fields, where they vanish, alignment with curvature.
#include "alcap/field.h"

#include "alcap/alignment.h"
#include "alcap/connected_surface.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"
#include "python/src/singularity_array.h"

namespace alcap::python {

py::array singularity_array(std::vector<Singularity> list) { return moved(std::move(list)); }

std::vector<Singularity> singularities_of(const py::object& array) {
  const py::array_t<Singularity, py::array::c_style> a(array);
  return {a.data(), a.data() + a.size()};
}

namespace {

using Handle = std::shared_ptr<Field>;

Handle handle(Field field) { return std::make_shared<Field>(std::move(field)); }

void bind_class(py::module_& m) {
  py::class_<Field, Handle> c(m, "Field",
                              "An n-vector field: one complex number u = z^n per vertex (or face), z any of its n\n"
                              "branches in the frame of the element.\n\n"
                              "Parameters\n----------\nn : int\n    1 vectors, 2 lines, 4 crosses.\n"
                              "u : (k,) array of complex128\n    Copied.\nframes : Frames or None");
  c.def(py::init([](int n, const py::object& u, std::shared_ptr<Frames> frames) {
          if (n < 1) throw OptionError("n", n, "must be at least 1");
          return handle({n, complex_of(u, "u", frames ? frames->X.rows() : -1), std::move(frames)});
        }),
        py::arg("n"), py::arg("u"), py::arg("frames"));
  c.def_static(
      "from_vectors",
      [](int n, const py::object& vectors, const std::shared_ptr<Frames>& frames) {
        return handle(from_vectors(n, positions_of(vectors, "vectors"), frames));
      },
      py::arg("n"), py::arg("vectors"), py::arg("frames"),
      "From one branch as vectors in space (k, 3), projected to the tangent planes.");
  c.def_readonly("n", &Field::n, "int: the degree.");
  c.def_property_readonly(
      "u", [](const Handle& f) { return shared(f->u.data(), {f->u.size()}, f); },
      "(k,) complex128, read-only, no copy: the n-th power of any branch.");
  c.def_property_readonly(
      "frames", [](const Handle& f) { return std::const_pointer_cast<Frames>(f->frames); },
      "Frames, or None on a surface that lies in no space.");
  c.def(
      "vectors", [](const Field& f, int k) { return moved_rows(f.vectors(k)); }, py::arg("k") = 0,
      "(#V, 3) float64: branch k, 0 <= k < n, as vectors in space.");
  c.def(
      "raw",
      [](const Field& f) {
        auto rows = f.raw();
        const Shape shape{rows.rows(), rows.cols()};
        return moved(std::move(rows), shape);
      },
      "(#V, 3 n) float64: all branches side by side.");
  c.def(
      "normalised", [](const Field& f) { return handle(normalised(f)); }, "The direction field: |u| = 1 or 0.");
  c.def(
      "on_frames", [](const Field& f, const std::shared_ptr<Frames>& frames) { return handle(on_frames(f, frames)); },
      py::arg("frames"), "The same vectors in other frames of the same elements.");
  c.def("__len__", [](const Field& f) { return f.u.size(); });
}

void bind_indices(py::module_& m) {
  m.def("face_indices", [](const ConnectedSurface& s, const Field& f) { return moved(face_indices(s, f)); });
  m.def("vertex_indices", [](const Surface& s, const Field& f) { return moved(vertex_indices(s, f)); });
  m.def("find_singularities",
        [](const ConnectedSurface& s, const Field& f) { return singularity_array(find_singularities(s, f)); });
  m.def("index_sums", [](const ConnectedSurface& s, const Field& f, const py::object& indices) {
    py::list out;
    const auto list = indices_of(indices, "indices", s.mesh().faces());
    for (const IndexSum& i : index_sums(s, f, std::vector<int>(list.begin(), list.end())))
      out.append(py::make_tuple(i.sum, i.expected));
    return out;
  });
  m.def("singularity_positions", [](const Surface& s, const py::object& list) {
    const auto singularities = singularities_of(list);
    Positions<double> out(static_cast<Eigen::Index>(singularities.size()), 3);
    for (Eigen::Index k = 0; k < out.rows(); ++k) out.row(k) = position(s, singularities[static_cast<std::size_t>(k)]);
    return moved_rows(std::move(out));
  });
}

}  // namespace

void bind_field(py::module_& m) {
  PYBIND11_NUMPY_DTYPE(Singularity, face, barycentric, index, orientation, located);
  bind_class(m);
  bind_indices(m);
  m.def("at_faces", [](const ConnectedSurface& s, const Field& f) { return handle(at_faces(s, f)); });
  m.def("at_vertices", [](const ConnectedSurface& s, const Field& f) { return handle(at_vertices(s, f)); });
  m.def("curvature_field", [](const ConnectedSurface& s, int n, bool smallest, bool by_magnitude, int rings) {
    return handle(curvature_field(s, {.n = n, .smallest = smallest, .by_magnitude = by_magnitude, .rings = rings}));
  });
  m.def("root_mean_square", [](const Surface& s, const py::object& u) {
    return root_mean_square(s, complex_of(u, "u", s.mesh().vertices()));
  });
}

}  // namespace alcap::python
