// SPDX-License-Identifier: MIT
#include "src/distributed/stages.h"

#include <array>
#include <string>

#include "src/base/array.h"
#include "src/base/numbers.h"
#include "src/distributed/analysis.h"

namespace alcap::detail::distributed {
namespace {

void spread_counts(std::int64_t value, std::int64_t (&out)[3]) {
  double all[3];
  spread(static_cast<double>(value), all);
  for (int k = 0; k < 3; ++k) out[k] = rounded<std::int64_t>(all[k]).value_or(0);
}

/// Values at owned vertices to this rank's slice of the users' numbering.
void bring_home(const Patch& patch, const Frames& frames, const ComplexVectorX<double>& u, Eigen::Index rows,
                DistributedField& out) {
  std::vector<std::array<double, 8>> mine(at(patch.owned)), here(at(rows));
  for (Index v = 0; v < patch.owned; ++v) {
    auto& row = mine[at(v)];
    row = {};
    for (int c = 0; c < 3 && !patch.empty(); ++c) {
      row[at(c)] = frames.X(v, c);
      row[at(3 + c)] = frames.N(v, c);
    }
    row[6] = u[v].real();
    row[7] = u[v].imag();
  }
  patch.home.reduce(mine.data(), here.data(), MPI_REPLACE);
  out.u.resize(rows);
  out.frames = {Positions<double>(rows, 3), Positions<double>(rows, 3)};
  for (Eigen::Index v = 0; v < rows; ++v) {
    const auto& row = here[at(v)];
    for (int c = 0; c < 3; ++c) {
      out.frames.X(v, c) = row[at(c)];
      out.frames.N(v, c) = row[at(3 + c)];
    }
    out.u[v] = {row[6], row[7]};
  }
}

}  // namespace

void check_slice_size(const MeshSlice& mesh) {
  const auto size = [](std::int64_t count, int r) {
    return slice_begin(count, r + 1, ranks()) - slice_begin(count, r, ranks());
  };
  if (mesh.V.rows() != size(mesh.vertices, rank()) || mesh.F.rows() != size(mesh.faces, rank()))
    throw OptionError("mesh",
                      std::to_string(mesh.V.rows()) + " vertices and " + std::to_string(mesh.F.rows()) + " faces",
                      "a rank's slice has those from slice_begin(count, rank, ranks) on");
}

Stage divide(const MeshSlice& mesh, PartitionMethod method, Meter& meter, DistributedField& out) {
  Partitioned part = make_patch(mesh, method);
  Stage stage;
  stage.patch = std::move(part.patch);
  out.partition = part.method;
  out.cut_edges = part.cut_edges;
  spread_counts(stage.patch.owned, out.owned);
  spread_counts(count_of(stage.patch.vertex), out.held);
  meter.done("partition", out.phases);

  measure(stage.patch);
  stage.components = find_components(stage.patch);
  meter.done("geometry", out.phases);
  return stage;
}

void connect(Stage& stage, const DistributedOptions& options, Meter& meter, DistributedField& out) {
  stage.connection = connect(stage.patch, stage.components, options);
  out.kind = stage.connection.kind;
  out.center = stage.connection.center;
  out.global = stage.connection.options;
  out.connection = stage.connection.report;
  out.cones = stage.connection.cones;
  out.loop_index = stage.connection.loop_index;
  meter.done("connection", out.phases);
}

Frames frames_of(const Stage& stage) {
  Frames frames;
  const Patch& patch = stage.patch;
  agreed([&] {
    if (!patch.empty()) frames = vertex_frames(patch.mesh, patch.V, patch.geometry, stage.connection);
  });
  return frames;
}

Field extended(const Patch& patch, int n, const ComplexVectorX<double>& owned) {
  Field field{n, ComplexVectorX<double>::Zero(count_of(patch.vertex)), nullptr};
  field.u.head(patch.owned) = owned.head(patch.owned);
  patch.extend(field.u.data());
  return field;
}

void conclude(Stage& stage, const Frames& frames, const Field& field, Eigen::Index rows, DistributedField& out) {
  out.singularities = analyse(stage.patch, stage.connection, field, stage.components);
  bring_home(stage.patch, frames, field.u, rows, out);
  out.components = stage.components.list;
}

}  // namespace alcap::detail::distributed
