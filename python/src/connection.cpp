// SPDX-License-Identifier: MIT
//
// connection.cpp: connections of all kinds, cones, frames, parallel transport.
#include "alcap/connection.h"

#include "alcap/cones.h"
#include "alcap/streamlines.h"
#include "alcap/transport.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"
#include "python/src/long_call.h"
#include "python/src/options.h"
#include "python/src/points.h"

namespace alcap::python {

std::vector<Cone> cones_of(const py::object& list) {
  std::vector<Cone> out;
  if (list.is_none()) return out;
  for (const py::handle item : list) {
    const auto pair = py::reinterpret_borrow<py::sequence>(item);
    out.push_back({.vertex = as<Index>(pair[0], "cones"), .index = as<double>(pair[1], "cones")});
  }
  return out;
}

py::list cones_list(const std::vector<Cone>& cones) {
  py::list out;
  for (const Cone& c : cones) out.append(py::make_tuple(c.vertex, c.index));
  return out;
}

namespace {

/// One array by its name.
ConnectionTarget target_of(const py::dict& d) {
  ConnectionTarget out;
  for (const auto& [key, value] : d) {
    const auto name = key.cast<std::string>();
    const VectorX<double> values = reals_of(py::reinterpret_borrow<py::object>(value), "target");
    if (name == "rotation") {
      out.rotation = values;
    } else if (name == "adjustment") {
      out.adjustment = values;
    } else if (name == "vertex_curvature") {
      out.vertex_curvature = values;
    } else if (name == "face_curvature") {
      out.face_curvature = values;
    } else {
      throw OptionError("target", name, "must be one of rotation adjustment vertex_curvature face_curvature");
    }
  }
  return out;
}

}  // namespace

ConnectionOptions connection_of(const py::dict& d) {
  ConnectionOptions out;
  for (const auto& [key, value] : d) {
    const auto name = key.cast<std::string>();
    const auto object = py::reinterpret_borrow<py::object>(value);
    if (name == "connection") {
      const auto text = as<std::string>(value, name);
      const auto choice = connection_choice(text);
      if (!choice) throw OptionError(name, text, "must be one of polar polar-barycenter local global trivial metric");
      out.kind = choice->kind;
      out.polar.center = choice->center;
    } else if (name == "detail") {
      out.global.detail = as<double>(value, name);
    } else if (name == "length_factor") {
      out.global.length_factor = named<LengthFactor>(as<std::string>(value, name), "length_factor");
    } else if (name == "tan_cap") {
      out.global.tan_cap = as<double>(value, name);
    } else if (name == "connection_tolerance") {
      out.global.tolerance = as<double>(value, name);
    } else if (name == "connection_iterations") {
      out.global.max_iterations = as<int>(value, name);
    } else if (name == "cones") {
      out.cones = cones_of(object);
    } else if (name == "balance_cones") {
      out.balance_cones = as<bool>(value, name);
    } else if (name == "generator_holonomy") {
      out.generator_holonomy = as<std::vector<double>>(value, name);
    } else if (name == "loop_index") {
      out.loop_index = as<std::vector<double>>(value, name);
    } else if (name == "target") {
      out.target = target_of(as<py::dict>(value, name));
    } else if (name == "spread") {
      out.spread = as<bool>(value, name);
    } else if (name == "n") {
      out.n = as<int>(value, name);
    } else {
      throw OptionError(name, py::str(object).cast<std::string>(), "is not an option of a connection");
    }
  }
  return out;
}

py::dict connection_dict(const ConnectionReport& r) {
  return py::dict("converged"_a = r.converged, "iterations"_a = r.iterations, "residual"_a = r.residual,
                  "D_T"_a = r.D_T, "D_E"_a = r.D_E, "message"_a = r.message);
}

namespace {

py::array reals(const ConnectedSurface& s, const VectorX<double>& values) {
  return shared(values.data(), {values.size()}, s);
}

void bind_frames(py::module_& m) {
  using Handle = std::shared_ptr<Frames>;
  py::class_<Frames, Handle> c(m, "Frames",
                               "Frames of vertices or faces: a unit axis X, a unit normal N, and Y = N x X. A complex\n"
                               "component z is the vector Re(z) X + Im(z) Y.");
  c.def(py::init([](const py::object& X, const py::object& N) {
          auto frames = std::make_shared<Frames>();
          frames->X = positions_of(X, "X");
          frames->N = positions_of(N, "N");
          if (frames->X.rows() != frames->N.rows())
            throw OptionError("N", frames->N.rows(), "must have as many rows as X");
          return frames;
        }),
        py::arg("X"), py::arg("N"));
  c.def_property_readonly(
      "X",
      [](const Handle& f) {
        return shared(f->X.data(), {f->X.rows(), 3}, f);
      },
      "(k, 3) float64, read-only, no copy: unit tangent axes.");
  c.def_property_readonly(
      "N",
      [](const Handle& f) {
        return shared(f->N.data(), {f->N.rows(), 3}, f);
      },
      "(k, 3) float64, read-only, no copy: unit normals.");
  c.def(
      "vectors",
      [](const Frames& f, const py::object& z) {
        const auto values = complex_of(z, "z", f.X.rows());
        Positions<double> out(f.X.rows(), 3);
        for (Index k = 0; k < out.rows(); ++k) out.row(k) = f.vector(k, values[k]);
        return moved_rows(std::move(out));
      },
      py::arg("z"), "(k, 3) float64: the tangent vectors with components z (k,).");
  c.def(
      "components",
      [](const Frames& f, const py::object& w) {
        const auto rows = positions_of(w, "w");
        if (rows.rows() != f.X.rows()) throw OptionError("w", rows.rows(), "must have a row per frame");
        ComplexVectorX<double> out(rows.rows());
        for (Index k = 0; k < rows.rows(); ++k) out[k] = f.component(k, rows.row(k));
        return moved(std::move(out));
      },
      py::arg("w"), "(k,) complex128: the components of the projections of vectors w (k, 3).");
  m.def("face_frames", [](const Surface& s) { return std::make_shared<Frames>(face_frames(s)); });
}

void bind_connected(py::module_& m) {
  py::class_<ConnectedSurface, Surface> c(
      m, "ConnectedSurface",
      "A surface with a connection on it, see connect(). Angles are radians, frames and signs those of\n"
      "docs/notation.md: rho turns components from vertex to vertex, K is the curvature of a face.");
  const auto prop = [&](const char* name, auto get, const char* doc) { c.def_property_readonly(name, get, doc); };
  prop(
      "kind", [](const ConnectedSurface& s) { return name(s.connection().kind); },
      "str: 'polar', 'local', 'global', 'trivial' or 'metric'.");
  prop(
      "rho", [](const ConnectedSurface& s) { return reals(s, s.connection().rho); },
      "(#E,) float64, no copy: rotation from vertex to vertex along the canonical halfedge.");
  prop(
      "rho_e", [](const ConnectedSurface& s) { return reals(s, s.connection().rho_e); },
      "(2 #E,) float64, no copy: rotation from either vertex to the edge.");
  prop(
      "rho_t", [](const ConnectedSurface& s) { return reals(s, s.connection().rho_t); },
      "(3 #F,) float64, no copy: rotation from the vertex of a corner to its face.");
  prop(
      "tau", [](const ConnectedSurface& s) { return reals(s, s.connection().tau); },
      "(3 #F,) float64, no copy: lifted rotation along a halfedge inside its face.");
  prop(
      "eps", [](const ConnectedSurface& s) { return reals(s, s.connection().eps); },
      "(#E,) float64, no copy: lifted rotation along the canonical halfedge, within the edge.");
  prop(
      "K", [](const ConnectedSurface& s) { return reals(s, s.connection().K); },
      "(#F,) float64, no copy: lifted curvature; an n-field sees n K.");
  prop(
      "cones", [](const ConnectedSurface& s) { return cones_list(s.connection().cones); },
      "list of (vertex, index in turns): the cones of a trivial connection.");
  prop(
      "alpha", [](const ConnectedSurface& s) { return reals(s, s.connection().alpha); },
      "(3 #F,) float64, no copy: adjustment angle of each halfedge of trivial and metric connections; else empty.");
  prop(
      "generator_holonomy", [](const ConnectedSurface& s) { return s.connection().generator_holonomy; },
      "list of float: holonomies of homology_generators(), in turns, of trivial and metric connections.");
  prop(
      "loop_index", [](const ConnectedSurface& s) { return s.connection().loop_index; },
      "list of float: index of each of boundary_loops, in turns, of trivial and metric connections.");
  prop(
      "flat", [](const ConnectedSurface& s) { return s.connection().flat; }, "bool: no curvature but at the cones.");
  prop(
      "to_target", [](const ConnectedSurface& s) { return s.connection().to_target; }, "bool: nearest to a target.");
  prop(
      "frames", [](const ConnectedSurface& s) { return std::const_pointer_cast<Frames>(s.frames()); },
      "Frames of the vertices.");
  prop(
      "connection_report", [](const ConnectedSurface& s) { return connection_dict(s.connection().report); },
      "dict: converged, iterations, residual, D_T, D_E, message.");
  c.def(
      "admits_parallel", [](const ConnectedSurface& s, int n) { return s.connection().admits_parallel(n); },
      py::arg("n"), "Whether an n-field can be parallel everywhere but at the cones of a flat connection.");
  c.def(
      "rho_along",
      [](const ConnectedSurface& s, Index h) {
        if (h < 0 || h >= s.mesh().halfedges()) throw OptionError("h", h, "must be a halfedge, in [0, H)");
        return s.connection().rho_along(s.mesh(), h);
      },
      py::arg("h"), "Rotation from vertex to vertex along halfedge h, radians.");
  c.def(
      "holonomy",
      [](const ConnectedSurface& s, const py::object& strip) {
        return holonomy(s, Loop{.component = 0, .halfedges = indices_of(strip, "strip")});
      },
      py::arg("strip"),
      "How far a vector has turned after a closed strip of faces, given by the halfedges it crosses.");
}

py::tuple transported(const Transported& t) { return py::make_tuple(t.z, t.turn, t.turn_from_path); }

}  // namespace

void bind_connection(py::module_& m) {
  bind_frames(m);
  bind_connected(m);
  m.def("connect", [](const Surface& s, const py::dict& options, const py::object& progress, int threads) {
    const ConnectionOptions how = connection_of(options);
    return watched(progress, threads, [&] { return connect(s, how); });
  });
  m.def("balance_cones", [](const Surface& s, const py::object& cones, int n) {
    const auto given = cones_of(cones);
    return cones_list(watched(py::none(), 0, [&] { return balance_cones(s, given, {.n = n}); }));
  });
  m.def("transport_along_vertices", [](const ConnectedSurface& s, const py::object& path, Complex<double> z, int n) {
    return transported(transport(s, indices_of(path, "vertices"), z, n));
  });
  m.def("transport_along_curve",
        [](const ConnectedSurface& s, const CurveSet& curves, std::int64_t k, Complex<double> z, int n) {
          if (k < 0 || k >= curves.size()) throw OptionError("k", k, "must be a curve of the set, in [0, size)");
          return transported(transport(s, curves.path(k), z, n));
        });
  m.def("transport_along_points",
        [](const ConnectedSurface& s, const py::object& faces, const py::object& barycentric, Complex<double> z,
           int n) { return transported(transport(s, points_of(faces, barycentric), z, n)); });
  m.def("transport_along_line", [](const ConnectedSurface& s, const SurfacePolyline& path, Complex<double> z, int n) {
    return transported(transport(s, path, z, n));
  });
}

}  // namespace alcap::python
