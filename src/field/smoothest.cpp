// SPDX-License-Identifier: MIT
#include "alcap/smoothest.h"

#include <string>
#include <utility>

#include "alcap/connected_surface.h"
#include "alcap/energies.h"
#include "src/base/cancel.h"
#include "src/base/clock.h"
#include "src/base/parallel.h"
#include "src/field/component_blocks.h"
#include "src/field/smoothest_on.h"

namespace alcap {
namespace {

// Of the components whose `wanted` is not 0; empty: of all. The others stay zero, with empty reports.
SmoothestResult solve(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                      const Topology& topology, const SmoothestOptions& options, const std::vector<char>& wanted = {}) {
  if (options.n < 1) throw OptionError("n", options.n, "the degree of a field is at least 1");
  const detail::ControlScope scope(options.eigen.cancel);

  detail::Stopwatch watch;
  SmoothestResult result;
  result.field.n = options.n;
  // Made in place: Eigen's sparse matrices copy when they are moved.
  const StiffnessMass matrices = energy_matrices(mesh, geometry, connection, options.n, options.s);
  result.assembly_seconds = watch.lap();

  const std::vector<double> areas = detail::areas_of_components(geometry, topology);
  EigenOptions eigen_options = options.eigen;
  eigen_options.degree = options.n;
  if (topology.components.size() == 1 && mesh.referenced_vertices() == mesh.vertices()) {
    EigenResult eigen = smallest_eigenpair(matrices.S, matrices.M, areas[0], eigen_options);
    result.field.u = std::move(eigen.u);
    result.components.push_back(std::move(eigen.report));
  } else {
    // Pieces are independent: each is its own problem, several small ones run side by side.
    result.field.u = ComplexVectorX<double>::Zero(mesh.vertices());
    result.components.resize(topology.components.size());
    const std::vector<std::vector<Index>> vertices = detail::vertices_of_components(topology);
    std::vector<Index> local(static_cast<std::size_t>(mesh.vertices()), none);
    for (const std::vector<Index>& piece : vertices)
      for (std::size_t k = 0; k < piece.size(); ++k) local[static_cast<std::size_t>(piece[k])] = static_cast<Index>(k);
    parallel_for(
        static_cast<std::int64_t>(vertices.size()),
        [&](std::int64_t i) {
          const auto c = static_cast<std::size_t>(i);
          if (!wanted.empty() && wanted[c] == 0) return;
          EigenResult eigen =
              smallest_eigenpair(diagonal_block(matrices.S, vertices[c], local),
                                 diagonal_block(matrices.M, vertices[c], local), areas[c], eigen_options);
          for (std::size_t k = 0; k < vertices[c].size(); ++k)
            result.field.u[vertices[c][k]] = eigen.u[static_cast<Eigen::Index>(k)];
          result.components[c] = std::move(eigen.report);
        },
        1);
  }
  result.eigen_seconds = watch.seconds();
  return result;
}

}  // namespace

SmoothestResult detail::smoothest_on(const ConnectedSurface& surface, const std::vector<char>& wanted,
                                     const SmoothestOptions& options) {
  SmoothestResult result =
      solve(surface.mesh(), surface.geometry(), surface.connection(), surface.topology(), options, wanted);
  if (surface.in_space()) result.field.frames = surface.frames();
  return result;
}

SmoothestResult smoothest_field(const ConnectedSurface& surface, const SmoothestOptions& options) {
  SmoothestResult result = solve(surface.mesh(), surface.geometry(), surface.connection(), surface.topology(), options);
  if (surface.in_space()) result.field.frames = surface.frames();
  return result;
}

SmoothestResult smoothest_field(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                                std::shared_ptr<const Frames> frames, const SmoothestOptions& options) {
  SmoothestResult result = solve(mesh, geometry, connection, find_topology(mesh), options);
  result.field.frames = std::move(frames);
  return result;
}

EigenModes smoothest_modes(const ConnectedSurface& surface, int count, const SmoothestOptions& options) {
  if (options.n < 1) throw OptionError("n", options.n, "the degree of a field is at least 1");
  const detail::ControlScope scope(options.eigen.cancel);
  const Mesh& mesh = surface.mesh();
  const StiffnessMass matrices = energy_matrices(mesh, surface.geometry(), surface.connection(), options.n, options.s);
  const double area = surface.geometry().total_area();
  if (mesh.referenced_vertices() == mesh.vertices())
    return eigenpairs(matrices.S, matrices.M, area, count, options.eigen);
  std::vector<Index> used, local(static_cast<std::size_t>(mesh.vertices()), none);
  for (Index v = 0; v < mesh.vertices(); ++v) {
    if (!mesh.referenced(v)) continue;
    local[static_cast<std::size_t>(v)] = static_cast<Index>(used.size());
    used.push_back(v);
  }
  EigenModes modes = eigenpairs(diagonal_block(matrices.S, used, local), diagonal_block(matrices.M, used, local), area,
                                count, options.eigen);
  MatrixX<std::complex<double>> U = MatrixX<std::complex<double>>::Zero(mesh.vertices(), modes.U.cols());
  for (std::size_t k = 0; k < used.size(); ++k) U.row(used[k]) = modes.U.row(static_cast<Eigen::Index>(k));
  modes.U = std::move(U);
  return modes;
}

}  // namespace alcap
