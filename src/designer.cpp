// SPDX-License-Identifier: MIT
//
// designer.cpp: variational design by one factorisation, right-hand sides and low-rank rows.
//
// A row r_k u = t_k with compliance c_k (0: exact; 1/weight: soft, weight |r_k u - t_k|^2 in twice the energy) adds
// multipliers mu: A u + R' mu = b, R u - C mu = t. With Y = A^-1 R': (R Y + C) mu = R A^-1 b - t, u = A^-1 b - Y mu.
#include "alcap/designer.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <chrono>
#include <cmath>
#include <string>

#include "alcap/energies.h"
#include "alcap/parallel.h"
#include "alcap/singularities.h"
#include "src/triangle_frame.h"

namespace alcap {
namespace {

using C = Complex<double>;

// A target's flux, in units of 2 pi sqrt(area of its face): the field it makes is several unit lengths long at the rim
// of the face, so that strength 1 outweighs a unit guidance field there.
constexpr double target_flux = 4;
// Weight per length of a stroke of weight 1, times sqrt(area) of the surface: the same on every mesh and in every unit.
constexpr double stroke_scale = 40;
// Exact rows get this compliance, relative to the others': rows that say the same twice stay solvable.
constexpr double exact_compliance = 1e-12;
// A field whose energy is this small, relative to its size, in units of 1/area, is parallel.
constexpr double parallel = 1e-6;
// A target is met when its orientation is off by no more than this.
constexpr double met_degrees = 0.5;

struct Row {
  std::array<Index, 3> vertex{};
  std::array<C, 3> coefficient{};
  C target = 0;
  double weight = 0;  // 0: exact

  [[nodiscard]] C at(const ComplexVectorX<double>& u) const {
    C sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += coefficient[k] * u[vertex[k]];
    return sum;
  }
};

// A control made ready: its part of the right-hand side, its rows and their solved columns.
struct Prepared {
  Index face = none;  // right-hand side of a target
  std::array<C, 3> load{};
  std::vector<Row> rows = {};
  MatrixX<C> columns = {};  // A^-1 R', one per row; empty until needed
};

void check_weight(const char* name, double value) {
  if (!(value > 0) || !std::isfinite(value))
    throw OptionError(name, std::to_string(value), "must be positive and finite");
}

void check_point(const Mesh& mesh, const SurfacePoint& p, const char* name) {
  if (p.face < 0 || p.face >= mesh.faces())
    throw OptionError(name, std::to_string(p.face),
                      "there is no such face; the mesh has " + std::to_string(mesh.faces()));
  const double sum = p.barycentric[0] + p.barycentric[1] + p.barycentric[2];
  for (const double b : p.barycentric)
    if (!(b >= -1e-9) || !(std::abs(sum - 1) <= 1e-6))
      throw OptionError(name, std::to_string(b), "barycentric coordinates are not negative and sum to 1");
}

}  // namespace

struct Designer::State {
  const Mesh& mesh;
  const Positions<double>& V;
  const Geometry<double>& geometry;
  const Connection<double>& connection;
  DesignerOptions options;

  HermitianPattern pattern;
  SparseMatrix<C> A, M;
  FirstOrderOperators<double> operators;
  std::shared_ptr<const Frames<double>> frames;
  std::unique_ptr<LinearSolver<C>> solver;
  double w = 0;
  ComplexVectorX<double> guidance;  // w M u0
  std::map<ControlId, Control> controls;
  std::map<ControlId, Prepared> prepared;
  int next_id = 0;
  bool strokes_changed = false;
  SparseMatrix<C> folded;  // A with the strokes, when that is what is factorised; else empty

