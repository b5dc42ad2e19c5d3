// SPDX-License-Identifier: MIT
//
// state.h: what a Designer keeps between calls, and the steps of a solve. Internal to designer.
//
// designer.cpp: controls come and go. system.cpp: the matrix, its factorisation and the guidance.
// solve.cpp: right-hand sides, low-rank rows, the verdict on every control. held.cpp: designs with held features.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "alcap/connected_surface.h"
#include "alcap/designer.h"
#include "alcap/energies.h"
#include "src/base/cancel.h"
#include "src/design/variational/free_fields.h"
#include "src/design/variational/rows.h"

namespace alcap {
namespace detail {

/// A control made ready, and what has been solved for it.
struct Prepared {
  ControlLoad load = {};
  HalfSolution<Complex<double>> half = {};  // of R', when the backend can; no columns until needed
  MatrixX<Complex<double>> columns = {};    // else A^-1 R', one per row; empty until needed
  ComplexVectorX<double> own = {};          // a live target's A^-1 of its load for density 1
  std::int64_t live_since = 0;              // 0: part of the common solution

  void forget_rows() {
    half = {};
    columns.resize(0, 0);
  }
  [[nodiscard]] bool rows_solved() const {
    const auto rows = static_cast<Eigen::Index>(load.rows.size());
    return half.values.cols() == rows || columns.cols() == rows;
  }
};

/// A real matrix and its factorisation; no solver: none.
struct HeldFactor {
  SparseMatrix<double> matrix = {};
  std::unique_ptr<LinearSolver<double>> solver = {};
};

}  // namespace detail

struct Designer::State {
  using C = Complex<double>;
  using ControlLoad = detail::ControlLoad;
  using ControlRow = detail::ControlRow;
  using Prepared = detail::Prepared;

  const ConnectedSurface surface;  // keeps alive what the next three refer to
  const Mesh& mesh;
  const Geometry& geometry;
  const Connection& connection;
  DesignerOptions options;

  HermitianPattern pattern;
  SparseMatrix<C> S2, M;     // 2 S (of the energy family) with ones for unreferenced vertices; the mass
  SparseMatrix<C> weighted;  // the mass with the vertices' weights; empty: M
  SparseMatrix<C> A;         // what is factorised: 2 S + w M, and folded rows
  FirstOrderOperators operators;
  std::shared_ptr<const Frames> frames;
  std::unique_ptr<LinearSolver<C>> solver;
  detail::ControlLoads loads;

  ComplexVectorX<double> u0;        // guidance; empty: none
  ComplexVectorX<double> guidance;  // its right-hand side
  std::map<ControlId, Control> controls;
  std::map<ControlId, Prepared> prepared;
  int next_id = 0;
  std::int64_t clock = 0;
  bool folded = false;        // strokes are in A
  bool soft_changed = false;  // strokes have changed since A was made
  bool stale = false;         // A is not what is factorised
  // Without guidance and rows A would have a kernel of parallel fields. All rows are in it then: exact ones with a
  // weight that their update makes irrelevant. Components with such fields that no row touches are drawn towards zero.
  bool singular = false;
  std::vector<char> parallel;                    // per component, when singular: whether it has parallel fields
  MatrixX<C> common;                             // A^-1 of everything but live targets; no columns: unknown
  std::vector<detail::HeldFactor> held_factors;  // of designs with held features, one per round of setting lengths

