// SPDX-License-Identifier: MIT
//
// distributed_design.h: variational designs (designer.h) of meshes that no single machine could hold. What run_design()
// is on one machine, distributed_design() is over the ranks of an MPI program; see distributed.h, whose rules hold.
//
//   alcap::MeshSlice mesh = alcap::read_mesh_slice("huge.ply");
//   alcap::DistributedDesign design = alcap::distributed_design(mesh, alcap::read_design("saddle.json"));
//   alcap::write_distributed_ply("designed.ply", mesh, design);
//
// Controls come from the same code as on one machine, on the rank whose vertices and faces they name, and the field is
// the same up to rounding. There are:
//
//   singularities, pinned or not; fixed vertices; strokes along edges, through points and along paths; the boundary;
//   every guidance, with a weight, weights per vertex, or t; every kind of connection, with cones at vertices of
//   components without handles.
//
// Everything else is refused by name: eigen designs, features, edits, footprints of strokes, balanced cones, holonomies
// and targets before anything is computed, handles and paths of edges that are to be searched for when they are met.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "alcap/design_run.h"
#include "alcap/distributed.h"

namespace alcap {

/// How distributed_design() solves.
struct DistributedDesignOptions {
  /// Relative residual at which a linear solve ends, recomputed: fields agree with those of one machine to about eight
  /// digits. One that rounding stops earlier ends there.
  double tolerance = 1e-12;
  double residual = 1e-8;             // what the certificate accepts, as DesignRunOptions::residual
  ControlTolerances tolerances = {};  // what counts as met
  double eigen_tolerance = 1e-8;      // of smoothest fields: of guidance, and of components without a control
  int max_iterations = 1000;          // of each linear solve, and of the eigensolver per component
  /// Of the global connection: tighter than on one machine, as in DistributedOptions::global.
  double connection_tolerance = 1e-10;
  int connection_iterations = 5000;                     // as GlobalOptions::max_iterations
  std::uint64_t seed = 1;                               // of the eigensolver's start vectors
  PartitionMethod partition = PartitionMethod::scotch;  // who owns which vertices
  Index gather_below = 1000;                            // of smoothest fields, see DistributedOptions
};

/// A designed field over all ranks. Components have an `eigen` with a solver where a smallest eigenpair was found:
/// for guidance, or for want of a control.
struct DistributedDesign : DistributedField {
  DesignFile design;  ///< placed: with numbers of faces and vertices, the users', for points of space
  /// In the order of the design; controls in users' numbers. Strokes and the boundary have no `control`.
  std::vector<DesignOutcome> outcomes;
  int rows = 0;                   ///< exact ones: of pins and fixed vertices
  int solves = 0;                 ///< linear systems solved
  int iterations = 0;             ///< conjugate gradients, of all systems
  double residual = 0;            ///< relative, of the system with its rows, recomputed
  std::string solver;             ///< the linear solver and its choices; empty where none was needed
  DesignCertificate certificate;  ///< what was checked

  /// Whether every control is met: all outcomes.
  [[nodiscard]] bool met() const;
};

/// The field of a variational design. One that asks for nothing gets the smoothest field of its connection, of root
/// mean square length 1. Throws as run_design() does, and OptionError whose field is the JSON path of what needs one
/// machine.
[[nodiscard]] DistributedDesign distributed_design(const MeshSlice& mesh, const DesignFile& design,
                                                   const DistributedDesignOptions& options = {});

}  // namespace alcap