  State(const Mesh& mesh_, const Positions<double>& V_, const Geometry<double>& geometry_,
        const Connection<double>& connection_, const DesignerOptions& options_)
      : mesh(mesh_), V(V_), geometry(geometry_), connection(connection_), options(options_), pattern(mesh_) {
    if (options.n < 1) throw OptionError("n", std::to_string(options.n), "the degree of a field is at least 1");
    if (!(options.guidance_weight >= 0) || !std::isfinite(options.guidance_weight))
      throw OptionError("guidance_weight", std::to_string(options.guidance_weight), "must be finite and not negative");
    if (options.largest_rank < 0)
      throw OptionError("largest_rank", std::to_string(options.largest_rank), "must not be negative");
    StiffnessMass<double> matrices = stiffness_and_mass(mesh, pattern, geometry, connection, options.n);
    M = std::move(matrices.M);
    A = std::move(matrices.S);
    w = options.guidance_weight * 8 * pi<double> * options.n / geometry.total_area();
    parallel_for(A.nonZeros(), [&](std::int64_t k) { A.valuePtr()[k] = 2.0 * A.valuePtr()[k] + w * M.valuePtr()[k]; });
    for (Index v = 0; v < mesh.vertices(); ++v)
      if (!mesh.referenced(v)) A.valuePtr()[pattern.diagonal(v)] = 1;  // stays zero
    operators = first_order_operators(mesh, geometry, connection, {.n = options.n, .kind = options.kind});
    frames = std::make_shared<const Frames<double>>(vertex_frames(mesh, V, connection));
    guidance = ComplexVectorX<double>::Zero(mesh.vertices());
    solver = make_linear_solver<C>({.name = options.solver});
    solver->analyse(A);
    refuse_singular();
  }

  void refuse_singular() {
    const char* const reason =
        "the design's system is singular: this connection has parallel fields (flat or trivial), so targets alone do "
        "not "
        "determine one; give a guidance weight";
    try {
      solver->factorise(A);
    } catch (const SolveError&) {
      throw SolveError(reason);
    }
    if (w > 0) return;
    // Inverse iteration finds the energy of the smoothest field well enough to tell nothing from something.
    MatrixX<C> x = MatrixX<C>::Ones(mesh.vertices(), 1), Mx(mesh.vertices(), 1);
    double energy = 0;
    for (int round = 0; round < 4; ++round) {
      hermitian_product(M, x.data(), Mx.data());
      const double size = x.col(0).dot(Mx.col(0)).real();
      Mx /= std::sqrt(size);
      (void)solver->solve(Mx, x);
      energy = 1 / std::sqrt(std::max(0.0, x.col(0).dot(M * x.col(0)).real()));
    }
    if (!(energy * geometry.total_area() > parallel)) throw SolveError(reason);
  }

  [[nodiscard]] Row point_row(const SurfacePoint& p) const {
    const kernels::TriangleFrame<double> frame = detail::triangle_frame(mesh, geometry, connection, p.face);
    const double b[3] = {p.barycentric[0], p.barycentric[1], p.barycentric[2]};
    const kernels::BasisAt<double> basis = kernels::basis_at(frame, b, double(options.n));
    Row row;
    for (Index c = 0; c < 3; ++c) {
      row.vertex[static_cast<std::size_t>(c)] = mesh.F()(p.face, c);
      row.coefficient[static_cast<std::size_t>(c)] = {basis.value[c].re, basis.value[c].im};
    }
    return row;
  }

  [[nodiscard]] Prepared prepare(const SingularityTarget& target) const {
    check_point(mesh, {target.face, target.pin.value_or(std::array<double, 3>{1, 0, 0})}, "face");
    if (target.sign != 1 && target.sign != -1)
      throw OptionError("sign", std::to_string(target.sign), "a target has index +1/n or -1/n");
    check_weight("strength", target.strength);
    if (!std::isfinite(target.orientation))
      throw OptionError("orientation", std::to_string(target.orientation), "must be finite");
    // Turning the pattern by beta turns (d, c) by (n-1) beta, s by (n+1) beta; a swirl angle (n = 1) is (d, c)'s own.
    const int turns = target.sign > 0 ? (options.n == 1 ? 1 : options.n - 1) : options.n + 1;
    const double flux = target.strength * target_flux * 2 * pi<double> * std::sqrt(geometry.area(target.face));
    const C density = std::polar(flux / geometry.area(target.face), turns * target.orientation);
    Prepared out{.face = target.face};
    const ComplexVectorX<double>& coefficients = target.sign > 0 ? operators.p : operators.q;
    for (Index c = 0; c < 3; ++c)
      out.load[static_cast<std::size_t>(c)] = std::conj(coefficients[3 * target.face + c]) * density;
    if (target.pin) out.rows.push_back(point_row({target.face, *target.pin}));
    return out;
  }

