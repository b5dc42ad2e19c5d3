// SPDX-License-Identifier: MIT
//
// design_stages.h: the stages of a design run. Each knows the text of the part of the design that it was made from; it
// is made anew when that text changes, and so are the stages after it. Within the designer, controls are compared one
// by one. Internal to run.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alcap/design_run.h"
#include "src/base/cancel.h"
#include "src/run/intrinsic_solve.h"

namespace alcap::detail {

/// A field to stay close to, scaled to root mean square length 1 over the surface.
struct ScaledGuidance {
  std::shared_ptr<const ComplexVectorX<double>> u;  // null: none, or zero
  double scale = 0;
  bool converged = true;  // of the eigenproblems, where it is the smallest field
};

/// Throws OptionError (/guidance/field) when the surface has no such directions, FileError for a bad file.
[[nodiscard]] ScaledGuidance find_guidance(const ConnectedSurface& surface, const DesignFile& placed,
                                           DesignGuidance::Source source, const std::string& solver);

/// Points of a guidance file may differ from those of the surface by this much, relative to the largest coordinate:
/// what writing and reading single precision does to them.
inline constexpr double same_place = 1e-6;
/// FileErrors and OptionErrors of guidance: a file with another degree or mesh, and fields without any direction.
[[noreturn]] void throw_other_degree(const std::filesystem::path& path, int found, int wanted);
[[noreturn]] void throw_other_mesh(const std::filesystem::path& path);
[[noreturn]] void throw_no_directions(const DesignGuidance& guidance, DesignGuidance::Source source);

/// The stages; one design at a time.
class DesignStages {
 public:
  /// `once`: no second design will come, which lets the linear backend be chosen for this one alone.
  DesignStages(Surface surface, DesignRunOptions options, bool once);

  [[nodiscard]] DesignRun solve(const DesignFile& design);

 private:
  struct Held {
    std::string key;
    ControlId id{};
  };
  void say(const char* phase) const {
    if (options_.progress) options_.progress(phase);
    detail::report_phase(phase);
  }
  /// What a triangulation is to keep besides the boundary; another one is made where it is not what it was.
  void keep_edges(const std::vector<Index>& features);
  void connect(const DesignFile& placed);
  /// Sets solve_ where the design is to be solved on an intrinsic triangulation, and returns whether it is.
  bool connect_intrinsic(const ConnectionOptions& options);
  /// Controls on the mesh as they are on the triangulation.
  [[nodiscard]] std::vector<DesignControl> carried(std::vector<DesignControl> controls, int n) const;
  /// A graph of edges that the triangulation keeps, on what is solved on.
  [[nodiscard]] FeatureGraph graph_there(const FeatureGraph& graph) const;
  /// Guidance on the mesh as it is on the triangulation.
  void carry_guidance(int n);
  /// The field that was solved for, from the triangulation to the mesh.
  void bring_back(DesignRun& run) const;
  void analyse(const DesignFile& asked, const ComplexVectorX<double>& solved,
               const std::vector<DesignControl>& controls, const std::vector<DesignControl>& solved_controls,
               const std::vector<ControlReport>& reports, bool converged, DesignRun& run) const;
  void guide(const DesignFile& placed, DesignGuidance::Source source);
  /// Per vertex of what is solved on; empty without.
  [[nodiscard]] VectorX<double> guidance_weights(const DesignGuidance& g) const;
  void prepare(const DesignFile& placed, const std::vector<DesignControl>& controls);
  void put(const std::vector<DesignControl>& controls, std::vector<std::string> keys);
  void forget();
  /// Fills field, reports of the controls, and what the solve did; returns whether every eigenproblem converged.
  bool solve_variational(const std::vector<DesignControl>& controls, std::vector<ControlReport>& reports,
                         DesignRun& run);
  /// A variational design: its guidance, then the field; the guidance itself where nothing else is asked for.
  bool solve_guided(const std::vector<DesignControl>& controls, std::vector<ControlReport>& reports, DesignRun& run);
  /// Gives the components that no control and no guidance touches their smoothest field. Returns whether every
  /// eigenproblem converged.
  bool fill_pieces(const std::vector<DesignControl>& controls, DesignRun& run);
  /// Likewise, with its guidance.
  bool solve_eigen(const std::vector<DesignControl>& controls, std::vector<ControlReport>& reports, DesignRun& run);

  Surface surface_;
  DesignRunOptions options_;
  bool once_;

