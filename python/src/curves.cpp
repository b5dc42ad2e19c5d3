// SPDX-License-Identifier: MIT
//
// curves.cpp: strokes on the surface, integral curves of fields.
#include "alcap/connected_surface.h"
#include "alcap/streamlines.h"
#include "alcap/strokes.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"
#include "python/src/long_call.h"
#include "python/src/points.h"
#include "python/src/singularity_array.h"

namespace alcap::python {

std::vector<SurfacePoint> points_of(const py::object& faces, const py::object& barycentric) {
  const auto list = indices_of(faces, "faces");
  const auto rows = positions_of(barycentric, "barycentric");
  if (rows.rows() != static_cast<Eigen::Index>(list.size()))
    throw OptionError("barycentric", rows.rows(), "must have a row per face");
  std::vector<SurfacePoint> out(list.size());
  for (std::size_t k = 0; k < list.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    out[k] = {list[k], {rows(row, 0), rows(row, 1), rows(row, 2)}};
  }
  return out;
}

namespace {

struct CurveChoice {
  StreamlineOptions options;
  explicit CurveChoice(const py::dict& d) {
    for (const auto& [key, value] : d) {
      const auto name = key.cast<std::string>();
      if (name == "sides") {
        options.sides = named<CurveSides>(as<std::string>(value, name), "sides");
      } else if (name == "max_curves") {
        options.max_curves = as<std::int64_t>(value, name);
      } else if (name == "max_points") {
        options.max_points = as<std::int64_t>(value, name);
      } else if (double* real = number(name)) {
        *real = as<double>(value, name);
      } else {
        throw OptionError(name, py::str(py::reinterpret_borrow<py::object>(value)).cast<std::string>(),
                          "is not an option of curves");
      }
    }
  }