  [[nodiscard]] Prepared prepare(const VertexConstraint& constraint) const {
    const Index v = constraint.vertex;
    if (v < 0 || v >= mesh.vertices() || !mesh.referenced(v))
      throw OptionError("vertex", std::to_string(v), "must be a vertex that a face uses");
    if (!std::isfinite(constraint.value.real()) || !std::isfinite(constraint.value.imag()))
      throw OptionError("value", "not finite", "must be a finite complex number");
    Row row{.target = constraint.value};
    row.vertex.fill(v);
    row.coefficient[0] = 1;
    return {.rows = {row}};
  }

  [[nodiscard]] Prepared prepare_line(const Stroke& stroke) const {
    if (!stroke.points.empty())
      throw OptionError("points", std::to_string(stroke.points.size()) + " points", "a stroke has points or a line");
    check_weight("weight", stroke.weight);
    Prepared out;
    const double scale = stroke.weight * stroke_scale / std::sqrt(geometry.total_area());
    for (const SurfaceSegment& segment : stroke.line.segments) {
      const SurfacePoint middle{segment.face, segment.at(0.5)};
      check_point(mesh, middle, "line");
      check_weight("line", segment.length);
      Row row = point_row(middle);
      row.target = std::polar(1.0, options.n * std::arg(segment.tangent));
      row.weight = scale * segment.length;
      out.rows.push_back(row);
    }
    return out;
  }

  [[nodiscard]] Prepared prepare(const Stroke& stroke) const {
    if (!stroke.line.segments.empty()) return prepare_line(stroke);
    if (stroke.points.size() < 2)
      throw OptionError("points", std::to_string(stroke.points.size()) + " points", "a stroke has at least two");
    check_weight("weight", stroke.weight);
    std::vector<Eigen::RowVector3d> at;
    for (const SurfacePoint& p : stroke.points) {
      check_point(mesh, p, "points");
      Eigen::RowVector3d x = Eigen::RowVector3d::Zero();
      for (Index c = 0; c < 3; ++c) x += p.barycentric[static_cast<std::size_t>(c)] * V.row(mesh.F()(p.face, c));
      at.push_back(x);
    }
    Prepared out;
    const double scale = stroke.weight * stroke_scale / std::sqrt(geometry.total_area());
    for (std::size_t k = 0; k < at.size(); ++k) {
      Eigen::RowVector3d tangent = Eigen::RowVector3d::Zero();
      double length = 0;
      const auto segment = [&](const Eigen::RowVector3d& s) {
        length += s.norm() / 2;
        if (s.norm() > 0) tangent += s.normalized();
      };
      if (k > 0) segment(at[k] - at[k - 1]);
      if (k + 1 < at.size()) segment(at[k + 1] - at[k]);
      const Index t = stroke.points[k].face;
      const Eigen::RowVector3d a = V.row(mesh.F()(t, 0)), first = V.row(mesh.F()(t, 1)) - a;
      const Eigen::RowVector3d normal = first.cross(V.row(mesh.F()(t, 2)) - a).normalized(), x = first.normalized();
      const C direction(tangent.dot(x), tangent.dot(normal.cross(x)));
      if (!(std::abs(direction) > 1e-9) || !(length > 0)) continue;  // repeated points, a cusp: no tangent to follow
      Row row = point_row(stroke.points[k]);
      row.target = std::polar(1.0, options.n * std::arg(direction));
      row.weight = scale * length;
      out.rows.push_back(row);
    }
    if (out.rows.empty()) throw OptionError("points", "all at one place", "a stroke needs some length");
    return out;
  }

  [[nodiscard]] Prepared prepare(const Control& control) const {
    return std::visit([&](const auto& c) { return prepare(c); }, control);
  }

  // Whether strokes are cheaper inside the matrix, and the matrix as it should then be.
  void choose_folding() {
    std::size_t soft = 0;
    for (const auto& [id, p] : prepared)
      for (const Row& row : p.rows) soft += row.weight > 0;
    const bool fold = soft > static_cast<std::size_t>(options.largest_rank);
    if (!strokes_changed || (!fold && !is_folded())) return;
    strokes_changed = false;
    if (fold) {
      folded = A;
      for (const auto& [id, p] : prepared)
        for (const Row& row : p.rows)
          for (std::size_t i = 0; i < 3 && row.weight > 0; ++i)
            for (std::size_t j = 0; j < 3; ++j)
              folded.coeffRef(row.vertex[i], row.vertex[j]) +=
                  row.weight * std::conj(row.coefficient[i]) * row.coefficient[j];
    } else {
      folded.resize(0, 0);
    }
    solver->factorise(factorised());
    for (auto& [id, p] : prepared) p.columns.resize(0, 0);
  }

