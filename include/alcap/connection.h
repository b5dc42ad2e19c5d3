// SPDX-License-Identifier: MIT
//
// connection.h: discrete connections (LTGD 2016, Secs. 4.2 and 5): geodesic polar map, locally optimal, globally
// optimal ("as Levi-Civita as possible"), trivial with prescribed cones, and nearest to any metric connection; one type
// for all of them.
//
//   auto connection = alcap::globally_optimal(surface);
//   double k = connection.K[t];                          // lifted curvature of face t; an n-field sees n K
//   double r = connection.rho_along(surface.mesh(), h);  // vertex-to-vertex rotation along halfedge h
//
// connected_surface.h chooses between them by options. The forms that take mesh and geometry do the same for those who
// own the parts.
//
// Closed meshes: the K of a Levi-Civita-type connection sum to 2 pi chi.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "alcap/geometry.h"
#include "alcap/mesh.h"
#include "alcap/topology.h"

namespace alcap {

class Surface;
class ConnectedSurface;

/// How a connection was built, see the functions below.
enum class ConnectionKind { polar, local, global, trivial, metric };

/// The point of a triangle that the polar map's corner directions aim at (LTGD 2016, eq. 12). The incenter's
/// direction bisects the corner, so tau -> 0 under refinement. With the barycenter tau tends to a shape-dependent
/// constant: the triangle-based Dirichlet energy keeps an error that refinement does not remove, and first-order
/// operators a small excess that falls only with first order. Edge-based operators do not see the choice. Offered to
/// reproduce published tables.
enum class PolarCenter { incenter, barycenter };

/// Weight of an edge in D_E besides its tangent.
enum class LengthFactor {
  mean_edge,  ///< |e| over the mean |e| of its component: scale-invariant.
  metric,     ///< |e| as printed in the paper: the result depends on the unit of length.
  per_edge,   ///< 1
};

template <>
struct NamesOf<ConnectionKind> {
  static constexpr auto table = detail::name_table<ConnectionKind>({{ConnectionKind::polar, "polar"},
                                                                    {ConnectionKind::local, "local"},
                                                                    {ConnectionKind::global, "global"},
                                                                    {ConnectionKind::trivial, "trivial"},
                                                                    {ConnectionKind::metric, "metric"}});
};
template <>
struct NamesOf<PolarCenter> {
  static constexpr auto table =
      detail::name_table<PolarCenter>({{PolarCenter::incenter, "incenter"}, {PolarCenter::barycenter, "barycenter"}});
};
template <>
struct NamesOf<LengthFactor> {
  static constexpr auto table = detail::name_table<LengthFactor>(
      {{LengthFactor::mean_edge, "mean_edge"}, {LengthFactor::metric, "metric"}, {LengthFactor::per_edge, "per_edge"}});
};

/// A kind of connection with its center, under one name: those of ConnectionKind, and "polar-barycenter".
struct ConnectionChoice {
  ConnectionKind kind = ConnectionKind::global;  ///< how it is built
  PolarCenter center = PolarCenter::incenter;    ///< of the polar map
};
/// The word that options and reports use for it.
[[nodiscard]] constexpr std::string_view name(const ConnectionChoice& choice) {
  const bool other = choice.kind == ConnectionKind::polar && choice.center == PolarCenter::barycenter;
  return other ? "polar-barycenter" : name(choice.kind);
}
/// The choice of this name, or nothing.
[[nodiscard]] constexpr std::optional<ConnectionChoice> connection_choice(std::string_view text) {
  if (text == "polar-barycenter") return ConnectionChoice{ConnectionKind::polar, PolarCenter::barycenter};
  if (const auto kind = from_name<ConnectionKind>(text)) return ConnectionChoice{*kind};
  return std::nullopt;
}

/// Which polar map is built.
struct PolarOptions {
  PolarCenter center = PolarCenter::incenter;  // see PolarCenter: only this one converges in every measure
};

/// How the globally optimal connection is weighed and solved.
struct GlobalOptions {
  /// lambda in D_T + lambda D_E, the curvature-spreading knob: smaller spreads each vertex's curvature over more
  /// faces (an n-field ignores small bumps), larger follows every detail. 1 weighs both as the paper does. In
  /// [1e-12, 1e12]: beyond, one of the two is lost to rounding.
  double detail = 1.0;
  LengthFactor length_factor = LengthFactor::mean_edge;  // the one choice that is neutral to scale and to edge density
  /// Cap of tan(angle opposite the edge), also used at right and obtuse angles. 10 is a corner of 84 degrees; larger
  /// caps change nothing visible and slow the solve several times.
  double tan_cap = 10.0;
  /// Relative residual of the conjugate gradients. 1e-6 leaves K right to six digits, which is more than fields show;
  /// 1e-10 leaves K right to ten; float stops at its own rounding.
  /// Relative to the start, or, where the start is close to the optimum already (regular solids), to what the rounding
  /// of the angles themselves amounts to.
  double tolerance = 1e-6;
  int max_iterations = 5000;  // 50 are usual, a few hundred on slivers; small detail needs more
};

/// How a connection was found and how far it is from the Levi-Civita one.
struct ConnectionReport {
  bool converged = true;  ///< whether the tolerance was reached
  int iterations = 0;     ///< conjugate gradient iterations, 0 when none were needed
  double residual = 0;    ///< relative residual at the end
  double D_T = 0;         ///< deviation inside faces, sum of tau' W tau (LTGD 2016, Sec. 5.3)
  double D_E = 0;         ///< deviation between edges and faces, with its length factor, without lambda
  std::string message;    ///< empty when all is well
};

/// A cone: the index that a field of the trivial connection has at a vertex, in turns (+1/4: three-sided corner of a
/// cross field's quad mesh).
struct Cone {
  Index vertex = none;  ///< an interior vertex
  double index = 0;  ///< in turns: a multiple of 1/n for trivial(), any number in [-1e6, 1e6] for metric_connection()
};

/// A discrete connection on a mesh. Angles in radians; signs and frames as in conventions.h.
struct Connection {
  ConnectionKind kind = ConnectionKind::polar;  ///< how it was built
  VectorX<double> rho;      ///< #E: vertex-to-vertex rotation rho_ij along the canonical halfedge i -> j (modulo 2 pi)
  VectorX<double> rho_e;    ///< 2 #E: [2e] = rho_{vi -> e_ij}, [2e+1] = rho_{vj -> e_ij}, same edge direction at both
                            ///< ends; lifted around boundary vertices, from their first edge to their last
  VectorX<double> rho_t;    ///< 3 #F: rho_{v -> t} per corner
  VectorX<double> tau;      ///< 3 #F: lifted rotation along halfedge h inside its face
  VectorX<double> eps;      ///< #E: lifted rotation along the canonical halfedge, within the edge
  VectorX<double> K;        ///< #F: lifted curvature, K = -(tau_ij + tau_jk + tau_ki)
  VectorX<double> alpha;    ///< 3 #F: adjustment angle of each halfedge (trivial and metric connections), or empty
  std::vector<Cone> cones;  ///< of a trivial or metric connection, as it was given them
  /// Holonomy of each of homology_generators(), in turns, and index of each boundary loop, of trivial() and
  /// metric_connection().
  std::vector<double> generator_holonomy, loop_index;  ///< in turns, of trivial() and metric_connection()
  bool flat = false;                           ///< no curvature but at the cones: of trivial() and metric_connection()
  bool to_target = false;                      ///< nearest to a target of the caller's, which is not kept
  PolarCenter center = PolarCenter::incenter;  ///< of a polar map
  GlobalOptions options;                       ///< the weights that it was optimised or measured with
  ConnectionReport report;                     ///< how it was found

