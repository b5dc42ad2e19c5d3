// SPDX-License-Identifier: MIT
//
// field_run.h: the whole way in one call, from points and triangles to the smoothest n-field, its singularities and the
// numbers that certify it. Each step is also a header of its own; this one only puts them in order, times them and
// collects what deserves a remark.
//
//   alcap::MeshFile file = alcap::read_mesh("bunny.obj");
//   alcap::FieldRun run = alcap::run_field(std::move(file.V), std::move(file.F), {.n = 4});
//   if (run.certificate.holds()) use(run.field.vectors(0), run.singularities, run.surface);
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "alcap/aligned.h"
#include "alcap/connected_surface.h"
#include "alcap/control.h"
#include "alcap/field.h"
#include "alcap/intrinsic.h"
#include "alcap/mesh_repair.h"
#include "alcap/singularities.h"
#include "alcap/smoothest.h"

namespace alcap {

/// Which features a field is aligned with, and how.
struct FieldAlignment {
  SharpEdgeOptions features = {};  ///< which edges are features; boundary edges are, unless it says otherwise
  /// Feature edges by their vertices, as read_feature_edges() gives them; not empty: these, and not those that fold,
  /// with gaps closed and spurs removed as `features` says.
  std::vector<std::array<Index, 2>> edges = {};
  bool across = false;  ///< across the features instead of along; the same where n is a multiple of 4
  double weight = 0;    // 0: held exactly; above, drawn as by a stroke of this weight
  int max_steps = AlignedOptions{}.max_steps;  // of renormalising and diffusing; 0: the harmonic field alone
};

/// Which triangles of the surface a field is solved on.
enum class Triangulation {
  extrinsic,  ///< those of the mesh
  /// The intrinsic Delaunay triangulation of intrinsic.h, refined to FieldRunOptions::min_angle. Cones stay at their
  /// vertices. Not with prescribed holonomies of generators, and not with connection targets per halfedge or face:
  /// those are of one triangulation.
  intrinsic,
  /// intrinsic where it pays and is possible: at least one face in a hundred has a corner below 1 degree. Elsewhere the
  /// mesh's own.
  automatic,
};
template <>
struct NamesOf<Triangulation> {
  static constexpr auto table = detail::name_table<Triangulation>({{Triangulation::extrinsic, "extrinsic"},
                                                                   {Triangulation::intrinsic, "intrinsic"},
                                                                   {Triangulation::automatic, "auto"}});
};

/// What run_field() computes, and how.
struct FieldRunOptions {
  int n = 4;                          // cross fields are what most pipelines ask for; 1 vectors, 2 lines, 6 hexagons
  double s = 0.0;                     // energy family in [-1, 1], see SmoothestOptions::s; 0 is the Dirichlet energy
  ConnectionOptions connection = {};  // globally optimal; its n is that of the run
  EigenOptions eigen = {};            // tolerance, solver and proof
  int modes = 1;                      // more: FieldRun::modes holds so many of the smoothest fields
  std::vector<Repair> repairs = {};   // none by default: a mesh is not changed unasked; see mesh_repair.h
  double weld_tolerance = 0;          // of Repair::weld, see RepairOptions
  /// A field of even n along features instead of the smoothest one: aligned_field(). Its Dirichlet energy is that of s
  /// = 0.
  std::optional<FieldAlignment> align = std::nullopt;
  Triangulation triangulation = Triangulation::automatic;  // needles cost time and digits, good triangles nothing
  /// Of the intrinsic triangulation, radians, see IntrinsicOptions. Corners that the surface itself has may be smaller,
  /// and where a budget ends it SolvedTriangulation::complete is false. Above 0 no circumcircle is larger than 1.5
  /// times that of a triangle of the mean area either: with large ones eigenvalues of needles are percents off. On a
  /// shaft of 82,000 needles 15 degrees take a fifth fewer triangles than 20 and change the eigenvalue by 1e-5 of it.
  /// 0: flips alone.
  double min_angle = 15 * pi<double> / 180;
  bool normalise = false;  // true: divide by |u| afterwards, an n-direction field
  int threads = 0;         // 0: as many as the machine has; results do not depend on it
  /// Called on the calling thread when a phase starts: "mesh", "connection", "solve", "analysis". An exception thrown
  /// here ends the run and reaches the caller.
  std::function<void(std::string_view phase)> progress = {};
  /// Stopping, watching and threads of the whole run; its phases are those of `progress`. Its threads count where
  /// `threads` is 0. EigenOptions::cancel is honoured in the whole run as well.
  RunControl control = {};
};

/// Something the user should know about a run that worked. `code` is stable, the message is one sentence.
struct Remark {
  std::string code = {};          ///< stable, for programs
  bool warning = true;            ///< false: worth a note, nothing to worry about
  std::string message = {};       ///< one sentence, for people
  std::int64_t count = 0;         ///< elements concerned, 0 when it is not about elements
  std::vector<Index> first = {};  ///< the first of them, at most 8
};

/// What must hold for the result to be what it claims to be.
struct Certificate {
  bool connection_converged = false;  ///< the connection reached its tolerance
  bool eigen_converged = false;       ///< on every component
  bool residual_small = false;        ///< within_tolerance() of solve.h, on every component
  bool index_sums_match = false;      ///< Poincare-Hopf, on every component
  bool finite = false;                ///< no value of the field is NaN or infinite
  bool directions_settled = true;     ///< aligned fields: on every component
  /// What is known about the eigenvalues being the smallest: the least on any component. Only `proven` says that no
  /// smoother field exists.
  Smallest smallest = Smallest::not_checked;
  /// Degrees: the largest EigenReport::angle of the components; nothing where one has none.
  std::optional<double> angle = std::nullopt;
  AngleCheck angle_check = AngleCheck::unknown;  ///< what it rests on: the least of any component
  /// All of the above, and `smallest` is not refuted. Where it is not checked either, the field is an eigenvector, and
  /// the smoothest one as far as the search went.
  [[nodiscard]] bool holds() const {
    return connection_converged && eigen_converged && residual_small && index_sums_match && finite &&
           directions_settled && smallest != Smallest::refuted;
  }
};

/// Wall-clock seconds.
struct FieldTimes {
  double mesh = 0;        ///< repairs, half-edges, topology, lengths and angles
  double connection = 0;  ///< the connections, and the intrinsic triangulation
  double assembly = 0;    ///< S and M
  double eigen = 0;       ///< the eigensolver, all components
  double analysis = 0;    ///< vertex frames, indices, zeros, certificate
};

/// What a field was aligned with, and how well.
struct FieldFeatures {
  FeatureGraph graph;                ///< edges, lines, corners
  std::vector<AlignedPiece> pieces;  ///< how each component was solved
  std::vector<Index> free_corners;   ///< see AlignedResult
  FeatureReport report;              ///< deviations, singularities on features
  /// Along every line, off its corners, within 10 degrees on average.
  bool followed = false;
};

/// The triangles that a field was solved on, where they are not those of the mesh.
struct SolvedTriangulation {
  TriangleQuality before;       ///< of the mesh
  TriangleQuality after;        ///< of those triangles
  std::int64_t flips = 0;       ///< edges flipped
  Index added = 0;              ///< vertices
  Index faces = 0;              ///< of the triangulation
  Index barred = 0;             ///< see IntrinsicTriangulation
  bool complete = true;         ///< see IntrinsicTriangulation
  double seconds = 0;           ///< wall clock, without the connection
  ConnectionReport connection;  ///< of the connection that was asked for, which is made there
  /// Of that connection, where it is trivial or metric: see Connection.
  std::vector<Cone> cones;
  std::vector<double> generator_holonomy;  ///< the same, along generators of the triangulation
  std::vector<double> loop_index;          ///< the same, along loops of the triangulation
  bool parallel = true;     ///< false: flat, and without parallel n-fields, see Connection::admits_parallel
  Index singularities = 0;  ///< faces of non-zero index there; on coarse meshes those of the mesh are others
};

/// Everything a run computed. Vertices and faces are numbered as they came, unless a repair removed faces; copies of
/// split vertices come after all others.
struct FieldRun {
  ConnectedSurface surface;               ///< with the connection
  Field field;                            ///< the field
  std::vector<EigenReport> eigen;         ///< per component, in the order of topology; empty in aligned runs
  EigenModes modes;                       ///< FieldRunOptions::modes of them; none where that is 1
  std::optional<FieldFeatures> features;  ///< aligned runs
  /// Runs on an intrinsic triangulation. The field is that of its vertices; `surface` has the locally optimal
  /// connection then, in closed form, in whose frames the field is given and its indices are counted.
  std::optional<SolvedTriangulation> triangulation;
  std::vector<Index> copies_of;            ///< see RepairedMesh
  std::vector<Index> face_of;              ///< see RepairedMesh
  std::vector<int> indices;                ///< #F, in n-ths
  std::vector<IndexSum> index_sums;        ///< per component
  std::vector<Singularity> singularities;  ///< in order of faces
  Certificate certificate;                 ///< what was checked
  std::vector<Remark> remarks;             ///< what deserves mention
  FieldTimes times;                        ///< wall clock

