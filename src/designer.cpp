// SPDX-License-Identifier: MIT
//
// designer.cpp: variational design by one factorisation, right-hand sides and low-rank rows.
//
// A row r_k u = t_k with compliance c_k (0: exact; 1/weight: soft, weight |r_k u - t_k|^2 in twice the energy) adds
// multipliers mu: A u + R' mu = b, R u - C mu = t. With Y = A^-1 R': (R Y + C) mu = R A^-1 b - t, u = A^-1 b - Y mu.
// Where the backend can, R Y comes from half solves, which are cheap for few rows close together, and A^-1 R' mu from
// one solve more. Rows count twice, as real and imaginary part, so that rows which fix a direction only can stand among
// them.
#include "alcap/designer.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "alcap/energies.h"
#include "alcap/parallel.h"
#include "alcap/singularities.h"
#include "src/designer_rows.h"

namespace alcap {
namespace {

using C = Complex<double>;
using detail::ControlLoad;
using detail::ControlRow;

// Exact rows get this compliance, relative to the others': rows that say the same twice stay solvable.
constexpr double exact_compliance = 1e-12;
// A field whose energy is this small, relative to its size, in units of 1/area, is parallel.
constexpr double parallel = 1e-6;
// Inverse iterations that find it.
constexpr int probes = 4;
// A target is met when its orientation is off by no more than this.
constexpr double met_degrees = 0.5;
// Strokes are met within this many degrees on average: drawn to, not tied to.
constexpr double stroke_degrees = 10;
// So many changed targets keep solutions of their own; with more, the oldest go back into the common one.
constexpr std::size_t live_targets = 8;
// Columns solved for at once, and between two looks at whether to go on.
constexpr Eigen::Index columns_at_once = 16;

// A control made ready, and what has been solved for it.
struct Prepared {
  ControlLoad load = {};
  HalfSolution<C> half = {};        // of R', when the backend can; no columns until needed
  MatrixX<C> columns = {};          // else A^-1 R', one per row; empty until needed
  ComplexVectorX<double> own = {};  // a live target's A^-1 of its load for density 1
  std::int64_t live_since = 0;      // 0: part of the common solution