  /// Of a flat connection: whether cones, holonomies and loop indices are multiples of 1/n, to 1e-6 of it. Only then
  /// can an n-field that is parallel everywhere but at the cones be single-valued. False for all others.
  [[nodiscard]] bool admits_parallel(int n) const;

  /// rho_ij along halfedge h = i -> j; antisymmetric.
  [[nodiscard]] double rho_along(const Mesh& mesh, Index h) const {
    const Index e = mesh.edge(h);
    return mesh.halfedge(e) == h ? rho[e] : -rho[e];
  }
  /// rho_{vi -> e_ij} for halfedge h = i -> j.
  [[nodiscard]] double rho_start(const Mesh& mesh, Index h) const {
    const Index e = mesh.edge(h);
    return mesh.halfedge(e) == h ? rho_e[2 * std::int64_t{e}] : rho_e[2 * std::int64_t{e} + 1] - pi<double>;
  }
  /// rho_{vj -> e_ij} for halfedge h = i -> j: the direction of h seen at its far end.
  [[nodiscard]] double rho_end(const Mesh& mesh, Index h) const {
    const Index e = mesh.edge(h);
    return mesh.halfedge(e) == h ? rho_e[2 * std::int64_t{e} + 1] : rho_e[2 * std::int64_t{e}] - pi<double>;
  }
  /// eps_ij along halfedge h, antisymmetric.
  [[nodiscard]] double eps_along(const Mesh& mesh, Index h) const {
    const Index e = mesh.edge(h);
    return mesh.halfedge(e) == h ? eps[e] : -eps[e];
  }
  /// rho_{e -> t} of halfedge h as the connection sees it: minus the halfedge's direction in its face, plus alpha.
  [[nodiscard]] double edge_to_face(const Geometry& geometry, Index h) const {
    return (alpha.size() ? alpha[h] : double(0)) - geometry.direction(h);
  }
};

/// Geodesic polar map (LTGD 2016, Sec. 5.1; Zhang, Mischaikow, Turk 2006; Knoeppel et al. 2013): corner angles scaled
/// to 2 pi around interior vertices, kept at boundary vertices.
[[nodiscard]] Connection polar(const Surface& surface, const PolarOptions& options = {});
[[nodiscard]] Connection polar(const Mesh& mesh, const Geometry& geometry, const PolarOptions& options = {});

/// Locally optimal (LTGD 2016, Sec. 5.2): the polar map's edges with tau = -K/3 on every halfedge.
[[nodiscard]] Connection locally_optimal(const Surface& surface);
[[nodiscard]] Connection locally_optimal(const Mesh& mesh, const Geometry& geometry);

/// Globally optimal (LTGD 2016, Sec. 5.3): minimises D_T + detail * D_E over all of rho, by conjugate gradients on the
/// local system left after every face has moved its own corners; O(V), no factorisation. Throws OptionError for bad
/// options.
[[nodiscard]] Connection globally_optimal(const Surface& surface, const GlobalOptions& options = {});
[[nodiscard]] Connection globally_optimal(const Mesh& mesh, const Geometry& geometry,
                                          const GlobalOptions& options = {});

/// What a trivial connection is prescribed besides its cones.
struct TrivialOptions {
  int n = 1;  // indices and holonomies are multiples of 1/n turn: the degree of the fields the connection is for
  /// Holonomy, in turns, of each of homology_generators(mesh, topology), modulo 1. Empty: of each the multiple of 1/n
  /// nearest to what the cones alone give, the least change.
  std::vector<double> generator_holonomy = {};
  /// Index of each boundary loop of topology.h, in turns. Empty: as for generators, with the sum that Poincare-Hopf
  /// demands.
  std::vector<double> loop_index = {};
  GlobalOptions global = {};    // how rho_{v->t} and rho_{v->e} are optimised afterwards
  std::string solver = "auto";  // backend of the Poisson solve
};

/// Trivial connection with prescribed cones (LTGD 2016, Sec. 5.4; Crane, Desbrun, Schroeder 2010): flat but for the
/// cone vertices. K is zero, to rounding, in every face that touches no cone. One Poisson solve, plus one right-hand
/// side per generator. The cones of a closed component must sum to its Euler characteristic; with boundary, cones and
/// loops must. Cones lie at interior vertices. Throws OptionError naming the vertex, the sum and what is missing.
[[nodiscard]] Connection trivial(const Surface& surface, const std::vector<Cone>& cones,
                                 const TrivialOptions& options = {});
[[nodiscard]] Connection trivial(const Mesh& mesh, const Geometry& geometry, const std::vector<Cone>& cones,
                                 const TrivialOptions& options = {});

/// What metric_connection() is prescribed besides its cones.
struct MetricOptions {
  /// Holonomy, in turns, of each of homology_generators(mesh, topology), modulo 1. Empty: what the cones alone give,
  /// the least change.
  std::vector<double> generator_holonomy = {};
  /// Index of each boundary loop of topology.h, in turns. Empty: what the cones alone give.
  std::vector<double> loop_index = {};
  GlobalOptions global = {};    // how rho_{v->t} and rho_{v->e} are optimised afterwards
  std::string solver = "auto";  // backend of the Poisson solve
};

/// The metric connection with cones of any size (LTGD 2016, Secs. 1.2 and 5.4): curvature 2 pi index at each cone, none
/// elsewhere, and holonomies of any size. As trivial() in everything else, and the same connection when all of them are
/// multiples of 1/n. An n-field for which they are not has no single-valued parallel field: admits_parallel() says so,
/// and smoothest fields and designs are found all the same. Throws OptionError as trivial() does.
[[nodiscard]] Connection metric_connection(const Surface& surface, const std::vector<Cone>& cones,
                                           const MetricOptions& options = {});
[[nodiscard]] Connection metric_connection(const Mesh& mesh, const Geometry& geometry, const std::vector<Cone>& cones,
                                           const MetricOptions& options = {});

/// A metric connection to come near to: at most one of the arrays. With none it is that of Levi-Civita.
struct ConnectionTarget {
  /// 3 #F, radians modulo 2 pi: rho^_{e->t} of each halfedge, from its direction to the frame of its face. Levi-Civita:
  /// minus Geometry::direction(h).
  VectorX<double> rotation = {};
  /// 3 #F, radians: the adjustment angle alpha of each halfedge, rho^_{e->t} = alpha - direction (LTGD 2016, Sec. 5.4).
  /// Its lift counts: the corner at the tail of h is seen as angle + alpha_h - alpha_prev(h).
  VectorX<double> adjustment = {};
  /// #V, radians: the curvature around each interior vertex, zero at others; 2 pi chi in sum on a closed component. The
  /// adjustment angles are those of least change (Crane et al. 2010), the holonomies what they give.
  VectorX<double> vertex_curvature = {};
  /// #F, radians: K of each face, 2 pi chi in sum on a closed component. Holonomies are the polar map's plus what the
  /// least change of rho_ij gives.
  VectorX<double> face_curvature = {};

