// SPDX-License-Identifier: MIT
#include "src/distributed/design_guidance.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>

#include "src/base/array.h"
#include "src/base/bytes.h"
#include "src/distributed/parallel_file.h"
#include "src/field/curvature_means.h"
#include "src/io/field/field_table.h"
#include "src/run/design_stages.h"

namespace alcap::detail::distributed {
namespace {

/// u, axis and normal of a vertex.
using FieldRow = std::array<double, 8>;

std::vector<FieldRow> read_rows(const std::string& path, const MeshSlice& mesh, int n) {
  constexpr std::int64_t longest_header = 1 << 20;
  const ParallelInput file(path);
  const std::vector<char> start = file.read(0, rank() == 0 ? std::min(file.size(), longest_header) : 0);
  std::vector<FieldTable> table;
  agreed([&] {
    if (rank() != 0) return;
    table.push_back(find_field_table(path, {start.data(), start.size()}));
    if (table[0].n != n) throw_other_degree(path, table[0].n, n);
  });
  table = gather_all(table);
  const FieldColumns& columns = table[0].columns;
  const auto stride = static_cast<std::int64_t>(columns.stride);
  const std::vector<char> bytes =
      file.read(table[0].body + mesh.first_vertex * stride, static_cast<std::int64_t>(mesh.V.rows()) * stride);
  std::vector<FieldRow> rows(at(mesh.V.rows()));
  agreed([&] {
    for (std::size_t v = 0; v < rows.size(); ++v)
      for (std::size_t i = 0; i < rows[v].size(); ++i) {
        rows[v][i] = load<double, std::endian::little>(bytes.data() + v * columns.stride + columns.at[i]);
        if (!std::isfinite(rows[v][i]))
          throw FileError(path + ": the field or the frame at vertex " +
                              std::to_string(mesh.first_vertex + static_cast<std::int64_t>(v)) + " is not finite",
                          path);
      }
  });
  return rows;
}

}  // namespace

ComplexVectorX<double> curvature_together(const Stage& stage, const CurvatureOptions& options) {
  check_curvature_options(options);
  const Patch& patch = stage.patch;
  CurvatureMeans means{VectorX<double>::Zero(count_of(patch.vertex)),
                       ComplexVectorX<double>::Zero(count_of(patch.vertex)),
                       VectorX<double>::Zero(count_of(patch.vertex))};
  agreed([&] {
    if (!patch.empty()) means = curvature_at_vertices(patch.mesh, patch.V, patch.geometry, stage.connection);
  });
  const auto extend = [&] {
    patch.extend(means.area.data());
    patch.extend(means.q.data());
    patch.extend(means.mean.data());
  };
  extend();
  for (int ring = 0; ring < options.rings; ++ring) {
    if (!patch.empty()) average_over_ring(patch.mesh, stage.connection, means);
    extend();
  }
  return curvature_components(means, options).head(patch.owned);
}

ComplexVectorX<double> field_of_file(const std::string& path, const MeshSlice& mesh, const Stage& stage,
                                     const Frames& frames, int n) {
  const std::vector<FieldRow> rows = [&] {
    const MeshSlice other = read_mesh_slice(path);  // also finds a file that was cut
    double apart = 0, largest_of_all = 0;
    const bool alike = other.vertices == mesh.vertices && other.faces == mesh.faces;
    if (alike && mesh.V.rows() > 0) {
      apart = (mesh.V - other.V).cwiseAbs().maxCoeff();
      largest_of_all = mesh.V.cwiseAbs().maxCoeff();
    }
    std::vector<FieldRow> found = read_rows(path, other, n);
    if (!alike || !(largest(apart) <= same_place * largest(largest_of_all))) throw_other_mesh(path);
    return found;
  }();
  const Patch& patch = stage.patch;
  const auto owned = static_cast<Eigen::Index>(patch.owned);
  std::vector<FieldRow> mine(at(patch.owned));
  patch.home.fetch(rows.data(), mine.data());
  Frames of_file{Positions<double>(owned, 3), Positions<double>(owned, 3)};
  ComplexVectorX<double> u(owned);
  for (Eigen::Index v = 0; v < owned; ++v) {
    const FieldRow& row = mine[at(v)];
    u[v] = {row[0], row[1]};
    for (Eigen::Index c = 0; c < 3; ++c) {
      of_file.X(v, c) = row[at(2 + c)];
      of_file.N(v, c) = row[at(5 + c)];
    }
  }
  if (patch.empty()) return ComplexVectorX<double>::Zero(owned);
  const Field field{n, std::move(u), std::make_shared<const Frames>(std::move(of_file))};
  return on_frames(field, std::make_shared<const Frames>(Frames{frames.X.topRows(owned), frames.N.topRows(owned)})).u;
}

}  // namespace alcap::detail::distributed
