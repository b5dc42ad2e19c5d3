// SPDX-License-Identifier: MIT
//
// tables.h: `alcap tables`, the two accuracy tables of LTGD 2016 measured anew: errors of divergence, curl and
// Dirichlet energy of smooth random fields on spheres, and the Euler characteristic from E_A - E_H, beside the
// published numbers.
//
//   const TablesResult result = compute_tables({.levels = {2, 3, 4}});
//   print_tables(std::cout, result);
#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "alcap/generators.h"
#include "apps/alcap/commands/command.h"

namespace alcap::app {

struct TablesOptions {
  std::vector<int> levels = {2, 3, 4, 5};  // icospheres of 162, 642, 2562 and 10242 vertices, the paper's four
  int fields = 100;                        // random fields per row, as in the paper
  /// Scalar harmonics Y of which grad Y and n x grad Y are combined in Table I: l = 1 ... 5 and five of l = 6.
  int harmonics = 40;
  /// The same for Table II: l = 1 ... 3, the 30 lowest vector spherical harmonics.
  int unit_harmonics = 15;
  /// Radius of the disk in which vertices of the second set of spheres move, in mean edge lengths: visibly irregular,
  /// nothing folds.
  double jitter = 0.2;
  std::uint64_t seed = 1;      // of the fields and of the jitter
  MeshData mesh = {};          // closed; empty: none. Rows of Table II for it
  std::string mesh_name = {};  // of these rows
  bool more = false;           // noise, random points, an ellipsoid, a generic body, and baselines
  /// Called before each sphere with its name ("clean 2562").
  std::function<void(std::string_view)> progress = {};
};

/// A number of the paper, or a missing one (NaN).
using Published = double;

/// Mean over the fields. All fields have unit L2 norm.
struct OperatorRow {
  std::string sphere;  ///< "clean", "jittered"; with `more` "noise 0.01", ..., "random points", "ellipsoid", "body"
  int level = 0;
  std::int64_t vertices = 0;
  double mean_edge = 0;                ///< mean edge length
  std::string connection;              ///< "polar", "polar-barycenter", "local" or "global"
  std::string kind;                    ///< "edge" or "triangle"
  double l2_div = 0, l2_curl = 0;      ///< sqrt(sum over faces of (integral - exact integral)^2)
  double linf_div = 0, linf_curl = 0;  ///< max over faces of |integral - exact integral| / area
  /// The same with the root mean square over the fields taken first, face by face. Of the size of the paper's numbers.
  double face_div = 0, face_curl = 0;
  double energy = 0;  ///< |E_D - exact|, E_D from the squared operators
  /// Of this column on this level of the paper's Table I (edge-based, one polar map whose center is not given); NaN
  /// where there is none.
  Published paper_l2_div = 0, paper_l2_curl = 0, paper_linf_div = 0, paper_linf_curl = 0, paper_energy = 0;
  /// Observed orders from the next coarser row of the same kind: log(error ratio) / log(edge length ratio); NaN on the
  /// coarsest.
  double order_l2_div = 0, order_l2_curl = 0, order_linf_div = 0, order_linf_curl = 0, order_energy = 0;
};

/// The exact energy of the closed-form basis (matrix S), whose sums Knoeppel et al. 2013 introduced.
struct StiffnessRow {
  std::string sphere;
  int level = 0;
  std::int64_t vertices = 0;
  double mean_edge = 0;
  std::string connection;
  double energy = 0;           ///< |1/2 u* S u - exact|, mean over the fields
  Published paper_energy = 0;  ///< Table I, Knoeppel et al. with polar or with optimal rho
  double order_energy = 0;
};

/// (E_A - E_H) / pi of fields of unit length at every vertex; 2 chi where all is well.
struct EulerRow {
  std::string surface;  ///< "clean", "jittered", "torus" or the name of the caller's mesh
  int level = 0;
  std::int64_t vertices = 0;
  std::string connection;
  std::string kind;  ///< "edge", "triangle" or "basis" (the curvature matrix: the exact integral of K |u|^2)
  double mean = 0, deviation = 0;  ///< over the fields; deviation is the sample's
  double expected = 0;             ///< 2 chi
  Published paper_mean = 0, paper_deviation = 0;
};

/// Other ways to the same numbers. Relative errors of E_A, means over the fields: by 1-forms on edges (Fisher et al.
/// 2007), by our operators, and by the closed-form basis. And the mean angle between the cross field of a trivial
/// connection per face (Crane et al. 2010) and ours with the same cones, at the faces that touch no cone. Knoeppel et
/// al. 2013 is StiffnessRow with the polar connection.
struct BaselineRow {
  std::string sphere;
  int level = 0;
  std::int64_t vertices = 0;
  double fisher = 0, edge = 0, triangle = 0, basis = 0;
  double crane_degrees = 0;
};

struct TablesResult {
  TablesOptions options;  ///< without the callback
  std::vector<OperatorRow> operators;
  std::vector<StiffnessRow> stiffness;
  std::vector<EulerRow> euler;
  std::vector<BaselineRow> baselines;
  double seconds = 0;
};

/// Measures everything. Deterministic for given options, whatever the number of threads. Throws OptionError.
[[nodiscard]] TablesResult compute_tables(const TablesOptions& options = {});

/// options, operators, stiffness, euler, baselines: keys of a report.
[[nodiscard]] Json tables_json(const TablesResult& result);

/// Aligned plain text.
void print_tables(std::ostream& out, const TablesResult& result);

}  // namespace alcap::app