  void forget_rows() {
    half = {};
    columns.resize(0, 0);
  }
  [[nodiscard]] bool rows_solved() const {
    const auto rows = static_cast<Eigen::Index>(load.rows.size());
    return half.values.cols() == rows || columns.cols() == rows;
  }
};

std::string shown(double value) {
  std::string text = std::to_string(value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

}  // namespace

struct Designer::State {
  const Mesh& mesh;
  const Geometry<double>& geometry;
  const Connection<double>& connection;
  DesignerOptions options;

  HermitianPattern pattern;
  SparseMatrix<C> S2, M;     // 2 S (of the energy family) with ones for unreferenced vertices; the mass
  SparseMatrix<C> weighted;  // the mass with the vertices' weights; empty: M
  SparseMatrix<C> A;         // what is factorised: 2 S + w M, and folded rows
  FirstOrderOperators<double> operators;
  std::shared_ptr<const Frames<double>> frames;
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
  MatrixX<C> common;          // A^-1 of everything but live targets; no columns: unknown

  State(const Mesh& mesh_, const Positions<double>& V_, const Geometry<double>& geometry_,
        const Connection<double>& connection_, const DesignerOptions& options_)
      : mesh(mesh_),
        geometry(geometry_),
        connection(connection_),
        options(options_),
        pattern(mesh_),
        loads{mesh_, V_, geometry_, connection_, operators, options_.n} {
    validate();
    tell("assembly");
    StiffnessMass<double> matrices = stiffness_and_mass(mesh, pattern, geometry, connection, options.n);
    M.swap(matrices.M);  // sparse matrices copy when they are moved
    S2.swap(matrices.S);
    apply_energy_family(mesh, pattern, geometry, connection, options.n, options.s, S2);
    check_t();
    S2 *= C(2);
    for (Index v = 0; v < mesh.vertices(); ++v)
      if (!mesh.referenced(v)) S2.valuePtr()[pattern.diagonal(v)] = 1;  // stays zero
    operators = first_order_operators(mesh, geometry, connection, {.n = options.n, .kind = options.kind});
    frames = std::make_shared<const Frames<double>>(vertex_frames(mesh, V_, geometry, connection));
    guidance = ComplexVectorX<double>::Zero(mesh.vertices());
    solver = make_linear_solver<C>({.name = options.solver, .right_hand_sides = all_right_hand_sides()});
    solver->set_transport(M);
    tell("analyse");
    solver->analyse(S2);
    make_matrix(false);
    factorise();
  }

  void tell(std::string_view phase) const {
    if (options.progress) options.progress(phase);
  }

  void validate() const {
    if (options.n < 1) throw OptionError("n", std::to_string(options.n), "the degree of a field is at least 1");
    check_guidance_weight(options.guidance_weight);
    if (options.t && !std::isfinite(*options.t)) throw OptionError("t", std::to_string(*options.t), "must be finite");
    if (options.t && options.guidance_weight > 0)
      throw OptionError("t", shown(*options.t), "give either t or guidance_weight");
    if (!(options.s >= -1 && options.s <= 1)) throw OptionError("s", std::to_string(options.s), "must be in [-1, 1]");
    if (options.largest_rank < 0)
      throw OptionError("largest_rank", std::to_string(options.largest_rank), "must not be negative");
  }

  static void check_guidance_weight(double weight) {
    if (!(weight >= 0) || !std::isfinite(weight))
      throw OptionError("guidance_weight", std::to_string(weight), "must be finite and not negative");
  }

  // Of the guidance weight and of 2 lambda_t: twice the lambda_min of a round sphere of this area.
  [[nodiscard]] double unit() const { return 8 * pi<double> * options.n / geometry.total_area(); }
  // What multiplies M in the matrix, and in the right-hand side.
  [[nodiscard]] double mass_weight() const { return (options.t ? -*options.t : options.guidance_weight) * unit(); }
  [[nodiscard]] double guidance_scale() const { return (options.t ? 1.0 : options.guidance_weight) * unit(); }
  [[nodiscard]] const SparseMatrix<C>& mass() const { return weighted.rows() > 0 ? weighted : M; }

  // Those the caller knows of and those of is_singular().
  [[nodiscard]] int all_right_hand_sides() const {
    const int known = options.right_hand_sides;
    return known > 0 && mass_weight() == 0 ? known + probes : known;
  }

  // S2 still holds S.
  void check_t() const {
    if (!options.t || *options.t < 0) return;
    // Only whether lambda_1 lies above matters: a few digits do. Vertices that no face uses get an eigenvalue far
    // above.
    SparseMatrix<C> S = S2, mass = M;
    const double tiny = 1e-6 * M.coeffs().cwiseAbs().maxCoeff();
    for (Index v = 0; v < mesh.vertices(); ++v)
      if (!mesh.referenced(v)) {
        S.valuePtr()[pattern.diagonal(v)] = 1;
        mass.valuePtr()[pattern.diagonal(v)] = tiny;
      }
    const EigenResult smallest = smallest_eigenpair(S, mass, geometry.total_area(), {.tolerance = 1e-6});
    const double limit = 2 * smallest.report.lambda / unit();
    if (!(*options.t < limit * (1 - 1e-6)))
      throw OptionError("t", shown(*options.t),
                        "must be below lambda_1, which is " + shown(limit) + " here in the same units");
  }

  // A = 2 S + w M, and the strokes where that is cheaper than an update.
  void make_matrix(bool fold) {
    const double w = mass_weight();
    const SparseMatrix<C>& m = mass();
    if (A.rows() == 0) A = S2;
    parallel_for(A.nonZeros(), [&](std::int64_t k) { A.valuePtr()[k] = S2.valuePtr()[k] + w * m.valuePtr()[k]; });
    if (fold)
      for (const auto& [id, p] : prepared) {
        if (!p.load.soft()) continue;
        for (const ControlRow& row : p.load.rows)
          for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) {
              const C value = row.weight * std::conj(row.coefficient[i]) * row.coefficient[j];
              if (value != C(0)) A.coeffRef(row.vertex[i], row.vertex[j]) += value;
            }
      }
    folded = fold;
    soft_changed = false;
    forget();
  }

  // Whatever was solved with the last matrix.
  void forget() {
    stale = true;
    common.resize(0, 0);
    for (auto& [id, p] : prepared) {
      p.forget_rows();
      p.own.resize(0);
    }
  }

  void factorise() {
    if (!stale) return;
    tell("factorise");
    const OptionError singular("guidance_weight", shown(options.guidance_weight),
                               "the design's system is singular: this connection has parallel fields (flat or "
                               "trivial), so targets alone do not determine one; give a guidance weight");
    bool parallel_fields = false;
    try {
      solver->factorise(A);
      // Iterative backends only find out here.
      parallel_fields = mass_weight() == 0 && !folded && is_singular();
    } catch (const SolveError&) {
      if (mass_weight() == 0 && !folded) throw singular;
      throw;
    }
    if (parallel_fields) throw singular;
    stale = false;
  }

  // Inverse iteration finds the energy of the smoothest field well enough to tell nothing from something.
  [[nodiscard]] bool is_singular() const {
    MatrixX<C> x = MatrixX<C>::Ones(mesh.vertices(), 1), Mx(mesh.vertices(), 1);
    double energy = 0;
    for (int round = 0; round < probes; ++round) {
      hermitian_product(M, x.data(), Mx.data());
      const double size = x.col(0).dot(Mx.col(0)).real();
      Mx /= std::sqrt(size);
      (void)solver->solve(Mx, x);
      energy = 1 / std::sqrt(std::max(0.0, x.col(0).dot(M * x.col(0)).real()));
    }
    return !(energy * geometry.total_area() > parallel);
  }

  // Weights change the values of A only.
  template <class Change>
  void reweight(Change&& change) {
    const DesignerOptions options_before = options;
    SparseMatrix<C> weighted_before = weighted;
    change();
    try {
      make_matrix(folded);
      factorise();
    } catch (...) {
      options = options_before;
      weighted = std::move(weighted_before);
      make_matrix(folded);
      throw;
    }
    make_guidance();
  }

  void make_guidance() {
    common.resize(0, 0);
    if (u0.size() == 0) return;
    hermitian_product(mass(), u0.data(), guidance.data());
    guidance *= guidance_scale();
  }

  // Whether strokes are cheaper inside the matrix, and the matrix as it should then be.
  void choose_folding() {
    if (!soft_changed) return;
    std::size_t soft = 0;
    for (const auto& [id, p] : prepared) soft += p.load.soft() ? p.load.rows.size() : 0;
    const bool fold = soft > static_cast<std::size_t>(options.largest_rank);
    if (fold || folded) make_matrix(fold);
    soft_changed = false;
  }

  [[nodiscard]] bool is_update(const Prepared& p) const { return !p.load.rows.empty() && !(p.load.soft() && folded); }

  void solve(const MatrixX<C>& B, MatrixX<C>& X, DesignResult& result) const {
    X.resize(B.rows(), B.cols());
    for (Eigen::Index from = 0; from < B.cols(); from += columns_at_once) {
      if (from > 0) tell("rows");
      const Eigen::Index count = std::min(columns_at_once, B.cols() - from);
      (void)solver->solve(B.middleCols(from, count), X.middleCols(from, count));
      result.solves += static_cast<int>(count);
    }
  }

  void solve_rows(Prepared& p, DesignResult& result) const {
    if (p.rows_solved()) return;
    tell("rows");
    const auto rows = static_cast<Eigen::Index>(p.load.rows.size());
    std::vector<Eigen::Triplet<C, Index>> entries;
    for (Eigen::Index k = 0; k < rows; ++k)
      for (std::size_t c = 0; c < 3; ++c) {
        const ControlRow& row = p.load.rows[static_cast<std::size_t>(k)];
        if (row.coefficient[c] != C(0))
          entries.emplace_back(row.vertex[c], static_cast<Index>(k), std::conj(row.coefficient[c]));
      }
    SparseMatrix<C> B(mesh.vertices(), rows);
    B.setFromTriplets(entries.begin(), entries.end());
    if (auto half = solver->half_solve(B)) {
      p.half = std::move(*half);
      return;
    }
    MatrixX<C> X;
    solve(MatrixX<C>(B), X, result);
    p.columns = std::move(X);
  }

  // R_a A^-1 R_b' of all rows of two controls.
  [[nodiscard]] static MatrixX<C> response(const Prepared& a, const Prepared& b) {
    if (b.half.values.cols() > 0) return a.half.product(b.half);
    MatrixX<C> G(static_cast<Eigen::Index>(a.load.rows.size()), b.columns.cols());
    for (Eigen::Index j = 0; j < G.cols(); ++j)
      for (Eigen::Index i = 0; i < G.rows(); ++i)
        G(i, j) = a.load.rows[static_cast<std::size_t>(i)].at(b.columns.col(j));
    return G;
  }

  template <class Column>
  void add_target(const ControlLoad& load, C density, Column&& b) const {
    for (Index c = 0; c < 3; ++c)
      b[mesh.F()(load.face, c)] += std::conj(load.coefficient[static_cast<std::size_t>(c)]) * density;
  }

  // Right-hand side of guidance, folded strokes and the targets that are not live.
  [[nodiscard]] ComplexVectorX<double> common_load() const {
    ComplexVectorX<double> b = guidance;
    for (const auto& [id, p] : prepared) {
      if (p.load.face != none && p.live_since == 0) add_target(p.load, p.load.density, b);
      if (!folded || !p.load.soft()) continue;
      for (const ControlRow& row : p.load.rows)
        for (std::size_t c = 0; c < 3; ++c) b[row.vertex[c]] += row.weight * std::conj(row.coefficient[c]) * row.target;
    }
    return b;
  }

  // The solution before the rows, from the common one and the live ones.
  void solve_loads(DesignResult& result) {
    ComplexVectorX<double> b = common_load();
    std::vector<Prepared*> live, missing;
    for (auto& [id, p] : prepared) {
      if (p.live_since == 0) continue;
      live.push_back(&p);
      if (p.own.size() == 0) missing.push_back(&p);
    }
    const Eigen::Index first = common.cols() == 0 ? 1 : 0;
    if (const auto count = first + static_cast<Eigen::Index>(missing.size()); count > 0) {
      tell("solve");
      MatrixX<C> B = MatrixX<C>::Zero(mesh.vertices(), count), X;
      if (first > 0) B.col(0) = b;
      for (std::size_t k = 0; k < missing.size(); ++k)
        add_target(missing[k]->load, 1.0, B.col(first + static_cast<Eigen::Index>(k)));
      solve(B, X, result);
      if (first > 0) common = X.col(0);
      for (std::size_t k = 0; k < missing.size(); ++k) missing[k]->own = X.col(first + static_cast<Eigen::Index>(k));
    }
    result.field.u = common.col(0);
    for (const Prepared* p : live) {
      result.field.u += p->load.density * p->own;
      add_target(p->load, p->load.density, b);
    }
    if (!b.isZero(0)) result.residual = residual<C>(A, result.field.u, b);
  }

  void apply_rows(DesignResult& result) {
    struct RealRow {
      const ControlRow* row;
      Eigen::Index number;  // of the row in its control
      C factor;             // the functional is Re(factor row.at(u))
      double target;
    };
    struct Group {
      const Prepared* owner;
      std::vector<RealRow> rows;
      Eigen::Index first;
    };
    std::vector<Group> groups;
    Eigen::Index count = 0;
    for (auto& [id, p] : prepared) {
      if (!is_update(p)) continue;
      solve_rows(p, result);
      Group group{&p, {}, count};
      for (std::size_t k = 0; k < p.load.rows.size(); ++k) {
        const ControlRow& row = p.load.rows[k];
        const auto number = static_cast<Eigen::Index>(k);
        if (row.direction_only) {
          group.rows.push_back({&row, number, C(0, -1) * std::conj(row.target) / std::abs(row.target), 0});
        } else {
          group.rows.push_back({&row, number, 1, row.target.real()});
          group.rows.push_back({&row, number, C(0, -1), row.target.imag()});
        }
      }
      result.rows += static_cast<int>(p.load.rows.size());
      count += static_cast<Eigen::Index>(group.rows.size());
      groups.push_back(std::move(group));
    }
    if (count == 0) return;
    MatrixX<double> G = MatrixX<double>::Zero(count, count);
    VectorX<double> missing(count), compliance(count);
    for (const Group& a : groups) {
      for (const Group& b : groups) {
        const MatrixX<C> complex = response(*a.owner, *b.owner);
        for (std::size_t j = 0; j < b.rows.size(); ++j)
          for (std::size_t i = 0; i < a.rows.size(); ++i)
            G(a.first + static_cast<Eigen::Index>(i), b.first + static_cast<Eigen::Index>(j)) =
                (a.rows[i].factor * complex(a.rows[i].number, b.rows[j].number) * std::conj(b.rows[j].factor)).real();
      }
      for (std::size_t i = 0; i < a.rows.size(); ++i) {
        const RealRow& row = a.rows[i];
        const Eigen::Index at = a.first + static_cast<Eigen::Index>(i);
        missing[at] = (row.factor * row.row->at(result.field.u)).real() - row.target;
        compliance[at] = row.row->weight > 0 ? 1 / row.row->weight : 0;
      }
    }
    const double exact = exact_compliance * G.diagonal().cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < count; ++i) G(i, i) += compliance[i] > 0 ? compliance[i] : exact;
    const VectorX<double> mu = G.ldlt().solve(missing);
    ComplexVectorX<double> push;  // R' mu of the controls without columns
    for (const Group& group : groups) {
      const auto& rows = group.owner->load.rows;
      ComplexVectorX<double> sum = ComplexVectorX<double>::Zero(static_cast<Eigen::Index>(rows.size()));
      for (std::size_t i = 0; i < group.rows.size(); ++i)
        sum[group.rows[i].number] += mu[group.first + static_cast<Eigen::Index>(i)] * std::conj(group.rows[i].factor);
      if (group.owner->columns.cols() > 0) {
        result.field.u.noalias() -= group.owner->columns * sum;
        continue;
      }
      if (push.size() == 0) push = ComplexVectorX<double>::Zero(mesh.vertices());
      for (std::size_t k = 0; k < rows.size(); ++k)
        for (std::size_t c = 0; c < 3; ++c)
          push[rows[k].vertex[c]] += std::conj(rows[k].coefficient[c]) * sum[static_cast<Eigen::Index>(k)];
    }
    if (push.size() == 0) return;
    MatrixX<C> X;
    solve(push, X, result);
    result.field.u -= X.col(0);
  }