  [[nodiscard]] bool is_folded() const { return folded.rows() > 0; }
  [[nodiscard]] const SparseMatrix<C>& factorised() const { return is_folded() ? folded : A; }

  void solve_columns(Prepared& p) const {
    const auto rows = static_cast<Eigen::Index>(p.rows.size());
    if (p.columns.cols() == rows) return;
    MatrixX<C> B = MatrixX<C>::Zero(mesh.vertices(), rows);
    for (Eigen::Index k = 0; k < rows; ++k)
      for (std::size_t c = 0; c < 3; ++c)
        B(p.rows[static_cast<std::size_t>(k)].vertex[c], k) +=
            std::conj(p.rows[static_cast<std::size_t>(k)].coefficient[c]);
    p.columns.resize(mesh.vertices(), rows);
    (void)solver->solve(B, p.columns);
  }

  [[nodiscard]] bool is_update(const Row& row) const { return row.weight == 0 || !is_folded(); }

  // Right-hand side of targets, guidance and folded strokes.
  [[nodiscard]] MatrixX<C> right_hand_side() const {
    MatrixX<C> b = guidance;
    for (const auto& [id, p] : prepared) {
      if (p.face != none)
        for (Index c = 0; c < 3; ++c) b(mesh.F()(p.face, c), 0) += p.load[static_cast<std::size_t>(c)];
      for (const Row& row : p.rows)
        if (!is_update(row))
          for (std::size_t c = 0; c < 3; ++c)
            b(row.vertex[c], 0) += row.weight * std::conj(row.coefficient[c]) * row.target;
    }
    return b;
  }

  void apply_rows(DesignResult& result) {
    std::vector<const Row*> rows;
    for (auto& [id, p] : prepared) {
      if (p.rows.empty() || !is_update(p.rows.front())) continue;
      solve_columns(p);
      for (const Row& row : p.rows) rows.push_back(&row);
    }
    const auto count = static_cast<Eigen::Index>(rows.size());
    result.rows = static_cast<int>(count);
    if (count == 0) return;
    MatrixX<C> Y(mesh.vertices(), count);
    Eigen::Index at = 0;
    for (const auto& [id, p] : prepared)
      if (!p.rows.empty() && is_update(p.rows.front())) {
        Y.middleCols(at, p.columns.cols()) = p.columns;
        at += p.columns.cols();
      }
    MatrixX<C> G(count, count);
    ComplexVectorX<double> missing(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Row& row = *rows[static_cast<std::size_t>(i)];
      missing[i] = row.at(result.field.u) - row.target;
      for (Eigen::Index j = 0; j < count; ++j) {
        C sum = 0;
        for (std::size_t c = 0; c < 3; ++c) sum += row.coefficient[c] * Y(row.vertex[c], j);
        G(i, j) = sum;
      }
    }
    const double exact = exact_compliance * G.diagonal().cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < count; ++i) {
      const double weight = rows[static_cast<std::size_t>(i)]->weight;
      G(i, i) += weight > 0 ? 1 / weight : exact;
    }
    const ComplexVectorX<double> mu = G.ldlt().solve(missing);
    result.field.u.noalias() -= Y * mu;
  }

  [[nodiscard]] ControlReport judge(ControlId id, const Control& control, const std::vector<int>& indices,
                                    const ComplexVectorX<double>& u) const {
    ControlReport report{.id = id};
    const double degrees = 180 / pi<double>;
    if (const auto* target = std::get_if<SingularityTarget>(&control)) {
      const Index t = target->face;
      report.index = indices[static_cast<std::size_t>(t)];
      const ComplexVectorX<double>& coefficients = target->sign > 0 ? operators.p : operators.q;
      C value = 0;
      for (Index c = 0; c < 3; ++c) value += coefficients[3 * t + c] * u[mesh.F()(t, c)];
      const int turns = target->sign > 0 ? (options.n == 1 ? 1 : options.n - 1) : options.n + 1;
      report.error_degrees = std::abs(wrap(std::arg(value) - turns * target->orientation)) / turns * degrees;
      report.met = report.index == target->sign && report.error_degrees <= met_degrees;
    } else if (const auto* constraint = std::get_if<VertexConstraint>(&control)) {
      const C value = u[constraint->vertex];
      report.error_degrees = std::abs(wrap(std::arg(value) - std::arg(constraint->value))) / options.n * degrees;
      report.met =
          std::abs(value - constraint->value) <= 1e-6 * (std::abs(constraint->value) + u.cwiseAbs().maxCoeff());
    } else {
      const std::vector<Row>& rows = prepared.at(id).rows;
      double sum = 0, weights = 0;
      for (const Row& row : rows) {
        sum += row.weight * std::abs(wrap(std::arg(row.at(u)) - std::arg(row.target))) / options.n;
        weights += row.weight;
      }
      report.error_degrees = sum / weights * degrees;
      report.met = report.error_degrees <= 10;  // drawn to, not tied to: within ten degrees on average
    }
    return report;
  }
};