 private:
  double* number(const std::string& name) {
    if (name == "spacing") return &options.spacing;
    if (name == "separation") return &options.separation;
    if (name == "min_length") return &options.min_length;
    if (name == "max_length") return &options.max_length;
    if (name == "tolerance") return &options.tolerance;
    if (name == "singularity_radius") return &options.singularity_radius;
    if (name == "drift") return &options.drift;
    return nullptr;
  }
};

py::list reasons(const std::vector<CurveEnd>& list) {
  py::list out;
  for (const CurveEnd e : list) out.append(name(e));
  return out;
}

using Curves = std::shared_ptr<CurveSet>;
Curves handle(CurveSet set) { return std::make_shared<CurveSet>(std::move(set)); }

void bind_sets(py::module_& m) {
  py::class_<CurveSet, Curves> c(m, "CurveSet",
                                 "Polylines on a surface: curve k is points[offsets[k]:offsets[k + 1]].");
  c.def_property_readonly(
      "points",
      [](const Curves& s) {
        return shared(s->points.data(), {s->points.rows(), 3}, s);
      },
      "(#P, 3) float64, read-only, no copy.");
  c.def_property_readonly(
      "barycentric",
      [](const Curves& s) {
        return shared(s->barycentric.data(), {s->barycentric.rows(), 3}, s);
      },
      "(#P, 3) float64, read-only, no copy: coordinates in `faces`.");
  c.def_property_readonly(
      "faces", [](const Curves& s) { return shared(s->faces.data(), {static_cast<py::ssize_t>(s->faces.size())}, s); },
      "(#P,) int32, read-only, no copy: the face of the segment that ends at each point.");
  c.def_property_readonly(
      "offsets",
      [](const Curves& s) { return shared(s->offsets.data(), {static_cast<py::ssize_t>(s->offsets.size())}, s); },
      "(#curves + 1,) int64, read-only, no copy.");
  c.def_property_readonly(
      "start_reasons", [](const Curves& s) { return reasons(s->start_reason); },
      "list of str: why each curve starts where it does.");
  c.def_property_readonly(
      "end_reasons", [](const Curves& s) { return reasons(s->end_reason); },
      "list of str: why each curve ends where it does.");
  c.def_readonly("spacing", &CurveSet::spacing,
                 "float: of evenly spaced curves, what was asked for, in box diagonals; 0 of others.");
  c.def_readonly("n", &CurveSet::n, "int: of evenly spaced curves, the degree of the field; 0 of others.");
  c.def_readonly("complete", &CurveSet::complete,
                 "bool: False where max_points was used up before everything asked for was traced.");
  c.def(
      "path",
      [](const CurveSet& s, std::int64_t k) {
        const std::vector<SurfacePoint> line = s.path(k);
        std::vector<Index> faces;
        Positions<double> rows(static_cast<Eigen::Index>(line.size()), 3);
        for (const SurfacePoint& p : line) {
          rows.row(static_cast<Eigen::Index>(faces.size())) << p.barycentric[0], p.barycentric[1], p.barycentric[2];
          faces.push_back(p.face);
        }
        return py::make_tuple(moved(std::move(faces)), moved_rows(std::move(rows)));
      },
      py::arg("k"),
      "(faces (k,), barycentric (k, 3)): the points of curve k, each of which lies in a face with the next one, for\n"
      "polyline_through() and transport_along_points().");
  c.def("__len__", &CurveSet::size);
  c.def(
      "__getitem__",
      [](const Curves& s, std::int64_t k) {
        if (k < 0 || k >= s->size()) throw py::index_error();
        const auto first = s->offsets[static_cast<std::size_t>(k)], last = s->offsets[static_cast<std::size_t>(k) + 1];
        return shared(s->points.data() + 3 * first, {last - first, 3}, s);
      },
      py::arg("k"), "(k, 3) float64, read-only, no copy: the points of curve k.");
  c.def(
      "length",
      [](const CurveSet& s, std::int64_t k) {
        if (k < 0 || k >= s.size()) throw py::index_error();
        return s.length(k);
      },
      py::arg("k"), "The length of curve k.");
}

void bind_lines(py::module_& m) {
  using Line = std::shared_ptr<SurfacePolyline>;
  py::class_<SurfacePolyline, Line> c(m, "Polyline",
                                      "A polyline on a surface, cut into segments that each lie in a face.");
  c.def_property_readonly(
      "segments",
      [](const Line& s) { return shared(s->segments.data(), {static_cast<py::ssize_t>(s->segments.size())}, s); },
      "(#S,) structured array, read-only, no copy: face, a, b (barycentric), tangent (complex), length.");
  c.def_readonly("closed", &SurfacePolyline::closed, "bool: the end is the start.");
  c.def_property_readonly("length", &SurfacePolyline::length, "float: the sum of the segments.");
  c.def(
      "reversed", [](const SurfacePolyline& s) { return std::make_shared<SurfacePolyline>(s.reversed()); },
      "The same line the other way round.");
  c.def("__len__", [](const SurfacePolyline& s) { return s.segments.size(); });
  m.def("stroke_through_points", [](const Surface& s, const py::object& faces, const py::object& barycentric) {
    return std::make_shared<SurfacePolyline>(stroke_through_points(s, points_of(faces, barycentric)));
  });
  m.def("polyline_through", [](const Surface& s, const py::object& faces, const py::object& barycentric) {
    return std::make_shared<SurfacePolyline>(polyline_through(s, points_of(faces, barycentric)));
  });
  m.def("stroke_along_vertices", [](const Surface& s, const py::object& vertices) {
    return std::make_shared<SurfacePolyline>(stroke_along_vertices(s, indices_of(vertices, "vertices")));
  });
  m.def("stroke_from_space", [](const Surface& s, const py::object& points) {
    return std::make_shared<SurfacePolyline>(stroke_from_space(s, positions_of(points, "points")));
  });
  py::class_<SurfaceLocator>(m, "SurfaceLocator", "Closest points on a surface, by a tree of boxes.")
      .def(py::init<const Surface&>(), py::arg("surface"))
      .def(
          "closest",
          [](const SurfaceLocator& l, const py::object& points) {
            const auto rows = positions_of(points, "points");
            std::vector<Index> faces(static_cast<std::size_t>(rows.rows()));
            Positions<double> coordinates(rows.rows(), 3);
            for (Eigen::Index k = 0; k < rows.rows(); ++k) {
              const SurfacePoint p = l.closest(rows.row(k));
              faces[static_cast<std::size_t>(k)] = p.face;
              coordinates.row(k) << p.barycentric[0], p.barycentric[1], p.barycentric[2];
            }
            return py::make_tuple(moved(std::move(faces)), moved_rows(std::move(coordinates)));
          },
          py::arg("points"), "(faces (k,), barycentric (k, 3)): the surface's points closest to points (k, 3).");
}

}  // namespace

void bind_curves(py::module_& m) {
  PYBIND11_NUMPY_DTYPE(SurfaceSegment, face, a, b, tangent, length);
  bind_sets(m);
  bind_lines(m);
  m.def("streamlines", [](const ConnectedSurface& s, const Field& f, const py::dict& options,
                          const py::object& progress, const Curves& earlier) {
    const CurveChoice how(options);
    return handle(watched(progress, 0, [&] {
      return earlier ? update_streamlines(s, f, *earlier, how.options) : streamlines(s, f, how.options);
    }));
  });
  m.def("trace_curves",
        [](const ConnectedSurface& s, const Field& f, const py::object& faces, const py::object& barycentric,
           const py::object& angles, const py::dict& options, const py::object& progress) {
          const CurveChoice how(options);
          const auto points = points_of(faces, barycentric);
          const auto directions = reals_of(angles, "angles", static_cast<std::int64_t>(points.size()));
          std::vector<CurveSeed> seeds;
          for (std::size_t k = 0; k < points.size(); ++k)
            seeds.push_back({points[k], directions[static_cast<Eigen::Index>(k)]});
          return handle(watched(progress, 0, [&] { return trace_curves(s, f, seeds, how.options); }));
        });
  m.def("separatrices", [](const ConnectedSurface& s, const Field& f, const py::object& list, const py::dict& options,
                           const py::object& progress) {
    const CurveChoice how(options);
    const auto singularities = singularities_of(list);
    return handle(watched(progress, 0, [&] { return separatrices(s, f, singularities, how.options); }));
  });
}

}  // namespace alcap::python
