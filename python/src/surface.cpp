// SPDX-License-Identifier: MIT
//
// surface.cpp: surfaces, their half-edges, lengths and topology; what is wrong with a mesh; sharp edges; paths of
// edges.
#include "alcap/surface.h"

#include "alcap/mesh_check.h"
#include "alcap/mesh_repair.h"
#include "alcap/sharp_edges.h"
#include "alcap/shortest_path.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"
#include "python/src/long_call.h"

namespace alcap::python {
namespace {

py::array shared_reals(const Surface& s, const VectorX<double>& values) {
  return shared(values.data(), {values.size()}, s);
}

py::array edges(const Mesh& mesh) {
  Eigen::Matrix<Index, Eigen::Dynamic, 2, Eigen::RowMajor> out(mesh.edges(), 2);
  for (Index e = 0; e < mesh.edges(); ++e) out.row(e) << mesh.tail(mesh.halfedge(e)), mesh.tip(mesh.halfedge(e));
  return moved(std::move(out), {mesh.edges(), 2});
}

template <class Value>
py::array per(Index count, Value&& value) {
  std::vector<std::remove_cvref_t<decltype(value(Index{}))>> out(static_cast<std::size_t>(count));
  for (Index k = 0; k < count; ++k) out[static_cast<std::size_t>(k)] = value(k);
  return moved(std::move(out));
}

py::list components(const Topology& topology) {
  py::list out;
  for (const ComponentInfo& c : topology.components) {
    out.append(py::dict("vertices"_a = c.vertices, "edges"_a = c.edges, "faces"_a = c.faces, "euler"_a = c.euler,
                        "genus"_a = c.genus, "boundary_loops"_a = c.boundary_loops, "first_face"_a = c.first_face));
  }
  return out;
}

py::list loops(const std::vector<Loop>& list) {
  py::list out;
  for (const Loop& loop : list) out.append(moved(std::vector<Index>(loop.halfedges)));
  return out;
}

py::tuple piece(Piece p) {
  return py::make_tuple(moved_rows(std::move(p.V)), moved_faces(std::move(p.F)), moved(std::move(p.vertices)),
                        moved(std::move(p.faces)));
}

py::list defects(const std::vector<DefectReport>& reports) {
  py::list out;
  for (const DefectReport& r : reports) {
    out.append(py::dict("defect"_a = name(r.defect), "element"_a = name(r.element), "count"_a = r.count,
                        "first"_a = r.first, "message"_a = r.message));
  }
  return out;
}

Surface from_lengths(const py::object& F, std::int64_t vertices, const py::object& lengths, const py::object& V) {
  Mesh mesh(faces_of(F), vertices);
  const VectorX<double> reals = reals_of(lengths, "lengths", mesh.edges());
  return Surface::from_lengths(std::move(mesh), reals, V.is_none() ? Positions<double>{} : positions_of(V));
}

void bind_arrays(py::class_<Surface>& c) {
  const auto prop = [&](const char* name, auto get, const char* doc) { c.def_property_readonly(name, get, doc); };
  prop(
      "V",
      [](const Surface& s) {
        return shared(s.V().data(), {s.V().rows(), 3}, s);
      },
      "(#V, 3) float64, read-only, no copy: the points. (0, 3) on an intrinsic surface.");
  prop(
      "F",
      [](const Surface& s) {
        return shared(s.F().data(), {s.F().rows(), 3}, s);
      },
      "(#F, 3) int32, read-only, no copy: the triangles, counter-clockwise.");
  prop(
      "edges", [](const Surface& s) { return edges(s.mesh()); },
      "(#E, 2) int32: the vertices of each edge, in the direction of its canonical halfedge.");
  prop(
      "edge_of", [](const Surface& s) { return per(s.mesh().halfedges(), [&](Index h) { return s.mesh().edge(h); }); },
      "(3 #F,) int32: the edge of each halfedge 3 t + c.");
  prop(
      "twins", [](const Surface& s) { return per(s.mesh().halfedges(), [&](Index h) { return s.mesh().twin(h); }); },
      "(3 #F,) int32: the halfedge on the other side, -1 on the boundary.");
  prop(
      "lengths", [](const Surface& s) { return shared_reals(s, s.geometry().lengths()); },
      "(#E,) float64, read-only, no copy: lengths of the edges, in the unit of V.");
  prop(
      "angles", [](const Surface& s) { return shared_reals(s, s.geometry().angles()); },
      "(3 #F,) float64, read-only, no copy: angles of the corners 3 t + c, radians.");
  prop(
      "areas", [](const Surface& s) { return shared_reals(s, s.geometry().areas()); },
      "(#F,) float64, read-only, no copy: areas of the faces.");
  prop(
      "defects",
      [](const Surface& s) {
        return per(s.mesh().vertices(), [&](Index v) { return s.geometry().defect(s.mesh(), v); });
      },
      "(#V,) float64: 2 pi minus the angles around a vertex (pi on the boundary), radians.");
  prop(
      "boundary_vertices",
      [](const Surface& s) {
        return per(s.mesh().vertices(), [&](Index v) { return std::uint8_t{s.mesh().boundary_vertex(v)}; })
            .attr("view")("bool");
      },
      "(#V,) bool: whether a vertex lies on the boundary.");
  prop(
      "vertex_component", [](const Surface& s) { return moved(std::vector<Index>(s.topology().vertex_component)); },
      "(#V,) int32: the component of each vertex, -1 where no face uses it.");
  prop(
      "face_component", [](const Surface& s) { return moved(std::vector<Index>(s.topology().face_component)); },
      "(#F,) int32: the component of each face.");
}

void bind_numbers(py::class_<Surface>& c) {
  c.def_property_readonly(
      "n_vertices", [](const Surface& s) { return s.mesh().vertices(); }, "Number of vertices.");
  c.def_property_readonly(
      "n_faces", [](const Surface& s) { return s.mesh().faces(); }, "Number of faces.");
  c.def_property_readonly(
      "n_edges", [](const Surface& s) { return s.mesh().edges(); }, "Number of edges.");
  c.def_property_readonly(
      "euler", [](const Surface& s) { return s.topology().euler(); }, "Euler characteristic.");
  c.def_property_readonly(
      "area", [](const Surface& s) { return s.geometry().total_area(); }, "Total area.");
  c.def_property_readonly("in_space", &Surface::in_space, "Whether there are points.");
  c.def_property_readonly(
      "components", [](const Surface& s) { return components(s.topology()); },
      "list of dict: vertices, edges, faces, euler, genus, boundary_loops, first_face.");
  c.def_property_readonly(
      "boundary_loops", [](const Surface& s) { return loops(s.topology().loops); },
      "list of (k,) int32: the halfedges of each boundary loop, the surface on their left.");
  c.def(
      "homology_generators", [](const Surface& s) { return loops(homology_generators(s)); },
      "list of (k,) int32: 2 genus closed strips of faces per component, as the halfedges they cross.");
  c.def(
      "edge", [](const Surface& s, Index i, Index j) { return s.mesh().edge(i, j); }, py::arg("i"), py::arg("j"),
      "The edge that joins two vertices, -1 when there is none.");
  c.def(
      "split",
      [](const Surface& s) {
        py::list out;
        for (Piece& p : split_components(s)) out.append(piece(std::move(p)));
        return out;
      },
      "list of (V, F, vertices, faces): every component as a mesh of its own, and its numbers in this one.");
  c.def("__repr__", [](const Surface& s) {
    return "<alcap.Surface: " + std::to_string(s.mesh().vertices()) + " vertices, " + std::to_string(s.mesh().faces()) +
           " faces, Euler characteristic " + std::to_string(s.topology().euler()) + ">";
  });
}

}  // namespace

void bind_surface(py::module_& m) {
  py::class_<Surface> c(
      m, "Surface",
      "A triangle mesh ready to compute on: points, half-edges, lengths, angles, topology.\n\n"
      "Made once, never changed; may be used by several threads at once.\n\n"
      "Parameters\n----------\n"
      "V : (#V, 3) array of float64 or float32\n    Points, in any memory order. Copied once.\n"
      "F : (#F, 3) array of integers\n    Counter-clockwise triangles, counted from 0. Copied once.\n\n"
      "Raises\n------\nMeshError\n    The mesh cannot be used; names the elements.\n"
      "OptionError\n    An array has another shape or type.");
  c.def(py::init([](const py::object& V, const py::object& F) {
          auto points = positions_of(V);
          auto faces = faces_of(F);
          return watched(py::none(), 0, [&] { return Surface(std::move(points), std::move(faces)); });
        }),
        py::arg("V"), py::arg("F"));
  c.def_static("from_lengths", &from_lengths, py::arg("F"), py::arg("n_vertices"), py::arg("lengths"),
               py::arg("V") = py::none(),
               "An intrinsic surface: lengths (#E,) in the order of `edges` of a surface with these faces.");
  bind_arrays(c);
  bind_numbers(c);
  m.def("find_defects", [](const py::object& V, const py::object& F) {
    const auto points = positions_of(V);
    const auto faces = faces_of(F);
    const auto topological = find_defects(faces, points.rows());
    py::list out = defects(topological);
    for (const DefectReport& r : topological)
      if (r.defect == Defect::empty || r.defect == Defect::index_out_of_range) return out;
    for (const py::handle d : defects(find_defects(points, faces))) out.append(d);
    return out;
  });
  m.def("repair_weld", [](const py::object& V, const py::object& F) {
    return moved_faces(repair_weld(positions_of(V), faces_of(F)));
  });
  m.def("repair_orientation", [](const py::object& F, std::int64_t vertices) {
    return moved_faces(repair_orientation(faces_of(F), vertices));
  });
  m.def("repair_mesh", [](const py::object& V, const py::object& F, const std::vector<std::string>& repairs,
                          double tolerance, bool bow_ties) {
    RepairOptions options{.repairs = {}, .weld_tolerance = tolerance, .bow_ties = bow_ties};
    for (const std::string& text : repairs) options.repairs.push_back(named<Repair>(text, "repairs"));
    auto points = positions_of(V);
    auto faces = faces_of(F);
    RepairedMesh out =
        watched(py::none(), 0, [&] { return repair_mesh(std::move(points), std::move(faces), options); });
    py::list steps;
    for (const RepairStep& step : out.steps) {
      steps.append(
          py::dict("code"_a = step.code, "count"_a = step.count, "first"_a = step.first, "message"_a = step.message));
    }
    return py::make_tuple(moved_rows(std::move(out.V)), moved_faces(std::move(out.F)), moved(std::move(out.copies_of)),
                          moved(std::move(out.face_of)), steps);
  });
  m.def("shortest_path", [](const Surface& s, Index from, Index to) { return moved(shortest_path(s, from, to)); });
  m.def("dihedral_angles",
        [](const Surface& s) { return per(s.mesh().edges(), [&](Index e) { return dihedral_angle(s, e); }); });
}

}  // namespace alcap::python
