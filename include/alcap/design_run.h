// SPDX-License-Identifier: MIT
//
// design_run.h: the whole way from a design as users write it down to the field that has what was asked for, with what
// became of every control and the numbers that certify it. What run_field is for smoothest fields, run_design is for
// designs; a DesignSession solves one after the other and keeps what an edit leaves as it was.
//
//   alcap::Surface surface(V, F);
//   alcap::DesignRun run = alcap::run_design(surface, alcap::read_design("saddle.json"));
//   if (run.certificate.holds()) use(run.field.vectors(0), run.singularities);
//
//   alcap::DesignSession session(surface);
//   alcap::DesignRun first = session.solve(design);
//   design.singularities[0].angle += 5;
//   alcap::DesignRun next = session.solve(design);     // one right-hand side, no factorisation
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "alcap/control.h"
#include "alcap/design_file.h"
#include "alcap/field_run.h"
#include "alcap/singularities.h"

namespace alcap {

/// How run_design() solves.
struct DesignRunOptions {
  std::string solver = "auto";  // linear backend, of the design and of the eigenproblems on the way
  /// Relative residual that the certificate accepts: what EigenOptions::tolerance asks of eigenvectors. Linear solves
  /// end well below.
  double residual = 1e-8;
  ControlTolerances tolerances = {};  // what counts as met
  bool normalise = false;             // true: divide by |u| afterwards, an n-direction field
  /// As of run_field(). Faces, points and lines of the design are found on the triangles it is solved on, straight
  /// ways along the surface; what the design gives per vertex is harmonic between the mesh's own.
  Triangulation triangulation = Triangulation::automatic;
  double min_angle = 15 * pi<double> / 180;  // radians, see FieldRunOptions::min_angle
  int threads = 0;                           // 0: as many as the machine has; results do not depend on it
  /// Called on the calling thread when a phase starts: "connection", "guidance", "prepare", "solve", "analysis". An
  /// exception thrown here ends the run and reaches the caller.
  std::function<void(std::string_view phase)> progress = {};
  /// Stopping, watching and threads of every solve; its phases are those of `progress`. Its threads count where
  /// `threads` is 0.
  RunControl control = {};
};

/// What was asked for and what became of it: a singularity, a fixed vertex, a stroke, the boundary, features, or a
/// cone.
struct DesignOutcome {
  /// What was asked for.
  enum class Type { singularity, fixed, stroke, boundary, cone, features };
  Type type{};                                    ///< what was asked for
  std::size_t number = 0;                         ///< in its list of the design
  std::string path;                               ///< "/singularities/0"
  std::string name;                               ///< as given, or "saddle in face 12"
  std::optional<Control> control = std::nullopt;  ///< what the solver was asked for; none for cones
  bool met = false;                               ///< within DesignRunOptions::tolerances
  double error_degrees = 0;                       ///< see ControlReport; cones: difference of the index, 360 to a turn
  double tolerance_degrees = 0;                   ///< the largest error_degrees that counts as met
  /// Pinned zeros: the largest length_at_pin that counts as met, besides. Fixed vertices with a length: how far off the
  /// value may be, relative, instead of degrees. See ControlTolerances.
  std::optional<double> tolerance_relative = std::nullopt;
  int index = 0;                                    ///< singularities: found in the face, in n-ths
  std::optional<Singularity> found = std::nullopt;  ///< singularities: the one in the face, if there is one
  double length_at_pin = 0;                         ///< pinned zeros: |u| there, over the largest at the face's corners
  /// Cones: index asked for at the vertex and index it has, in turns.
  double cone_asked = 0, cone_index = 0;  ///< cones: index asked for at the vertex and index it has, in turns
};

/// What was checked of the field itself; whether it has what was asked for is DesignRun::met().
struct DesignCertificate {
  bool connection_converged = false;  ///< the connection reached its tolerance
  bool eigen_converged = false;       ///< every eigenproblem on the way
  bool residual_small = false;        ///< recomputed residual <= DesignRunOptions::residual
  bool index_sums_match = false;      ///< Poincare-Hopf, on every component
  bool finite = false;                ///< no value of the field is NaN or infinite
  /// All of the above.
  [[nodiscard]] bool holds() const {
    return connection_converged && eigen_converged && residual_small && index_sums_match && finite;
  }
};

/// Wall-clock seconds; what a session has kept takes none.
struct DesignTimes {
  double connection = 0;  ///< with placing the design and the frames
  double guidance = 0;    ///< the guidance field
  double prepare = 0;     ///< assembly, factorisation, controls
  double solve = 0;       ///< the design itself
  double analysis = 0;    ///< indices, zeros, what became of the controls
};

/// Everything a run computed.
struct DesignRun {
  ConnectedSurface surface;  ///< with the connection of the design, unless there is a `triangulation`
  DesignFile design;         ///< placed, with the cones that balancing added
  Field field;               ///< the field
  /// The guidance field as it was used, of root mean square length 1; null without one, and for guidance towards zero.
  std::shared_ptr<const ComplexVectorX<double>> guidance;
  double guidance_scale = 0;  ///< what it was multiplied by to be so; 0 without one
  /// Runs on an intrinsic triangulation. The field is that of its vertices, and controls are judged on it; `surface`
  /// has the locally optimal connection then (or the polar one, if that is the design's), in whose frames the field is
  /// given and its indices are counted.
  std::optional<SolvedTriangulation> triangulation;
  /// Designs with features: as of run_field(). Pieces are told where the features are all that is asked for and held or
  /// across: then the field is that of aligned_field().
  std::optional<FieldFeatures> features;
  std::vector<DesignOutcome> outcomes;     ///< singularities, fixed vertices, strokes, boundary, features, cones
  std::vector<EigenReport> eigen;          ///< eigen designs: per component, in the order of topology; otherwise empty
  std::int64_t rows = 0;                   ///< low-rank rows in this solve
  int solves = 0;                          ///< right-hand sides solved for
  double residual = 0;                     ///< recomputed; of eigen designs the largest
  std::string solver;                      ///< the backend and its choices
  std::vector<int> indices;                ///< #F, in n-ths
  std::vector<IndexSum> index_sums;        ///< per component
  std::vector<Singularity> singularities;  ///< in order of faces
  DesignCertificate certificate;           ///< what was checked
  std::vector<Remark> remarks;             ///< about the result; those about the mesh are mesh_remarks()
  DesignTimes times;                       ///< wall clock

