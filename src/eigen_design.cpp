// SPDX-License-Identifier: MIT
#include "alcap/eigen_design.h"

#include <chrono>
#include <cmath>
#include <string>

#include "alcap/energies.h"
#include "alcap/parallel.h"
#include "src/component_blocks.h"
#include "src/eigen_design_pencil.h"
#include "src/eigen_design_rows.h"

namespace alcap {
namespace {

using C = Complex<double>;

// w of a stroke of weight 1, in units of sqrt(area): measured to align to a few degrees on spheres, tori and disks.
constexpr double stroke_scale = 10;
// A stroke within this many degrees on average is followed.
constexpr double met_degrees = 10;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void validate(const Mesh& mesh, const std::vector<EigenStroke>& strokes, const EigenDesignOptions& options) {
  if (options.n < 1) throw OptionError("n", std::to_string(options.n), "the degree of a field is at least 1");
  if (options.largest_rank < 0)
    throw OptionError("largest_rank", std::to_string(options.largest_rank), "must not be negative");
  if (!(options.offset >= 0) || !std::isfinite(options.offset))
    throw OptionError("offset", std::to_string(options.offset), "must be finite and not negative");
  for (std::size_t k = 0; k < strokes.size(); ++k) {
    const std::string name = "strokes[" + std::to_string(k) + "]";
    const double weight = strokes[k].weight;
    if (!(weight > 0) || !std::isfinite(weight))
      throw OptionError(name + ".weight", std::to_string(weight), "must be positive and finite");
    if (strokes[k].line.segments.empty()) throw OptionError(name + ".line", "empty", "a stroke needs some length");
    for (const SurfaceSegment& segment : strokes[k].line.segments) {
      if (segment.face < 0 || segment.face >= mesh.faces())
        throw OptionError(name + ".line", std::to_string(segment.face),
                          "there is no such face; the mesh has " + std::to_string(mesh.faces()));
      if (!(segment.length > 0) || !std::isfinite(segment.length))
        throw OptionError(name + ".line", std::to_string(segment.length), "segments have a positive length");
    }
  }
}

/// Rows of a stroke with its weight multiplied in, vertices numbered as in their component.
void append(detail::StrokeRows& all, const detail::StrokeRows& rows, double weight, const std::vector<Index>& local) {
  const auto scaled = [&](const std::vector<detail::RealRow>& from, std::vector<detail::RealRow>& to) {
    for (detail::RealRow row : from) {
      for (std::size_t k = 0; k < static_cast<std::size_t>(row.size); ++k) {
        row.vertex[k] = local[static_cast<std::size_t>(row.vertex[k])];
        row.coefficient[k] *= std::sqrt(weight);
      }
      to.push_back(row);
    }
  };
  scaled(rows.across, all.across);
  scaled(rows.along, all.along);
}

EigenStrokeReport judge(const std::vector<detail::StrokeSample>& samples, int n, double area,
                        const ComplexVectorX<double>& u) {
  EigenStrokeReport report;
  double length = 0;
  for (const detail::StrokeSample& sample : samples) {
    const C value = sample.at(u);
    const double degrees = std::abs(std::arg(value)) / n * 180 / pi<double>;
    report.mean_degrees += sample.ds * degrees;
    report.largest_degrees = std::max(report.largest_degrees, degrees);
    report.magnitude += sample.ds * std::abs(value);
    length += sample.ds;
  }
  report.mean_degrees /= length;
  report.magnitude *= std::sqrt(area) / length;  // int |u|^2 = 1
  report.met = report.mean_degrees <= met_degrees;
  return report;
}

}  // namespace

EigenDesignResult eigen_design(const Mesh& mesh, const Geometry<double>& geometry, const Connection<double>& connection,
                               std::shared_ptr<const Frames<double>> frames, const std::vector<EigenStroke>& strokes,
                               const EigenDesignOptions& options) {
  validate(mesh, strokes, options);
  const auto start = std::chrono::steady_clock::now();
  EigenDesignResult result;
  result.field.n = options.n;
  result.field.frames = std::move(frames);
  result.field.u = ComplexVectorX<double>::Zero(mesh.vertices());
  StiffnessMass<double> matrices;
  {
    const HermitianPattern pattern(mesh);
    matrices = stiffness_and_mass(mesh, pattern, geometry, connection, options.n);
    apply_energy_family(mesh, pattern, geometry, connection, options.n, options.s, matrices.S);
  }
  const Topology topology = find_topology(mesh);
  const std::vector<double> areas = detail::areas_of_components(geometry, topology);
  const std::vector<std::vector<Index>> vertices = detail::vertices_of_components(topology);
  std::vector<Index> local(static_cast<std::size_t>(mesh.vertices()), none);
  for (const std::vector<Index>& piece : vertices)
    for (std::size_t k = 0; k < piece.size(); ++k) local[static_cast<std::size_t>(piece[k])] = static_cast<Index>(k);

  const auto component_of = [&](const EigenStroke& stroke) {
    return static_cast<std::size_t>(
        topology.face_component[static_cast<std::size_t>(stroke.line.segments.front().face)]);
  };
  std::vector<detail::StrokeRows> rows(areas.size());
  std::vector<double> sizes = areas;  // mass of a unit field, strokes included
  std::vector<std::vector<detail::StrokeSample>> samples;
  for (std::size_t k = 0; k < strokes.size(); ++k) {
    const std::size_t c = component_of(strokes[k]);
    for (const SurfaceSegment& segment : strokes[k].line.segments)
      if (topology.face_component[static_cast<std::size_t>(segment.face)] != static_cast<Index>(c))
        throw OptionError("strokes[" + std::to_string(k) + "].line", std::to_string(segment.face),
                          "a stroke stays on one component");
    const double weight = strokes[k].weight * stroke_scale * std::sqrt(areas[c]);
    append(rows[c],
           detail::stroke_rows(mesh, geometry, connection, options.n, strokes[k].line, options.offset / areas[c]),
           weight, local);
    samples.push_back(detail::samples_along(mesh, geometry, connection, options.n, strokes[k].line));
    sizes[c] += weight * strokes[k].line.length();
  }
  result.assembly_seconds = seconds_since(start);

  const auto solve_start = std::chrono::steady_clock::now();
  result.components.resize(areas.size());
  const bool whole = areas.size() == 1 && mesh.referenced_vertices() == mesh.vertices();
  parallel_for(
      static_cast<std::int64_t>(areas.size()),
      [&](std::int64_t i) {
        const auto c = static_cast<std::size_t>(i);
        const auto solve = [&](const SparseMatrix<C>& S, const SparseMatrix<C>& M) {
          return rows[c].along.empty() && options.path == EigenPath::automatic
                     ? smallest_eigenpair(S, M, areas[c], options.eigen)
                     : detail::smallest_with_rows(S, M, rows[c], sizes[c], options);
        };
        EigenResult eigen = whole ? solve(matrices.S, matrices.M)
                                  : solve(diagonal_block(matrices.S, vertices[c], local),
                                          diagonal_block(matrices.M, vertices[c], local));
        for (std::size_t k = 0; k < vertices[c].size(); ++k)
          result.field.u[vertices[c][k]] = eigen.u[static_cast<Eigen::Index>(k)];
        result.components[c] = std::move(eigen.report);
      },
      1);

  // Of u and -u the one that goes with the strokes.
  std::vector<double> along(areas.size(), 0.0);
  for (std::size_t k = 0; k < strokes.size(); ++k)
    for (const detail::StrokeSample& sample : samples[k])
      along[component_of(strokes[k])] += strokes[k].weight * sample.ds * sample.at(result.field.u).real();
  for (std::size_t c = 0; c < areas.size(); ++c)
    if (along[c] < 0)
      for (const Index v : vertices[c]) result.field.u[v] = -result.field.u[v];
  for (std::size_t k = 0; k < strokes.size(); ++k)
    result.strokes.push_back(judge(samples[k], options.n, areas[component_of(strokes[k])], result.field.u));
  result.eigen_seconds = seconds_since(solve_start);
  return result;
}

}  // namespace alcap