  /// Whether no array is given.
  [[nodiscard]] bool levi_civita() const {
    return rotation.size() + adjustment.size() + vertex_curvature.size() + face_curvature.size() == 0;
  }
};

/// How nearest_connection() takes its target.
struct NearestOptions {
  /// Minimises over all of rho, so that a vertex's curvature spreads as far as is best. false: the rotations along
  /// edges are held where the target has them: curvature stays in the faces around its vertex, as in trivial(). Face
  /// curvature is always held.
  bool spread = true;
  GlobalOptions global = {};    // weights and tolerance
  std::string solver = "auto";  // backend of the Poisson solve that curvature takes
};

/// The discrete connection nearest to a metric connection: the minimum of D_T + detail * D_E with the target's
/// rho^_{e->t} in D_E (LTGD 2016, Sec. 5.4). Without a target it is globally_optimal(); with the curvature of cones and
/// without `spread` it is metric_connection(). O(V), with one Poisson solve for curvature. Throws OptionError for
/// arrays of other sizes, more than one of them, values that are not finite, curvature at a boundary vertex, and sums
/// of curvature that no metric connection has.
[[nodiscard]] Connection nearest_connection(const Surface& surface, const ConnectionTarget& target,
                                            const NearestOptions& options = {});
[[nodiscard]] Connection nearest_connection(const Mesh& mesh, const Geometry& geometry, const ConnectionTarget& target,
                                            const NearestOptions& options = {});

/// Holonomy of a closed strip of faces, in radians: how far a vector has turned after one round.
[[nodiscard]] double holonomy(const ConnectedSurface& surface, const Loop& strip);
[[nodiscard]] double holonomy(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                              const Loop& strip);

/// D_T and D_E of any connection under the given options (detail is not applied).
void measure_deviation(const Mesh& mesh, const Geometry& geometry, const GlobalOptions& options,
                       Connection& connection);

}  // namespace alcap
