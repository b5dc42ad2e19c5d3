// SPDX-License-Identifier: MIT
//
// plan.h: what computing a field will take, before it is tried: memory, time and disk of every phase, from constants
// that were measured (docs/scale.md), and whether the library can number a mesh of that size at all.
//
//   const alcap::RunPlan plan = alcap::plan_field({.faces = 20'000'000, .n = 4, .speed = alcap::relative_speed()});
//   if (!plan.fits()) std::cout << "needs " << plan.most_bytes / 1e9 << " GB\n";
//
// Memory is right within a third on the meshes it was measured on, time within a factor of two; where a hard spectrum
// makes the eigensolver factorise, both are larger: factor_bytes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "alcap/conventions.h"

namespace alcap {

/// The mesh and the machine.
struct PlanOptions {
  std::int64_t faces = 0;                      ///< of the mesh
  std::int64_t vertices = 0;                   ///< 0: those of a closed surface, faces / 2 + 2
  int n = 4;                                   ///< degree of the field
  int threads = 0;                             ///< 0: all
  std::vector<std::string> formats = {"ply"};  ///< of the output: ply, vtp, rosy, rawfield
  double speed = 1;                            ///< of a core, see relative_speed()
  std::int64_t memory = 0;                     ///< bytes to be had; 0: those that are free now
};

/// One phase of a run.
struct PhasePlan {
  std::string name;    ///< read, mesh, connection, solve, analysis, write
  double seconds = 0;  ///< wall clock
  double bytes = 0;    ///< memory while it runs, of the whole process
  double disk = 0;     ///< bytes written
};

/// What is to be expected.
struct RunPlan {
  std::int64_t halfedges = 0;         ///< of the mesh; 64-bit, so true at any size
  std::int64_t edges = 0;             ///< of the mesh
  std::int64_t matrix_entries = 0;    ///< of S, both triangles
  std::vector<std::string> refusals;  ///< why the library refuses this size; empty when it does not
  std::vector<PhasePlan> phases;      ///< in order
  double seconds = 0;                 ///< sum of the phases
  double bytes = 0;                   ///< their peak
  double disk = 0;                    ///< their sum
  double most_bytes = 0;              ///< memory of the hardest case measured: round spheres, with large blocks
  double factor_bytes = 0;   ///< on top, when a factorisation is asked for or the eigensolver falls back to one
  double memory = 0;         ///< that there is, bytes; 0: not known
  std::int64_t largest = 0;  ///< faces of the largest mesh that fits here
  /// Whether a factorisation fits besides: without, leave method and solver at "auto", which factorises only in need.
  bool factor_fits = false;
  /// Whether the library takes this size and there is memory for it (or none is known).
  [[nodiscard]] bool fits() const { return refusals.empty() && (memory <= 0 || most_bytes <= memory); }
};

/// Plans run_field() and write_field(). Throws OptionError unless faces >= 1, vertices >= 0, n >= 1, threads >= 0,
/// speed > 0, memory >= 0 and every format has a model.
[[nodiscard]] RunPlan plan_field(const PlanOptions& options);

/// CPU time of a small field on one thread here, in terms of that on the machine the constants come from: above 1 this
/// core is quicker. Takes about 0.2 s.
[[nodiscard]] double relative_speed();

}  // namespace alcap
