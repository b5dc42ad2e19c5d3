// SPDX-License-Identifier: MIT
//
// design_file.h: a design as users write it down: singularities by kind and angle, fixed vertices, strokes, boundary,
// cones and guidance, in degrees and in directions of space, as a struct and as a JSON file (docs/design.md, version
// 1).
//
//   alcap::DesignFile design = alcap::read_design("saddle.json");
//   design = alcap::place_design(design, surface);              // points of space become faces and vertices
//   alcap::check_design(design, surface.mesh());                // names what does not fit this mesh
//   for (auto& c : alcap::design_controls(design, connected)) designer.add(c.control);
//
// Problems are named by their place in the file (a JSON pointer such as /singularities/2/face) and their value:
// FileError from reading, OptionError from everything else. Faces, vertices and arrays count from 0. Directions and
// points are in the coordinates of the mesh.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "alcap/connected_surface.h"
#include "alcap/designer.h"
#include "alcap/sharp_edges.h"

namespace alcap {

inline constexpr int design_version = 1;  ///< The version of the format that is written, and the only one that is read.

/// A point or direction in space.
using Vector3 = std::array<double, 3>;

/// What a singularity looks like. Sink, vortex and spiral exist for n = 1 only, wedge and trisector for n = 2.
enum class SingularityKind {
  source,     ///< index +1/n; n = 1: a source, turned into a spiral by `angle`
  sink,       ///< index +1
  vortex,     ///< index +1, counter-clockwise; angle 180 makes it clockwise
  spiral,     ///< index +1; `angle` is the swirl: 0 source, 90 vortex, 180 sink
  saddle,     ///< index -1/n
  wedge,      ///< index +1/2
  trisector,  ///< index -1/2
};
template <>
struct NamesOf<SingularityKind> {
  static constexpr auto table = detail::name_table<SingularityKind>({{SingularityKind::source, "source"},
                                                                     {SingularityKind::sink, "sink"},
                                                                     {SingularityKind::vortex, "vortex"},
                                                                     {SingularityKind::spiral, "spiral"},
                                                                     {SingularityKind::saddle, "saddle"},
                                                                     {SingularityKind::wedge, "wedge"},
                                                                     {SingularityKind::trisector, "trisector"}});
};

/// A singularity of index +-count/n. One of `face` and `at`.
struct DesignSingularity {
  std::string name = {};                           // for messages and the report
  Index face = none;                               ///< the face, or none where `at` is given
  std::optional<Vector3> at = std::nullopt;        // the face nearest to this point
  SingularityKind kind = SingularityKind::source;  ///< what it looks like
  /// Degrees. Index +1 with n = 1: swirl, added to that of the kind. Otherwise the direction of one of the straight
  /// branches, from `relative_to` projected to the face, or else from the face's first edge; counter-clockwise.
  double angle = 0;
  std::optional<Vector3> relative_to = std::nullopt;  ///< where the angle starts; empty: the face's first edge
  int count = 1;                                      // index +-count/n: that many zeros side by side
  double strength = 1;                                // holds against a guidance field of unit length
  bool pin = false;  // the zero lies exactly at `barycentric`, or else at the point nearest to `at`, or the barycenter
  std::optional<std::array<double, 3>> barycentric = std::nullopt;  ///< of the pin
};

/// The field at a vertex, exactly. One of `vertex` and `at`; one of `direction` and `angle`.
struct DesignFixed {
  std::string name = {};                            ///< for messages and reports
  Index vertex = none;                              ///< the vertex, or none where `at` is given
  std::optional<Vector3> at = std::nullopt;         // the vertex nearest to this point
  std::optional<Vector3> direction = std::nullopt;  // of one of the n branches, projected to the tangent plane
  std::optional<double> angle = std::nullopt;       // degrees from `relative_to`, or else from the vertex frame's axis
  std::optional<Vector3> relative_to = std::nullopt;  ///< where the angle starts; empty: the axis of the vertex frame
  double length = 1;                                  // |u| there
  bool free_length = false;                           // only the direction is fixed
};

/// A point of a stroke. `face` and `barycentric`, or `at`.
struct DesignPoint {
  Index face = none;                         ///< the face, or none where `at` is given
  std::array<double, 3> barycentric{};       ///< in that face
  std::optional<Vector3> at = std::nullopt;  // the nearest point of the surface
};

/// A stroke is traced through every face it crosses. One of `points`, `vertices` and `path`.
struct DesignStroke {
  std::string name = {};                 ///< for messages and reports
  std::vector<DesignPoint> points = {};  ///< in order
  std::vector<Index> vertices = {};      // along edges, by shortest paths between those that no edge joins
  std::vector<Vector3> path = {};        // a polyline in space, projected to the surface
  double weight = 1;                     // see Stroke, EigenStroke
  double radius = 0;                     // of a hat-shaped footprint, in units of the mesh; 0: the line alone
};

/// Alignment with the boundary; none unless `wanted`.
struct DesignBoundary {
  bool wanted = false;  ///< whether the design asks for it
  bool normal = false;  ///< across the boundary, not along it
  double weight = 1;    // see BoundaryAlignment
};

/// Alignment with sharp edges (sharp_edges.h), for even n; none unless `wanted`. Drawn along them a field has a stroke
/// along every line; held, or across them, it has the FeatureAlignment of controls.h.
struct DesignFeatures {
  bool wanted = false;  ///< whether the design asks for it
  double angle = 40;    // degrees, in (0, 180]: edges that fold by at least this; see SharpEdgeOptions
  double weight = 1;    // see Stroke, EigenStroke
  bool hold = false;    ///< directions at vertices of features are exact; otherwise features only draw
  bool across = false;  ///< across the features, not along them
  /// What names the edges, instead of the angle: see read_feature_edges(). As written; read_design makes it relative to
  /// the folder of the design.
  std::filesystem::path file = {};
  std::vector<std::array<Index, 2>> edges = {};  ///< the same, by their vertices
  bool boundary = false;                         ///< boundary edges are features too; with `angle`
  double corner_angle = 40;                      // degrees, in (0, 180]; this and the rest: see SharpEdgeOptions
  double low_angle = 0;                          // degrees, at most `angle`, and with it; 0: off
  double gap = 0;                                ///< in the unit of length of the mesh; 0: off
  double spur = 0;                               ///< the same
};

/// A cone at the vertex nearest to a point.
struct DesignConeAt {
  Vector3 at{};      ///< the cone lies at the vertex nearest to this point
  double index = 0;  // see Cone
};

/// The connection that a design asks for.
struct DesignConnection {
  ConnectionKind kind = ConnectionKind::global;          // trivial, metric: with the cones
  PolarCenter center = PolarCenter::incenter;            ///< of the polar map
  double detail = 1;                                     // see GlobalOptions
  LengthFactor length_factor = LengthFactor::mean_edge;  // see GlobalOptions
  double tan_cap = 10;                                   // see GlobalOptions
  std::vector<Cone> cones = {};                          ///< at vertices
  std::vector<DesignConeAt> cones_at = {};               ///< at points in space
  bool balance = false;               // trivial: cones are added until they sum to what topology demands
  std::vector<double> holonomy = {};  // of the generators, in turns; empty: the least change
  std::vector<double> loops = {};     // index of every boundary loop, in turns; empty: the least change
  ConnectionTarget target = {};       // metric: instead of cones, holonomy and loops
  bool spread = true;                 // with a target, see NearestOptions
};

/// What a design stays close to.
struct DesignGuidance {
  /// Where the guidance field comes from.
  enum class Source {
    nothing,          ///< no guidance term
    zero,             ///< towards zero: what makes flat and trivial connections solvable without saying anything else
    smoothest,        ///< the smoothest field of this connection
    curvature,        ///< directions of principal curvature (n even), the largest for n = 2
    least_curvature,  ///< n = 2: the direction of least curvature
    strongest_curvature,  ///< the direction of the curvature that is largest by magnitude, whatever its sign
    file,                 ///< a field that alcap wrote, on the same mesh
  };
  Source source = Source::nothing;         ///< where the guidance field comes from
  std::filesystem::path file = {};         // as written; read_design makes it relative to the folder of the design
  double weight = 1;                       // see DesignerOptions::guidance_weight
  std::optional<double> t = std::nullopt;  // instead of the weight, see DesignerOptions::t
  std::vector<double> weights = {};        // per vertex, multiply the weight; empty: 1 everywhere
};
template <>
struct NamesOf<DesignGuidance::Source> {
  static constexpr auto table =
      detail::name_table<DesignGuidance::Source>({{DesignGuidance::Source::nothing, "none"},
                                                  {DesignGuidance::Source::zero, "zero"},
                                                  {DesignGuidance::Source::smoothest, "smoothest"},
                                                  {DesignGuidance::Source::curvature, "curvature"},
                                                  {DesignGuidance::Source::least_curvature, "least-curvature"},
                                                  {DesignGuidance::Source::strongest_curvature, "strongest-curvature"},
                                                  {DesignGuidance::Source::file, "file"}});
};

/// A change of the singularities above it in the file, so that a design can be edited by commands: move one, merge two,
/// split one. Numbers are places in DesignFile::singularities, as they are before any edit.
struct DesignEdit {
  /// What is done.
  enum class Type {
    move,   ///< to face `to`; a direction without `relative_to` is carried along
    merge,  ///< with `other`, whose index is added: it is gone, and so are both where the sum is 0
    split,  ///< `count` n-ths of it go to face `to`, as a new singularity at the end of the list
  };
  Type type = Type::move;  ///< what is done
  std::size_t which = 0;   ///< to which singularity
  std::size_t other = 0;   ///< merge: with this one
  Index to = none;         ///< move, split: the face
  int count = 1;           ///< split: how many n-ths
};
template <>
struct NamesOf<DesignEdit::Type> {
  static constexpr auto table = detail::name_table<DesignEdit::Type>(
      {{DesignEdit::Type::move, "move"}, {DesignEdit::Type::merge, "merge"}, {DesignEdit::Type::split, "split"}});
};

/// Which of the two ways of LTGD 2016, Sec. 7 solves a design.
enum class DesignMethod {
  variational,  ///< designer.h: a linear solve, exact where it says so
  eigen,        ///< eigen_design.h: the smoothest field that follows strokes and has the singularities
};
template <>
struct NamesOf<DesignMethod> {
  static constexpr auto table =
      detail::name_table<DesignMethod>({{DesignMethod::variational, "variational"}, {DesignMethod::eigen, "eigen"}});
};

/// Counts of the mesh that a design is for.
struct DesignMesh {
  /// How many the mesh must have.
  std::int64_t vertices = 0, faces = 0;  ///< how many the mesh must have
};

/// A whole design, as its file says it.
struct DesignFile {
  std::string comment = {};                           ///< for people
  std::optional<DesignMesh> mesh = std::nullopt;      // given: the design refuses other meshes
  int n = 1;                                          ///< degree of the field
  DesignMethod method = DesignMethod::variational;    ///< variational or eigen
  double s = 0;                                       // energy family in [-1, 1], see SmoothestOptions::s
  DesignConnection connection = {};                   ///< which connection
  DesignGuidance guidance = {};                       ///< what the field stays close to
  std::vector<DesignSingularity> singularities = {};  ///< targets
  std::vector<DesignFixed> fixed = {};                ///< fixed vertices
  std::vector<DesignStroke> strokes = {};             ///< strokes
  DesignBoundary boundary = {};                       ///< alignment with the boundary
  DesignFeatures features = {};                       ///< alignment with sharp edges
  std::vector<DesignEdit> edits = {};                 ///< changes of the singularities, in order
};

/// Reads and checks a design. Throws FileError: missing, not JSON (with the line), a key that is unknown or given
/// twice, a value of the wrong type or out of range; the message names the JSON path and the value.
[[nodiscard]] DesignFile read_design(const std::filesystem::path& path);

/// The same from memory; `name` stands for the file in messages, and `folder` is what guidance files are relative to.
[[nodiscard]] DesignFile parse_design(std::string_view text, const std::string& name = "design",
                                      const std::filesystem::path& folder = {});

/// Reads a target for `connection.target` from a JSON file of its own: the object that has this key in a design. Throws
/// FileError.
[[nodiscard]] ConnectionTarget read_connection_target(const std::filesystem::path& path);

/// Writes a design so that reading it gives the same design. Throws OptionError (see check_design) and FileError.
void write_design(const std::filesystem::path& path, const DesignFile& design);

/// The text that write_design writes.
[[nodiscard]] std::string design_text(const DesignFile& design);

/// Everything that can be checked without a mesh. Throws OptionError whose field is the JSON path.
void check_design(const DesignFile& design);

/// Whether the design fits this mesh, besides check_design: counts, numbers of faces, vertices and cones. Throws
/// OptionError.
void check_design(const DesignFile& design, const Mesh& mesh);

/// The edges that the features of a design are. Throws OptionError, FileError for a file that cannot be used.
[[nodiscard]] FeatureGraph design_features(const DesignFile& design, const Surface& surface);

/// The same design with features that draw along them replaced by strokes, all others by their edges, `at` by faces,
/// vertices and barycentric coordinates, a path by the points of the surface nearest to it, and edits done. Throws as
/// check_design and design_features do, and on a surface that lies in no space.
[[nodiscard]] DesignFile place_design(const DesignFile& design, const Surface& surface);

/// The connection of a placed design, for connect().
[[nodiscard]] ConnectionOptions connection_options(const DesignFile& design);

/// One control of the designer and where it came from.
struct DesignControl {
  std::string path;  ///< "/singularities/0"
  std::string name;  ///< as given, or "saddle in face 12"
  Control control;   ///< as Designer::add() takes it
};

/// The controls of a placed design: singularities, fixed vertices, strokes, the boundary, features. The surface
/// has the connection of the design. Throws OptionError when a direction has no part in the tangent plane or a stroke
/// cannot be traced.
[[nodiscard]] std::vector<DesignControl> design_controls(const DesignFile& design, const ConnectedSurface& surface);

/// A stroke along every feature line, named "feature line 0", "feature line 1", ...: soft alignment with creases, for
/// designs of even n. For fields held along them see aligned.h.
[[nodiscard]] std::vector<DesignStroke> feature_strokes(const FeatureGraph& features, double weight = 1);

/// +1 or -1, in n-ths.
[[nodiscard]] int index_of(SingularityKind kind);

}  // namespace alcap