  std::string connection_text_;
  ConnectedSurface connected_;  // what is solved on
  ConnectedSurface given_;      // the mesh: the same, or in whose frames results of the triangulation are
  std::vector<Index> kept_;     // edges that a triangulation keeps: the boundary and features
  std::optional<IntrinsicTriangulation> triangulation_;  // made once for these
  bool needles_stay_ = false;                            // one was wanted and did not help
  std::unique_ptr<IntrinsicSolve> solve_;                // with the connection; null: solved on the mesh
  std::string guidance_text_;
  ScaledGuidance guidance_;
  std::string designer_text_;
  std::unique_ptr<Designer> designer_;
  // Components without a control, and their smoothest fields.
  std::vector<char> pieces_;
  Field pieces_field_;
  double pieces_s_ = 0;
  bool pieces_converged_ = true;
  std::vector<Held> held_;
};

/// What a design is aligned with that asks for directions along or across one kind of lines and at vertices, and for
/// nothing else.
enum class AlignedAlone { no, boundary, features };
[[nodiscard]] AlignedAlone aligned_alone(const DesignFile& placed);

/// Such a design as an aligned field: fills field, reports and what the solve did; returns whether every eigenproblem
/// converged. `graph`: of the boundary or of the features. `coarser`: as many vertices as there are to one of the mesh.
/// Throws OptionError where there is no boundary.
[[nodiscard]] bool solve_along(AlignedAlone what, const ConnectedSurface& surface, const FeatureGraph& graph,
                               double coarser, const DesignRunOptions& options,
                               const std::vector<DesignControl>& controls, std::vector<ControlReport>& reports,
                               DesignRun& run);

/// Deviations along the features of a run, and remarks, when its field is known.
void judge_design_features(const DesignFile& asked, DesignRun& run);

/// What was solved: on the mesh, or on an intrinsic triangulation of it.
struct SolvedDesign {
  const ConnectedSurface& surface;
  const ComplexVectorX<double>& u;
  const std::vector<DesignControl>& controls;  // as the solver had them
};

/// What became of the controls and cones, in the order of the design. `reports` are those of `controls`.
[[nodiscard]] std::vector<DesignOutcome> judge_design(const DesignRun& run, const SolvedDesign& solved,
                                                      const std::vector<DesignControl>& controls,
                                                      const std::vector<ControlReport>& reports,
                                                      const ControlTolerances& tolerances);

/// Sets how far off an outcome may be: from its type and control, and how it was solved for.
void set_tolerance(const ControlTolerances& tolerances, DesignMethod method, DesignOutcome& outcome);
/// |u| at the pin of a target over the largest at the corners of its face.
[[nodiscard]] double length_at_pin(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                                   const Field& field, const SingularityTarget& target);

/// Curvature that the connection gives a vertex, in turns: 1 - (sum of the corner angles it sees) / 2 pi.
[[nodiscard]] double vertex_turns(const Mesh& mesh, const Geometry& geometry, const Connection& connection, Index v);
/// What became of cone k, with the turns of its vertex.
[[nodiscard]] DesignOutcome judge_cone(const std::vector<Cone>& cones, std::size_t k, double turns,
                                       double tolerance_degrees);

/// Of an outcome that is not met. `next_target`: another target's face that shares a vertex with this one's, or none.
[[nodiscard]] Remark unmet(const DesignOutcome& outcome, int n, Index next_target);

/// What helps where something did not converge: ends the warning about it.
struct Remedies {
  std::string connection, eigen;
  std::optional<std::string> linear;  ///< none: there was no linear solve
};
/// Warnings for what does not hold.
void certificate_remarks(const DesignCertificate& certificate, const Remedies& remedies, std::vector<Remark>& remarks);

/// A note on components that have their smoothest field for want of a control: those whose `empty` is not 0.
[[nodiscard]] Remark remark_pieces(const std::vector<char>& empty);

/// A warning where the field is so much smaller than elsewhere on its component that the solve says nothing about it.
void remark_vanishing(double largest_residual, DesignRun& run);
/// The parts of it: relative to the longest vector of a component, what counts as vanished; and the warning itself,
/// with the vertices counted, where they are more than `outcomes` explain.
[[nodiscard]] double vanishing_length(double residual, double largest_residual);
void remark_vanishing(Remark remark, std::size_t outcomes, std::vector<Remark>& remarks);

/// Certificate and remarks, from everything else.
void certify_design(const Connection& solved, bool eigen_converged, double largest_residual, DesignRun& run);

}  // namespace alcap::detail