Designer::Designer(const Mesh& mesh, const Positions<double>& V, const Geometry<double>& geometry,
                   const Connection<double>& connection, const DesignerOptions& options)
    : state_(std::make_unique<State>(mesh, V, geometry, connection, options)) {}
Designer::~Designer() = default;
Designer::Designer(Designer&&) noexcept = default;
Designer& Designer::operator=(Designer&&) noexcept = default;

ControlId Designer::add(Control control) {
  Prepared prepared = state_->prepare(control);
  const ControlId id{state_->next_id++};
  state_->strokes_changed |= std::holds_alternative<Stroke>(control);
  state_->prepared.emplace(id, std::move(prepared));
  state_->controls.emplace(id, std::move(control));
  return id;
}

void Designer::set(ControlId id, Control control) {
  const auto old = state_->prepared.find(id);
  if (old == state_->prepared.end())
    throw OptionError("id", std::to_string(static_cast<int>(id)), "there is no such control");
  Prepared prepared = state_->prepare(control);
  // Rows that stay the same keep their solved columns: turning a pinned saddle costs a right-hand side.
  const auto same = [](const Row& a, const Row& b) { return a.vertex == b.vertex && a.coefficient == b.coefficient; };
  if (std::equal(prepared.rows.begin(), prepared.rows.end(), old->second.rows.begin(), old->second.rows.end(), same))
    prepared.columns = std::move(old->second.columns);
  old->second = std::move(prepared);
  state_->strokes_changed |=
      std::holds_alternative<Stroke>(control) || std::holds_alternative<Stroke>(state_->controls.at(id));
  state_->controls.at(id) = std::move(control);
}

void Designer::remove(ControlId id) {
  const auto at = state_->controls.find(id);
  if (at == state_->controls.end())
    throw OptionError("id", std::to_string(static_cast<int>(id)), "there is no such control");
  state_->strokes_changed |= std::holds_alternative<Stroke>(at->second);
  state_->controls.erase(at);
  state_->prepared.erase(id);
}

const std::map<ControlId, Control>& Designer::controls() const { return state_->controls; }

void Designer::set_guidance(const ComplexVectorX<double>& u0) {
  if (!(state_->w > 0)) throw OptionError("guidance_weight", "0", "a guidance field needs a weight");
  if (u0.size() != state_->mesh.vertices())
    throw OptionError("u0", std::to_string(u0.size()) + " values", "needs one per vertex");
  hermitian_product(state_->M, u0.data(), state_->guidance.data());
  state_->guidance *= state_->w;
}

DesignResult Designer::solve() {
  State& s = *state_;
  const auto start = std::chrono::steady_clock::now();
  if (s.controls.empty() && s.guidance.isZero(0))
    throw OptionError("controls", "none", "without targets, constraints, strokes or guidance the field is zero");
  s.choose_folding();
  DesignResult result;
  result.field.n = s.options.n;
  result.field.frames = s.frames;
  const MatrixX<C> b = s.right_hand_side();
  MatrixX<C> x(s.mesh.vertices(), 1);
  (void)s.solver->solve(b, x);
  result.residual = residual<C>(s.factorised(), x, b);
  result.field.u = x.col(0);
  s.apply_rows(result);
  const std::vector<int> indices = face_indices(s.mesh, s.connection, result.field);
  for (const auto& [id, control] : s.controls) result.controls.push_back(s.judge(id, control, indices, result.field.u));
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace alcap
