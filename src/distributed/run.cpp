// SPDX-License-Identifier: MIT
//
// run.cpp: a field from a mesh in slices, phase by phase.
#include <cstdlib>
#include <memory>

#include "alcap/frames.h"
#include "src/base/array.h"
#include "src/base/numbers.h"
#include "src/distributed/analysis.h"
#include "src/distributed/connect.h"
#include "src/distributed/eigen.h"
#include "src/distributed/meter.h"
#include "src/distributed/parallel_file.h"
#include "src/io/field/ply_rows.h"

namespace alcap {
namespace detail::distributed {
namespace {

void check_options(const MeshSlice& mesh, const DistributedOptions& o) {
  if (o.n < 1) throw OptionError("n", o.n, "the degree of a field is at least 1");
  if (!(o.s >= -1 && o.s <= 1)) throw OptionError("s", o.s, "the energy family needs s in [-1, 1]");
  if (!(o.tolerance > 0) || o.tolerance >= 1) throw OptionError("tolerance", o.tolerance, "must lie in (0, 1)");
  if (o.max_iterations < 1) throw OptionError("max_iterations", o.max_iterations, "must be at least 1");
  if (o.gather_below < 100) throw OptionError("gather_below", o.gather_below, "must be at least 100");
  const auto size = [](std::int64_t count, int r) {
    return slice_begin(count, r + 1, ranks()) - slice_begin(count, r, ranks());
  };
  if (mesh.V.rows() != size(mesh.vertices, rank()) || mesh.F.rows() != size(mesh.faces, rank()))
    throw OptionError("mesh",
                      std::to_string(mesh.V.rows()) + " vertices and " + std::to_string(mesh.F.rows()) + " faces",
                      "a rank's slice has those from slice_begin(count, rank, ranks) on");
}

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

void compute(const MeshSlice& mesh, const DistributedOptions& options, DistributedField& out) {
  Meter meter;
  Partitioned part = make_patch(mesh, options.partition);
  Patch& patch = part.patch;
  out.partition = part.method;
  out.cut_edges = part.cut_edges;
  spread_counts(patch.owned, out.owned);
  spread_counts(count_of(patch.vertex), out.held);
  meter.done("partition", out.phases);

  measure(patch);
  Components components = find_components(patch);
  meter.done("geometry", out.phases);

  const Connection connection = connect(patch, components, options);
  out.kind = connection.kind;
  out.center = connection.center;
  out.global = connection.options;
  out.connection = connection.report;
  meter.done("connection", out.phases);

  Matrices matrices = assemble(patch, connection, options.n, options.s);
  meter.done("assembly", out.phases);

  const ComplexVectorX<double> u = solve_components(patch, matrices, components, options);
  matrices = {};
  meter.done("solve", out.phases);

  Field field{options.n, ComplexVectorX<double>::Zero(count_of(patch.vertex)), nullptr};
  field.u.head(patch.owned) = u;
  patch.extend(field.u.data());
  out.singularities = analyse(patch, connection, field, components);
  Frames frames;
  agreed([&] {
    if (!patch.empty()) frames = vertex_frames(patch.mesh, patch.V, patch.geometry, connection);
  });
  bring_home(patch, frames, u, mesh.V.rows(), out);
  out.components = std::move(components.list);
  meter.done("analysis", out.phases);
}

/// This rank's rows of both tables.
std::vector<char> vertex_rows(const MeshSlice& mesh, const DistributedField& out) {
  std::vector<char> bytes(at(mesh.V.rows()) * ply_vertex_bytes);
  const Field field{out.n, out.u, std::make_shared<const Frames>(out.frames)};
  const Branches branches(out.n);
  char* to = bytes.data();
  for (Index v = 0; v < mesh.V.rows(); ++v) to = put_ply_vertex(mesh.V, field, out.frames, branches, v, to);
  return bytes;
}
std::vector<char> face_rows(const MeshSlice& mesh) {
  std::vector<char> bytes(at(mesh.F.rows()) * ply_face_bytes);
  char* to = bytes.data();
  for (Index t = 0; t < mesh.F.rows(); ++t) to = put_ply_face(mesh.F, t, to);
  return bytes;
}

}  // namespace
}  // namespace detail::distributed

int distributed_rank() {
  const detail::petsc::Session session;
  return detail::distributed::rank();
}
int distributed_ranks() {
  const detail::petsc::Session session;
  return detail::distributed::ranks();
}

void on_first_rank(const std::function<void()>& body) {
  const detail::petsc::Session session;
  detail::distributed::agreed([&] {
    if (detail::distributed::rank() == 0) body();
  });
}

void distributed_abort(int exit_code) {
  MPI_Abort(MPI_COMM_WORLD, exit_code);
  std::abort();
}

DistributedField distributed_field(const MeshSlice& mesh, const DistributedOptions& options) {
  using namespace detail::distributed;
  const detail::petsc::Session session;
  agreed([&] { check_options(mesh, options); });
  DistributedField out;
  out.n = options.n;
  out.phases = mesh.phases;
  compute(mesh, options, out);
  return out;
}

void write_distributed_ply(const std::string& path, const MeshSlice& mesh, DistributedField& field) {
  using namespace detail;
  using namespace detail::distributed;
  const petsc::Session session;
  Meter meter;
  Connection connection;
  connection.kind = field.kind;
  connection.center = field.center;
  connection.options = field.global;
  const std::string header = ply_field_header(field.n, connection, mesh.vertices, mesh.faces);
  const auto body = count_of(header);
  ParallelOutput file(path);
  file.write(0, rank() == 0 ? std::vector<char>(header.begin(), header.end()) : std::vector<char>());
  std::vector<char> rows;
  agreed([&] { rows = vertex_rows(mesh, field); });
  file.write(body + mesh.first_vertex * static_cast<std::int64_t>(ply_vertex_bytes), rows);
  agreed([&] { rows = face_rows(mesh); });
  file.write(body + mesh.vertices * static_cast<std::int64_t>(ply_vertex_bytes) +
                 mesh.first_face * static_cast<std::int64_t>(ply_face_bytes),
             rows);
  file.finish();
  meter.done("write", field.phases);
}

}  // namespace alcap
