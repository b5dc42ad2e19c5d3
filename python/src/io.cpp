// SPDX-License-Identifier: MIT
//
// io.cpp: meshes, fields and curves to and from files.
#include "alcap/handoff.h"
#include "alcap/mesh_io.h"
#include "alcap/output.h"
#include "python/src/bindings.h"
#include "python/src/features.h"
#include "python/src/long_call.h"
#include "python/src/singularity_array.h"

namespace alcap::python {
namespace {

py::tuple mesh_tuple(MeshFile file) {
  py::dict ignored;
  for (const auto& [kind, count] : file.ignored) ignored[py::str(kind)] = count;
  return py::make_tuple(moved_rows(std::move(file.V)), moved_faces(std::move(file.F)), file.format,
                        moved(std::move(file.polygon_of)), ignored, file.bytes);
}

ReadOptions read_options(const std::string& polygons, const std::string& format) {
  return {.polygons = named<ReadOptions::Polygons>(polygons, "polygons"), .format = format};
}

py::list names(const std::vector<std::filesystem::path>& files) {
  py::list out;
  for (const auto& path : files) out.append(path.string());
  return out;
}

py::list write(const ConnectedSurface& surface, const Field& field, const py::object& list,
               const std::vector<std::string>& files, const py::dict& scalars, bool unit, const py::object& progress) {
  const auto singularities = singularities_of(list);
  std::vector<VectorX<double>> values;
  std::vector<FaceScalars> faces;
  for (const auto& [key, value] : scalars)
    values.push_back(reals_of(py::reinterpret_borrow<py::object>(value), "face_scalars", surface.mesh().faces()));
  std::size_t k = 0;
  for (const auto& [key, value] : scalars) {
    const VectorX<double>& v = values[k++];
    faces.push_back({key.cast<std::string>(), {v.data(), static_cast<std::size_t>(v.size())}});
  }
  const std::vector<std::filesystem::path> paths(files.begin(), files.end());
  const auto written = watched(progress, 0, [&] {
    return write_field(
        {.surface = surface, .field = field, .singularities = singularities, .face_scalars = faces, .unit = unit},
        std::span(paths));
  });
  return names(written);
}

}  // namespace

void bind_io(py::module_& m) {
  m.def("read_mesh", [](const std::string& path, const std::string& polygons, const std::string& format,
                        const py::object& progress) {
    const ReadOptions options = read_options(polygons, format);
    return mesh_tuple(watched(progress, 0, [&] { return read_mesh(path, options); }));
  });
  m.def("read_mesh_from_memory", [](const py::bytes& bytes, const std::string& polygons, const std::string& format) {
    const std::string text = bytes;
    const ReadOptions options = read_options(polygons, {});
    return mesh_tuple(watched(py::none(), 0, [&] { return read_mesh_from_memory(text, format, options); }));
  });
  m.def("write_mesh", [](const std::string& path, const py::object& V, const py::object& F) {
    const auto points = positions_of(V);
    const auto faces = faces_of(F);
    long_call(py::none(), 0, [&] { write_mesh(path, points, faces); });
  });
  m.def("write_field", &write);
  m.def("read_field", [](const std::string& path) {
    FieldFile file = watched(py::none(), 0, [&] { return read_field(path); });
    const py::ssize_t faces = file.F.rows();
    return py::make_tuple(moved_rows(std::move(file.V)), moved(std::move(file.F), {faces, 3}),
                          std::make_shared<Field>(std::move(file.field)), name(file.connection), file.connection_known);
  });
  m.def("write_curves", [](const CurveSet& curves, int n, const std::string& path) {
    long_call(py::none(), 0, [&] { write_curves(curves, n, path); });
  });
  m.def("read_edge_lengths", [](const std::string& path, const py::object& F, std::int64_t vertices) {
    const Mesh mesh(faces_of(F), vertices);
    return moved(watched(py::none(), 0, [&] { return read_edge_lengths(path, mesh); }));
  });
  m.def("write_scalars", [](const std::string& path, const py::object& values, const std::string& name) {
    const VectorX<double> numbers = reals_of(values, "values");
    long_call(py::none(), 0, [&] { write_scalars(numbers, name, path); });
  });
  m.def("write_for", [](const std::string& reader, const ConnectedSurface& surface, const Field& field,
                        const py::object& list, const py::object& features, const std::string& stem) {
    const auto which = named<Reader>(reader, "reader");
    const auto singularities = singularities_of(list);
    std::optional<FeatureGraph> graph;
    if (!features.is_none()) graph = graph_of(features);
    return names(watched(py::none(), 0, [&] {
      return write_for(which, {.surface = surface, .field = field, .singularities = singularities},
                       graph ? &*graph : nullptr, stem);
    }));
  });
  m.def("scalar_formats", &scalar_formats);
  m.def("usual_field_formats", &usual_field_formats);
  m.def("mesh_formats", &mesh_formats);
  m.def("field_formats", &field_formats);
  m.def("curve_formats", &curve_formats);
}

}  // namespace alcap::python