  // The system: system.cpp.
  State(const ConnectedSurface& surface_, const DesignerOptions& options_);
  void tell(std::string_view phase) const {
    if (options.progress) options.progress(phase);
    detail::report_phase(phase);
  }
  void validate() const;
  static void check_guidance_weight(double weight);
  [[nodiscard]] double unit() const { return detail::guidance_unit(options.n, geometry.total_area()); }
  // What multiplies M in the matrix, and in the right-hand side.
  [[nodiscard]] double mass_weight() const { return (options.t ? -*options.t : options.guidance_weight) * unit(); }
  [[nodiscard]] double guidance_scale() const { return (options.t ? 1.0 : options.guidance_weight) * unit(); }
  [[nodiscard]] const SparseMatrix<C>& mass() const { return weighted.rows() > 0 ? weighted : M; }
  // Those the caller knows of and those of is_singular().
  [[nodiscard]] int all_right_hand_sides() const {
    const int known = options.right_hand_sides;
    return known > 0 && mass_weight() == 0 ? known + detail::singular_probes : known;
  }
  // S2 still holds S.
  void check_t() const;
  // A = 2 S + w M, and the strokes where that is cheaper than an update.
  void make_matrix(bool fold);
  // Whatever was solved with the last matrix.
  void forget();
  void factorise();
  // What `singular` says.
  void hold_kernel();
  // The part of it for components that no row touches, or rows of directions alone. M has the matrix's pattern.
  void lift_parallel(SparseMatrix<C>& matrix) const;
  // Sets `parallel`: by inverse iteration with a little of the mass everywhere, so that every component has a factor.
  void find_parallel();
  // Throws OptionError when targets alone are to determine a field where parallel fields can be added freely.
  void check_determined() const;
  [[nodiscard]] double anchor() const;
  // Inverse iteration finds the energy of the smoothest field well enough to tell nothing from something.
  [[nodiscard]] bool is_singular() const;
  // Weights change the values of A only.
  template <class Change>
  void reweight(Change&& change) {
    const DesignerOptions options_before = options;
    SparseMatrix<C> weighted_before;  // assigned: Eigen's constructors leak where memory runs out in the middle of them
    weighted_before = weighted;
    const bool singular_before = singular;
    change();
    try {
      singular = false;
      make_matrix(folded && !singular_before);
      factorise();
    } catch (...) {
      const detail::CarriedScope whole(nullptr);
      options = options_before;
      weighted = std::move(weighted_before);
      singular = singular_before;
      make_matrix(folded);
      throw;
    }
    make_guidance();
  }
  void make_guidance();
  // Whether strokes are cheaper inside the matrix, and the matrix as it should then be.
  void choose_folding();
  void solve(const MatrixX<C>& B, MatrixX<C>& X, DesignResult& result) const;

  // A solve: solve.cpp.
  [[nodiscard]] bool is_update(const Prepared& p) const { return !p.load.rows.empty() && !(p.load.soft() && folded); }
  void solve_rows(Prepared& p, DesignResult& result) const;
  // Whether A^-1 R' of this control is kept whole rather than as a half solution.
  [[nodiscard]] bool keeps_column(const Prepared& p) const;
  // R_a A^-1 R_b' of all rows of two controls.
  [[nodiscard]] static MatrixX<C> response(const Prepared& a, const Prepared& b);
  template <class Column>
  void add_target(const ControlLoad& load, C density, Column&& b) const {
    load.add_target(mesh, density, [&](Index v, C value) { b[v] += value; });
  }
  // Right-hand side of guidance, folded strokes and the targets that are not live.
  [[nodiscard]] ComplexVectorX<double> common_load() const;
  // The solution before the rows, from the common one and the live ones; returns its right-hand side.
  ComplexVectorX<double> solve_loads(DesignResult& result);
  // The rows of one control; the first one's number among all.
  struct RowGroup {
    const Prepared* owner;
    Eigen::Index first, count;
  };
  // Rows that are an update of the solution, solved for where they are not yet.
  [[nodiscard]] std::vector<RowGroup> collect_rows(DesignResult& result);
  // mu of all rows, for the solution u before them.
  [[nodiscard]] ComplexVectorX<double> row_multipliers(const std::vector<RowGroup>& groups,
                                                       const ComplexVectorX<double>& u) const;
  void apply_rows(const ComplexVectorX<double>& load, DesignResult& result);
  // Whether features hold directions; then solve_held takes the place of the three above.
  [[nodiscard]] bool holds_features() const;
  void solve_held(DesignResult& result);
  [[nodiscard]] ControlReport judge(ControlId id, const Control& control, const Field& field) const;

  // Controls: designer.cpp.
  // A control has come, gone or changed.
  void touched(const ControlLoad& load);
  void make_live(Prepared& p);
  // Throws OptionError when it is something else.
  [[nodiscard]] const SingularityTarget& singularity(ControlId id) const;
};

}  // namespace alcap