  [[nodiscard]] ControlReport judge(ControlId id, const Control& control, const Field<double>& field) const {
    const ComplexVectorX<double>& u = field.u;
    ControlReport report{.id = id};
    const ControlLoad& load = prepared.at(id).load;
    const double degrees = 180 / pi<double>;
    if (const auto* target = std::get_if<SingularityTarget>(&control)) {
      report.index = face_index(mesh, connection, field, target->face);
      C value = 0;
      for (Index c = 0; c < 3; ++c)
        value += load.coefficient[static_cast<std::size_t>(c)] * u[mesh.F()(target->face, c)];
      const int turns = detail::target_turns(options.n, target->sign);
      report.error_degrees = std::abs(wrap(std::arg(value) - turns * target->orientation)) / turns * degrees;
      report.met = report.index == target->sign && report.error_degrees <= met_degrees;
    } else if (const auto* constraint = std::get_if<VertexConstraint>(&control)) {
      const C value = u[constraint->vertex];
      const double size = std::abs(constraint->value) + u.cwiseAbs().maxCoeff();
      report.error_degrees = std::abs(wrap(std::arg(value) - std::arg(constraint->value))) / options.n * degrees;
      report.met = constraint->direction_only ? std::abs(value) > 1e-9 * size && report.error_degrees <= met_degrees
                                              : std::abs(value - constraint->value) <= 1e-6 * size;
    } else {
      double sum = 0, weights = 0;
      for (const ControlRow& row : load.rows) {
        sum += row.weight * std::abs(wrap(std::arg(row.at(u)) - std::arg(row.target))) / options.n;
        weights += row.weight;
      }
      report.error_degrees = sum / weights * degrees;
      report.met = report.error_degrees <= stroke_degrees;
    }
    return report;
  }

