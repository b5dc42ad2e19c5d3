// SPDX-License-Identifier: MIT
//
// distributed.h: smoothest n-vector fields of meshes that no single machine could hold: every rank of an MPI program
// reads a slice of the file, owns a part of the vertices, and does its part of each step. Optional: the library
// alcap::distributed, built where PETSc, SLEPc and MPI are found; not included by alcap.h. The program alcap-mpi is
// this header on the command line.
//
//   alcap::MeshSlice mesh = alcap::read_mesh_slice("huge.ply");               // on every rank, as all that follows
//   alcap::DistributedField field = alcap::distributed_field(mesh, {.n = 4});
//   alcap::write_distributed_ply("huge-field.ply", mesh, field);              // one file, by all ranks together
//
// All functions are collective: every rank of MPI_COMM_WORLD calls them, with the same options, and each is given the
// same results but for what is said to be of a slice. What one rank throws, all ranks throw. PETSc, and MPI unless the
// program did, are initialised by the first call, without signal handlers and configuration files, and finalised when
// the program ends. One thread per rank may call; it should limit what the library uses itself, which is every core.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "alcap/connection.h"
#include "alcap/field.h"
#include "alcap/field_run.h"
#include "alcap/singularities.h"
#include "alcap/solve.h"

namespace alcap {

/// This process's number, from 0.
[[nodiscard]] int distributed_rank();
/// How many processes there are.
[[nodiscard]] int distributed_ranks();

/// Calls body on rank 0 while the others wait; what it throws, all throw.
void on_first_rank(const std::function<void()>& body);

/// Calls body on every rank, each for itself, such as to read a small file; what one throws, all throw.
void on_every_rank(const std::function<void()>& body);

/// Ends all ranks at once with an exit code, for failures that only this rank knows of.
[[noreturn]] void distributed_abort(int exit_code);

/// What a phase took, over the ranks.
struct PhaseCost {
  std::string
      name;  ///< "read", "partition", "geometry", "connection", "assembly", "guidance", "solve", "analysis", "write"
  double seconds[3]{};     ///< least, mean and most wall clock of a rank
  double bytes_sent[3]{};  ///< by a rank to others: least, mean, most; without collective sums and MPI-IO
  double messages[3]{};    ///< sent by a rank: least, mean, most
  double memory[3]{};      ///< resident bytes of a rank at the end of the phase: least, mean, most
};

/// One rank's slice of a mesh, in the users' numbering: rank r of P has the vertices and the faces from
/// slice_begin(count, r, P) to slice_begin(count, r + 1, P).
struct MeshSlice {
  std::int64_t vertices = 0;      ///< of the whole mesh
  std::int64_t faces = 0;         ///< of the whole mesh
  std::int64_t first_vertex = 0;  ///< the number of the slice's first vertex
  std::int64_t first_face = 0;    ///< the number of the slice's first face
  Positions<double> V;            ///< points of the slice's vertices
  Faces F;                        ///< the slice's triangles, with vertex numbers of the whole mesh
  std::vector<PhaseCost> phases;  ///< what reading took
};

/// Where slice `rank` of `ranks` begins.
[[nodiscard]] constexpr std::int64_t slice_begin(std::int64_t count, int rank, int ranks) {
  return count / ranks * rank + count % ranks * rank / ranks;
}

/// Reads this rank's slice of the triangles of a binary PLY, or of an OFF with one vertex or triangle a line, by
/// MPI-IO: no rank reads more. What is not of use in a PLY is stepped over where its rows have a fixed length. Throws
/// FileError for other files, and what is broken.
[[nodiscard]] MeshSlice read_mesh_slice(const std::string& path);

/// This rank's slice of a mesh that every rank has.
[[nodiscard]] MeshSlice slice_of(const Positions<double>& V, const Faces& F);

/// Who owns which vertices.
enum class PartitionMethod {
  scotch,  ///< PT-Scotch on the graph of the edges: equal parts with short borders
  slices,  ///< as the users' numbers come: for files that are sorted in space already
};
template <>
struct NamesOf<PartitionMethod> {
  static constexpr auto table =
      detail::name_table<PartitionMethod>({{PartitionMethod::scotch, "scotch"}, {PartitionMethod::slices, "slices"}});
};

/// Which field, and how.
struct DistributedOptions {
  int n = 1;     // degree
  double s = 0;  // of the energy E_s, see energies.h
  /// Any kind. Trivial and metric connections, which have cones, only on components without handles; trivial ones are
  /// for degree n.
  ConnectionChoice connection = {};
  /// Weights and tolerance of the global connection: tighter than on one machine, so that any number of ranks gives the
  /// same eigenvalues to 1e-8.
  GlobalOptions global = {.tolerance = 1e-10};
  std::vector<Cone> cones = {};                         // of trivial and metric: users' vertices, see TrivialOptions
  std::vector<double> loop_index = {};                  // of trivial and metric, see TrivialOptions and MetricOptions
  double tolerance = 1e-8;                              // as EigenOptions::tolerance, recomputed
  int max_iterations = 1000;                            // of the eigensolver, per component
  std::uint64_t seed = 1;                               // of its start vectors
  PartitionMethod partition = PartitionMethod::scotch;  // who owns which vertices
  /// Components of up to so many vertices are solved each by one rank, as on one machine and with the same proof.
  Index gather_below = 1000;
  /// As EigenOptions::prove_smallest. The proof of a component is made by one rank, which gets its matrices: of up to
  /// 200,000 vertices, or with `always` wherever that rank's memory allows.
  Prove prove_smallest = Prove::automatic;
};

/// One connected component.
struct DistributedComponent {
  std::int64_t vertices = 0;        ///< that faces use
  std::int64_t edges = 0;           ///< how many
  std::int64_t faces = 0;           ///< how many
  std::int64_t first_face = 0;      ///< the smallest
  std::int64_t boundary_loops = 0;  ///< how many
  std::int64_t euler = 0;           ///< vertices - edges + faces
  double area = 0;                  ///< sum of its faces'
  EigenReport eigen;                ///< how its field was found; seconds are those of all components
  IndexSum indices;                 ///< Poincare-Hopf
};

/// A singularity, and what takes the mesh to know.
struct DistributedSingularity : Singularity {
  std::array<double, 3> position{};  ///< in space
  Index component = none;            ///< the component of its face
};

/// A field over all ranks, and how it was found.
struct DistributedField {
  int n = 1;                 ///< degree
  ComplexVectorX<double> u;  ///< values at the vertices of this rank's slice; |u|_M = 1 on each component
  Frames frames;             ///< of the vertices of this rank's slice
  std::vector<DistributedSingularity> singularities;  ///< of the whole mesh, ascending by face
  std::vector<DistributedComponent> components;       ///< in the order of their smallest faces
  ConnectionKind kind = ConnectionKind::global;       ///< how the connection was built
  PolarCenter center = PolarCenter::incenter;         ///< of a polar map
  GlobalOptions global;                               ///< weights that it was optimised or measured with
  ConnectionReport connection;                        ///< how it was found
  std::vector<Cone> cones;                            ///< of a trivial or metric connection, as it was given them
  std::vector<double> loop_index;                     ///< as Connection::loop_index
  std::string partition;                              ///< the method, and why another than asked for
  std::int64_t owned[3]{};                            ///< vertices that a rank owns: least, mean, most
  std::int64_t held[3]{};                             ///< vertices that a rank holds: least, mean, most
  std::int64_t cut_edges = 0;                         ///< edges between vertices of different ranks
  std::vector<PhaseCost> phases;                      ///< in the order they ran
  std::vector<Remark> remarks;                        ///< about the result, as of FieldRun
};

/// The smoothest n-field. Throws MeshError for a mesh that cannot be used, numbers as users count, OptionError,
/// SolveError.
[[nodiscard]] DistributedField distributed_field(const MeshSlice& mesh, const DistributedOptions& options = {});

/// One binary PLY in the users' numbering, byte for byte laid out as write_field() does it. The file appears complete
/// or not at all. Adds its phase. Throws FileError.
void write_distributed_ply(const std::string& path, const MeshSlice& mesh, DistributedField& field);

}  // namespace alcap
