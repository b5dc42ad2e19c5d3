// SPDX-License-Identifier: MIT
//
// run.cpp: a field from a mesh in slices, phase by phase.
#include <cstdlib>
#include <memory>

#include "src/base/array.h"
#include "src/distributed/eigen.h"
#include "src/distributed/parallel_file.h"
#include "src/distributed/stages.h"
#include "src/io/field/ply_rows.h"
#include "src/run/remarks.h"

namespace alcap {
namespace detail::distributed {
namespace {

void check_options(const MeshSlice& mesh, const DistributedOptions& o) {
  if (o.n < 1) throw OptionError("n", o.n, "the degree of a field is at least 1");
  if (!(o.s >= -1 && o.s <= 1)) throw OptionError("s", o.s, "the energy family needs s in [-1, 1]");
  if (!(o.tolerance > 0) || o.tolerance >= 1) throw OptionError("tolerance", o.tolerance, "must lie in (0, 1)");
  if (o.max_iterations < 1) throw OptionError("max_iterations", o.max_iterations, "must be at least 1");
  if (o.gather_below < 100) throw OptionError("gather_below", o.gather_below, "must be at least 100");
  check_slice_size(mesh);
}

void add_remarks(const Connection& connection, const DistributedOptions& options, bool finite, DistributedField& out) {
  std::vector<EigenReport> eigen;
  std::vector<IndexSum> sums;
  for (const DistributedComponent& c : out.components) {
    eigen.push_back(c.eigen);
    sums.push_back(c.indices);
  }
  const auto reached = [&](const EigenReport& e) {
    return e.residual <= options.tolerance && e.energy_residual <= options.tolerance;
  };
  outcome_remarks({.connection = connection.report,
                   .parallel = !connection.flat || connection.admits_parallel(options.n),
                   .n = options.n,
                   .eigen = eigen,
                   .reached = reached,
                   .index_sums = sums,
                   .finite = finite},
                  out.remarks);
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

DistributedField field_of_slices(const MeshSlice& mesh, const DistributedOptions& options) {
  DistributedField out;
  out.n = options.n;
  out.phases = mesh.phases;
  Meter meter;
  Stage stage = divide(mesh, options.partition, meter, out);
  connect(stage, options, meter, out);

  Matrices matrices = assemble(stage.patch, stage.connection, options.n, options.s);
  meter.done("assembly", out.phases);

  const ComplexVectorX<double> u = solve_components(stage.patch, matrices, stage.components, options);
  matrices = {};
  meter.done("solve", out.phases);

  const Field field = extended(stage.patch, options.n, u);
  conclude(stage, frames_of(stage), field, mesh.V.rows(), out);
  add_remarks(stage.connection, options, !any(!u.allFinite()), out);
  meter.done("analysis", out.phases);
  return out;
}

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

void on_every_rank(const std::function<void()>& body) {
  const detail::petsc::Session session;
  detail::distributed::agreed(body);
}

void distributed_abort(int exit_code) {
  MPI_Abort(MPI_COMM_WORLD, exit_code);
  std::abort();
}

DistributedField distributed_field(const MeshSlice& mesh, const DistributedOptions& options) {
  using namespace detail::distributed;
  const detail::petsc::Session session;
  agreed([&] { check_options(mesh, options); });
  return field_of_slices(mesh, options);
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
  connection.cones = field.cones;
  connection.loop_index = field.loop_index;
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