  /// Half-edges.
  [[nodiscard]] const Mesh& mesh() const { return surface.mesh(); }
  /// Lengths, angles, areas.
  [[nodiscard]] const Geometry& geometry() const { return surface.geometry(); }
  /// Components, boundary loops.
  [[nodiscard]] const Topology& topology() const { return surface.topology(); }
  /// The connection.
  [[nodiscard]] const Connection& connection() const { return surface.connection(); }
};

/// Smoothest n-field of a surface. Throws OptionError for bad options, and when repairs are asked for: the mesh is made
/// already; SolveError when a solver fails. What did not converge is told by the certificate, not thrown. On a surface
/// that lies in no space the field has no frames.
[[nodiscard]] FieldRun run_field(const Surface& surface, const FieldRunOptions& options = {});

namespace detail {
[[nodiscard]] FieldRun run_field(Positions<double> V, Faces F, const FieldRunOptions& options);

template <class T>
concept NotASurface = !std::is_base_of_v<Surface, std::remove_cvref_t<T>>;
}  // namespace detail

/// The same from points (#V x 3) and triangles (#F x 3) of any of the types of arrays.h, after the repairs asked for.
/// Vertices where parts of the surface only touch are split, with a remark.
/// Throws MeshError for a mesh that cannot be used. Positions<double> and Faces become those of the result's surface:
/// std::move them where memory counts; everything else is copied.
template <detail::NotASurface Points, class Triangles>
[[nodiscard]] FieldRun run_field(Points&& V, Triangles&& F, const FieldRunOptions& options = {}) {
  return detail::run_field(as_positions(std::forward<Points>(V)), as_faces(std::forward<Triangles>(F)), options);
}

/// A surface after repairs, and what was done.
struct RepairedSurface {
  Surface surface;               ///< ready
  std::vector<Index> copies_of;  ///< see RepairedMesh
  std::vector<Index> face_of;    ///< see RepairedMesh
  std::vector<Remark> remarks;   ///< one per step
};

/// repair_mesh(), and a surface of the result, mollified if that is asked for. Bow-ties are looked for only where the
/// mesh is refused for them. Throws MeshError when the mesh cannot be used.
[[nodiscard]] RepairedSurface repaired_surface(Positions<double> V, Faces F, const RepairOptions& options = {});

/// What is worth saying about a mesh that can be used: unreferenced vertices, pieces that only touch, boundary,
/// slivers.
[[nodiscard]] std::vector<Remark> mesh_remarks(const Surface& surface);

}  // namespace alcap
