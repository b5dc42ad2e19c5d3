// SPDX-License-Identifier: MIT
//
// operators.cpp: first-order operators, stiffness and mass, energies.
#include "alcap/operators.h"

#include "alcap/connected_surface.h"
#include "alcap/energies.h"
#include "alcap/matrix_file.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"
#include "python/src/long_call.h"

namespace alcap::python {

void bind_operators(py::module_& m) {
  m.def("energy_matrices", [](const ConnectedSurface& s, int n, double energy) {
    StiffnessMass out = watched(py::none(), 0, [&] { return energy_matrices(s, n, energy); });
    return py::make_tuple(sparse(std::move(out.S)), sparse(std::move(out.M)));
  });
  m.def("curvature_and_boundary", [](const ConnectedSurface& s, int n) {
    return sparse(watched(py::none(), 0, [&] { return curvature_and_boundary(s, n); }));
  });
  m.def("field_energies", [](const ConnectedSurface& s, int n, const py::object& u) {
    const auto values = complex_of(u, "u", s.mesh().vertices());
    const FieldEnergies e = field_energies(s, n, values);
    return py::make_tuple(e.dirichlet, e.antiholomorphic, e.holomorphic);
  });
  m.def("first_order_operators", [](const ConnectedSurface& s, int n, const std::string& kind) {
    const OperatorOptions options{.n = n, .kind = named<OperatorKind>(kind, "kind")};
    const auto built = watched(py::none(), 0, [&] { return first_order_operators(s, options); });
    return py::make_tuple(sparse(face_vertex_matrix(s.mesh(), built.p)), sparse(face_vertex_matrix(s.mesh(), built.q)));
  });
  m.def("write_matrix", [](const std::string& path, const py::tuple& A, const std::string& format) {
    const auto matrix = sparse_of(A, "A");
    const auto how = named<MatrixFormat>(format, "format");
    long_call(py::none(), 0, [&] { write_matrix(path, matrix, how); });
  });
  m.def("edge_value", [](const ConnectedSurface& s, int n, const py::object& u, Index h, double fraction) {
    if (!(fraction >= 0 && fraction <= 1)) throw OptionError("s", fraction, "must be in [0, 1]");
    const EdgeValue v = edge_field(s, n, complex_of(u, "u", s.mesh().vertices()), h).at(fraction);
    return py::make_tuple(v.u, v.along);
  });
  m.def("field_value",
        [](const ConnectedSurface& s, int n, const py::object& u, Index t, const std::array<double, 3>& barycentric) {
          if (t < 0 || t >= s.mesh().faces()) throw OptionError("face", t, "must be a face, in [0, F)");
          const FieldValue v = face_field(s, n, complex_of(u, "u", s.mesh().vertices()), t).at(barycentric);
          return py::make_tuple(v.u, v.d1, v.d2);
        });
}

}  // namespace alcap::python