  // A control has come, gone or changed.
  void touched(const ControlLoad& load) {
    soft_changed |= load.soft();
    if (load.face != none) common.resize(0, 0);
  }

  void make_live(Prepared& p) {
    std::size_t live = 0;
    Prepared* oldest = nullptr;
    for (auto& [id, q] : prepared) {
      if (q.live_since == 0) continue;
      ++live;
      if (!oldest || q.live_since < oldest->live_since) oldest = &q;
    }
    if (live >= live_targets) {
      oldest->live_since = 0;
      oldest->own.resize(0);
      common.resize(0, 0);
    }
    p.live_since = ++clock;
  }
};

Designer::Designer(const Mesh& mesh, const Positions<double>& V, const Geometry<double>& geometry,
                   const Connection<double>& connection, const DesignerOptions& options)
    : state_(std::make_unique<State>(mesh, V, geometry, connection, options)) {}
Designer::~Designer() = default;
Designer::Designer(Designer&&) noexcept = default;
Designer& Designer::operator=(Designer&&) noexcept = default;

ControlId Designer::add(Control control) {
  State& s = *state_;
  ControlLoad load = std::visit(s.loads, control);
  const ControlId id{s.next_id++};
  s.touched(load);
  s.prepared.emplace(id, Prepared{.load = std::move(load)});
  s.controls.emplace(id, std::move(control));
  return id;
}

void Designer::set(ControlId id, Control control) {
  State& s = *state_;
  const auto at = s.prepared.find(id);
  if (at == s.prepared.end()) throw OptionError("id", std::to_string(static_cast<int>(id)), "there is no such control");
  Prepared& p = at->second;
  ControlLoad load = std::visit(s.loads, control);
  // Rows that stay the same keep their solved columns: turning a pinned saddle costs a right-hand side.
  const auto same = [](const ControlRow& a, const ControlRow& b) {
    return a.vertex == b.vertex && a.coefficient == b.coefficient;
  };
  if (!std::equal(load.rows.begin(), load.rows.end(), p.load.rows.begin(), p.load.rows.end(), same)) p.forget_rows();
  s.soft_changed |= load.soft() || p.load.soft();
  if (load.face != p.load.face || load.coefficient != p.load.coefficient) p.own.resize(0);
  if (p.live_since == 0) {
    if (p.load.face != none) s.common.resize(0, 0);
    if (load.face != none) s.make_live(p);
  } else if (load.face == none) {
    p.live_since = 0;
  }
  p.load = std::move(load);
  s.controls.at(id) = std::move(control);
}

void Designer::remove(ControlId id) {
  State& s = *state_;
  const auto at = s.prepared.find(id);
  if (at == s.prepared.end()) throw OptionError("id", std::to_string(static_cast<int>(id)), "there is no such control");
  s.soft_changed |= at->second.load.soft();
  if (at->second.load.face != none && at->second.live_since == 0) s.common.resize(0, 0);
  s.prepared.erase(at);
  s.controls.erase(id);
}

const std::map<ControlId, Control>& Designer::controls() const { return state_->controls; }

void Designer::set_guidance(const ComplexVectorX<double>& u0) {
  State& s = *state_;
  if (!(s.guidance_scale() > 0)) throw OptionError("guidance_weight", "0", "a guidance field needs a weight");
  if (u0.size() != s.mesh.vertices())
    throw OptionError("u0", std::to_string(u0.size()) + " values", "needs one per vertex");
  if (!u0.allFinite()) throw OptionError("u0", "not finite", "every value must be finite");
  s.u0 = u0;
  s.make_guidance();
}

void Designer::set_guidance_weight(double weight) {
  State& s = *state_;
  State::check_guidance_weight(weight);
  if (!(weight > 0) && s.u0.size() > 0) throw OptionError("guidance_weight", "0", "a guidance field needs a weight");
  s.reweight([&] {
    s.options.guidance_weight = weight;
    s.options.t.reset();
  });
}

void Designer::set_guidance_weights(const VectorX<double>& weights) {
  State& s = *state_;
  if (weights.size() != s.mesh.vertices())
    throw OptionError("weights", std::to_string(weights.size()) + " values", "needs one per vertex");
  for (Index v = 0; v < s.mesh.vertices(); ++v)
    if (!(weights[v] >= 0) || !std::isfinite(weights[v]))
      throw OptionError("weights", std::to_string(weights[v]),
                        "of vertex " + std::to_string(v) + " must be finite and not negative");
  if (!(weights.maxCoeff() > 0)) throw OptionError("weights", "all 0", "one at least must be positive");
  if (s.options.t) throw OptionError("t", shown(*s.options.t), "weights per vertex go with guidance_weight");
  s.reweight([&] {
    s.weighted = s.M;
    const VectorX<double> roots = weights.cwiseSqrt();
    for (Index j = 0; j < s.weighted.outerSize(); ++j)
      for (SparseMatrix<C>::InnerIterator it(s.weighted, j); it; ++it) it.valueRef() *= roots[it.row()] * roots[j];
  });
}

DesignResult Designer::solve() {
  State& s = *state_;
  const auto start = std::chrono::steady_clock::now();
  if (s.controls.empty() && s.guidance.isZero(0))
    throw OptionError("controls", "none", "without targets, constraints, strokes or guidance the field is zero");
  s.choose_folding();
  s.factorise();
  DesignResult result;
  result.field.n = s.options.n;
  result.field.frames = s.frames;
  s.solve_loads(result);
  s.apply_rows(result);
  result.solver = s.solver->name();
  s.tell("analysis");
  for (const auto& [id, control] : s.controls) result.controls.push_back(s.judge(id, control, result.field));
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace alcap