  /// Whether every control is met: all outcomes.
  [[nodiscard]] bool met() const;
  /// Half-edges.
  [[nodiscard]] const Mesh& mesh() const { return surface.mesh(); }
  /// Lengths, angles, areas.
  [[nodiscard]] const Geometry& geometry() const { return surface.geometry(); }
  /// Components, boundary loops.
  [[nodiscard]] const Topology& topology() const { return surface.topology(); }
  /// The connection.
  [[nodiscard]] const Connection& connection() const { return surface.connection(); }
};

/// The field of a design. One that asks for nothing, neither control nor guidance, gets the smoothest field of its
/// connection, of root mean square length 1. Throws OptionError whose field is the JSON path of what is wrong,
/// FileError for a guidance file that cannot be used, SolveError; what did not converge is told by the certificate,
/// what was not met by the outcomes.
[[nodiscard]] DesignRun run_design(const Surface& surface, const DesignFile& design,
                                   const DesignRunOptions& options = {});

/// What run_design solves: the design on this surface, with faces and vertices for points of space (place_design) and
/// the cones that balancing adds. Throws OptionError.
[[nodiscard]] DesignFile plan_design(const DesignFile& design, const Surface& surface);

/// Designs on one surface, one after the other. Of the last one it keeps what the next has in common with it: the
/// connection, the guidance field, the factorised system, and the solutions of unchanged controls. Results are those of
/// run_design() up to rounding. One thread at a time.
class DesignSession {
 public:
  /// `normalise`, `tolerances`, `threads` and `progress` hold for every solve.
  explicit DesignSession(const Surface& surface, DesignRunOptions options = {});
  ~DesignSession();
  DesignSession(DesignSession&&) noexcept;
  /// Moves what is kept.
  DesignSession& operator=(DesignSession&&) noexcept;

  /// As run_design(); after an exception the session can be used again.
  [[nodiscard]] DesignRun solve(const DesignFile& design);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace alcap
