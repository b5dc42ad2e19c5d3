// SPDX-License-Identifier: MIT
//
// aligned.cpp: sharp edges as a graph, and fields that run along them.
#include "alcap/aligned.h"

#include "alcap/connected_surface.h"
#include "alcap/mesh_io.h"
#include "alcap/output.h"
#include "alcap/sizing.h"
#include "python/src/bindings.h"
#include "python/src/features.h"
#include "python/src/long_call.h"
#include "python/src/options.h"

namespace alcap::python {
namespace {

constexpr std::array vertex_kinds{"smooth", "end", "crease", "corner"};

}  // namespace

py::dict graph_dict(const FeatureGraph& graph) {
  py::list lines, vertices;
  for (const FeatureLine& line : graph.lines)
    lines.append(
        py::make_tuple(moved(std::vector<Index>(line.vertices)), moved(std::vector<Index>(line.edges)), line.closed));
  for (const FeatureVertex v : graph.vertices) vertices.append(vertex_kinds.at(static_cast<std::size_t>(v)));
  return py::dict("edges"_a = moved(std::vector<Index>(graph.edges)),
                  "angles"_a = moved(std::vector<double>(graph.angles)), "vertices"_a = vertices, "lines"_a = lines);
}

FeatureGraph graph_of(const py::object& graph) {
  FeatureGraph out;
  out.edges = indices_of(graph.attr("edges"), "edges");
  const VectorX<double> angles = reals_of(graph.attr("angles"), "angles", static_cast<std::int64_t>(out.edges.size()));
  out.angles.assign(angles.begin(), angles.end());
  for (const py::handle v : graph.attr("vertices")) {
    const auto text = as<std::string>(v, "vertices");
    const auto* const kind = std::find(vertex_kinds.begin(), vertex_kinds.end(), text);
    if (kind == vertex_kinds.end()) throw OptionError("vertices", text, "is not a kind of vertex");
    out.vertices.push_back(static_cast<FeatureVertex>(kind - vertex_kinds.begin()));
  }
  for (const py::handle line : graph.attr("lines"))
    out.lines.push_back({indices_of(line.attr("vertices"), "vertices"), indices_of(line.attr("edges"), "edges"),
                         as<bool>(line.attr("closed"), "closed")});
  return out;
}

py::list pieces_list(const std::vector<AlignedPiece>& list) {
  py::list out;
  for (const AlignedPiece& piece : list) {
    py::list steps;
    for (const AlignedStep& s : piece.steps)
      steps.append(py::make_tuple(s.tau, s.energy, s.largest_degrees, s.rms_degrees));
    const py::object eigen = piece.eigen ? py::object(eigen_dict(*piece.eigen)) : py::none();
    out.append(py::dict("eigen"_a = eigen, "held"_a = piece.held, "rows"_a = piece.rows, "lambda"_a = piece.lambda,
                        "steps"_a = steps, "settled"_a = piece.settled, "residual"_a = piece.residual,
                        "solver"_a = piece.solver));
  }
  return out;
}

namespace {

py::dict deviation(const LineDeviation& line) {
  return py::dict("edges"_a = line.edges, "corner_edges"_a = line.corner_edges, "length"_a = line.length,
                  "mean_degrees"_a = line.mean_degrees, "p95_degrees"_a = line.p95_degrees,
                  "worst_degrees"_a = line.worst_degrees, "corner_worst_degrees"_a = line.corner_worst_degrees,
                  "singularities"_a = line.singularities);
}

}  // namespace

py::dict deviations_dict(const FeatureReport& report) {
  py::list lines;
  for (const LineDeviation& line : report.lines) lines.append(deviation(line));
  return py::dict("lines"_a = lines, "all"_a = deviation(report.all),
                  "singularities_at_corners"_a = report.singularities_at_corners);
}

SharpEdgeOptions sharp_options(const py::dict& d) {
  return {.angle = as<double>(d["angle"], "angle"),
          .corner_angle = as<double>(d["corner_angle"], "corner_angle"),
          .boundary = as<bool>(d["boundary"], "boundary"),
          .creases = as<bool>(d["creases"], "creases"),
          .low_angle = as<double>(d["low_angle"], "low_angle"),
          .gap = as<double>(d["gap"], "gap"),
          .spur = as<double>(d["spur"], "spur")};
}

namespace {

py::object pairs_array(const std::vector<std::array<Index, 2>>& pairs) {
  std::vector<Index> flat;
  for (const auto& pair : pairs) flat.insert(flat.end(), pair.begin(), pair.end());
  return moved(std::move(flat), {static_cast<py::ssize_t>(pairs.size()), 2});
}

AlignedOptions options_of(const py::dict& d) {
  AlignedOptions out{.n = as<int>(d["n"], "n"),
                     .across = as<bool>(d["across"], "across"),
                     .weight = as<double>(d["weight"], "weight"),
                     .linear = as<bool>(d["linear"], "linear"),
                     .max_steps = as<int>(d["max_steps"], "max_steps"),
                     .settled_degrees = as<double>(d["settled_degrees"], "settled_degrees"),
                     .finest = as<double>(d["finest"], "finest")};
  out.eigen.solver = as<std::string>(d["solver"], "solver");
  for (const py::handle c : d["fixed"])
    out.fixed.push_back(
        {.vertex = as<Index>(c.attr("vertex"), "vertex"), .value = as<Complex<double>>(c.attr("value"), "value")});
  return out;
}

}  // namespace

void bind_aligned(py::module_& m) {
  m.def("sharp_edges",
        [](const Surface& s, const py::dict& options) { return graph_dict(sharp_edges(s, sharp_options(options))); });
  m.def("edges_between",
        [](const Surface& s, const py::object& list) { return moved(edges_between(s, pairs_of(list, "pairs"))); });
  m.def("read_sharp",
        [](const std::string& path, const py::object& F) { return pairs_array(read_sharp(faces_of(F), path)); });
  m.def("read_feature_edges", [](const std::string& path, const py::object& F, std::int64_t vertices) {
    return pairs_array(read_feature_edges(faces_of(F), vertices, path));
  });
  m.def("write_sharp", [](const Surface& s, const py::object& features, const std::string& path) {
    const FeatureGraph graph = graph_of(features);
    long_call(py::none(), 0, [&] { write_sharp(s, graph, path); });
  });
  m.def("target_edge_lengths", [](const Surface& s, const py::object& features, const py::dict& d) {
    const FeatureGraph graph = graph_of(features);
    const SizingOptions options{.error = as<double>(d["error"], "error"),
                                .smallest = as<double>(d["smallest"], "smallest"),
                                .largest = as<double>(d["largest"], "largest"),
                                .growth = as<double>(d["growth"], "growth"),
                                .rings = as<int>(d["rings"], "rings")};
    return moved(watched(py::none(), 0, [&] { return target_edge_lengths(s, graph, options); }));
  });
  m.def("feature_graph", [](const Surface& s, const py::object& list, double corner_angle, double gap, double spur) {
    const SharpEdgeOptions options{.corner_angle = corner_angle, .gap = gap, .spur = spur};
    return graph_dict(feature_graph(s, indices_of(list, "edges"), options));
  });
  m.def("feature_directions", [](const ConnectedSurface& s, const py::object& features, int n, bool across) {
    FeatureDirections found = feature_directions(s, graph_of(features), n, across);
    std::vector<Index> vertices;
    std::vector<Complex<double>> values;
    for (const VertexConstraint& held : found.held) {
      vertices.push_back(held.vertex);
      values.push_back(held.value);
    }
    return py::make_tuple(moved(std::move(vertices)), moved(std::move(values)), moved(std::move(found.free_corners)));
  });
  m.def("aligned_field", [](const ConnectedSurface& s, const py::object& features, const py::dict& options,
                            const py::object& progress, int threads) {
    const FeatureGraph graph = graph_of(features);
    const AlignedOptions how = options_of(options);
    AlignedResult r = watched(progress, threads, [&] { return aligned_field(s, graph, how); });
    return py::make_tuple(std::make_shared<Field>(std::move(r.field)), pieces_list(r.pieces),
                          moved(std::move(r.free_corners)), r.fixed_degrees);
  });
  m.def("measure_features", [](const ConnectedSurface& s, const Field& field, const py::object& features, bool across) {
    return deviations_dict(measure_features(s, field, graph_of(features), find_singularities(s, field), across));
  });
}

}  // namespace alcap::python
