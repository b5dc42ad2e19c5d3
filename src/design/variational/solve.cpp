// SPDX-License-Identifier: MIT
//
// solve.cpp: a design's field by right-hand sides and low-rank rows, and how its controls were met.
//
// A row r_k u = t_k with compliance c_k (0: exact; 1/weight: soft, weight |r_k u - t_k|^2 in twice the energy) adds
// multipliers mu: A u + R' mu = b, R u - C mu = t. With Y = A^-1 R': (R Y + C) mu = R A^-1 b - t, u = A^-1 b - Y mu.
// Where the backend can, R Y comes from half solves, which are cheap for few rows close together, and A^-1 R' mu from
// one solve more, every time. The rows of pins and fixed vertices keep Y itself while there are few: turning a pinned
// singularity then solves nothing. Rows count twice, as real and imaginary part, so that rows which fix a direction
// only can stand among them.
#include <algorithm>
#include <cmath>

#include "alcap/singularities.h"
#include "src/design/feature_rows.h"
#include "src/design/variational/real_rows.h"
#include "src/design/variational/state.h"

namespace alcap {
namespace {

using C = Complex<double>;
using detail::ControlLoad;
using detail::ControlRow;
using detail::Prepared;

// So many controls of one row keep their column of Y, if it is one of a design that will be edited: at a million
// vertices they take 256 MB.
constexpr std::ptrdiff_t kept_columns = 16;

}  // namespace

void Designer::State::solve_rows(Prepared& p, DesignResult& result) const {
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
  if (!keeps_column(p)) {
    if (auto half = solver->half_solve(B)) {
      p.half = std::move(*half);
      return;
    }
  }
  MatrixX<C> X;
  solve(MatrixX<C>(B), X, result);
  p.columns = std::move(X);
}

bool Designer::State::keeps_column(const Prepared& p) const {
  const auto single = [](const auto& entry) { return entry.second.load.rows.size() == 1; };
  return options.right_hand_sides == 0 && p.load.rows.size() == 1 &&
         std::count_if(prepared.begin(), prepared.end(), single) <= kept_columns;
}

MatrixX<C> Designer::State::response(const Prepared& a, const Prepared& b) {
  if (b.columns.cols() == 0) return a.columns.cols() > 0 ? response(b, a).adjoint() : a.half.product(b.half);
  MatrixX<C> G(static_cast<Eigen::Index>(a.load.rows.size()), b.columns.cols());
  for (Eigen::Index j = 0; j < G.cols(); ++j)
    for (Eigen::Index i = 0; i < G.rows(); ++i) G(i, j) = a.load.rows[static_cast<std::size_t>(i)].at(b.columns.col(j));
  return G;
}

ComplexVectorX<double> Designer::State::common_load() const {
  ComplexVectorX<double> b = guidance;
  for (const auto& [id, p] : prepared) {
    if (p.load.target() && p.live_since == 0) add_target(p.load, p.load.density, b);
    if (!(p.load.soft() ? folded : singular)) continue;
    const double exact = p.load.soft() || p.load.rows.empty() ? 0 : anchor();
    for (const ControlRow& row : p.load.rows) {
      if (row.direction_only) continue;
      const double weight = p.load.soft() ? row.weight : exact;
      row.add_adjoint(weight * row.target, [&](Index v, C value) { b[v] += value; });
    }
  }
  return b;
}

ComplexVectorX<double> Designer::State::solve_loads(DesignResult& result) {
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
  return b;
}

std::vector<Designer::State::RowGroup> Designer::State::collect_rows(DesignResult& result) {
  std::vector<RowGroup> groups;
  Eigen::Index count = 0;
  for (auto& [id, p] : prepared) {
    if (!is_update(p)) continue;
    solve_rows(p, result);
    const auto rows = static_cast<Eigen::Index>(p.load.rows.size());
    groups.push_back({&p, count, rows});
    result.rows += static_cast<int>(rows);
    count += rows;
  }
  return groups;
}

ComplexVectorX<double> Designer::State::row_multipliers(const std::vector<RowGroup>& groups,
                                                        const ComplexVectorX<double>& u) const {
  const Eigen::Index count = groups.back().first + groups.back().count;
  const double kernel_weight = singular ? anchor() : 0;
  MatrixX<C> G(count, count);
  ComplexVectorX<double> values(count);
  std::vector<detail::RowFunctional> real;
  for (const RowGroup& a : groups) {
    for (const RowGroup& b : groups) G.block(a.first, b.first, a.count, b.count) = response(*a.owner, *b.owner);
    for (Eigen::Index k = 0; k < a.count; ++k) {
      const ControlRow& row = a.owner->load.rows[static_cast<std::size_t>(k)];
      values[a.first + k] = row.at(u);
      detail::append_real_rows(row, a.first + k, kernel_weight, real);
    }
  }
  return detail::complex_multipliers(real, detail::multipliers(real, G, values), count);
}

void Designer::State::apply_rows(const ComplexVectorX<double>& load, DesignResult& result) {
  const std::vector<RowGroup> groups = collect_rows(result);
  if (groups.empty()) {
    if (!load.isZero(0)) result.residual = residual<C>(A, result.field.u, load);
    return;
  }
  const ComplexVectorX<double> mu = row_multipliers(groups, result.field.u);
  ComplexVectorX<double> all = ComplexVectorX<double>::Zero(mesh.vertices());  // R' mu
  ComplexVectorX<double> push;                                                 // that of the controls without columns
  for (const RowGroup& group : groups) {
    const auto& rows = group.owner->load.rows;
    const auto sum = mu.segment(group.first, group.count);
    const auto add_to = [&](ComplexVectorX<double>& to) {
      for (std::size_t k = 0; k < rows.size(); ++k)
        rows[k].add_adjoint(sum[static_cast<Eigen::Index>(k)], [&](Index v, C value) { to[v] += value; });
    };
    add_to(all);
    if (group.owner->columns.cols() > 0) {
      result.field.u.noalias() -= group.owner->columns * sum;
      continue;
    }
    if (push.size() == 0) push = ComplexVectorX<double>::Zero(mesh.vertices());
    add_to(push);
  }
  if (push.size() > 0) {
    MatrixX<C> X;
    solve(push, X, result);
    result.field.u -= X.col(0);
  }
  // Of the whole system with its rows, A u + R' mu = b; that of the solution before them is in it. A product with A is
  // most of what turning a pinned singularity costs on large meshes.
  ComplexVectorX<double> rest(mesh.vertices());
  hermitian_product(A, result.field.u.data(), rest.data());
  rest += all - load;
  const double size = load.norm() + all.norm();
  if (size > 0) result.residual = rest.norm() / size;
}

ControlReport Designer::State::judge(ControlId id, const Control& control, const Field& field) const {
  const ComplexVectorX<double>& u = field.u;
  const ControlLoad& load = prepared.at(id).load;
  ControlReport report;
  if (const auto* target = std::get_if<SingularityTarget>(&control)) {
    report = detail::judge_target(mesh, connection, field, *target, load, options.tolerances);
  } else if (const auto* constraint = std::get_if<VertexConstraint>(&control)) {
    report =
        detail::judge_fixed(*constraint, options.n, u[constraint->vertex], u.cwiseAbs().maxCoeff(), options.tolerances);
  } else if (const auto* features = std::get_if<FeatureAlignment>(&control)) {
    report = detail::judge_features(surface, field, *features, options.tolerances);
  } else {
    detail::Deviation deviation;
    for (const ControlRow& row : load.rows) deviation.add(row, row.at(u), options.n);
    report = deviation.judge(std::holds_alternative<Stroke>(control) ? options.tolerances.stroke_degrees
                                                                     : options.tolerances.boundary_degrees);
  }
  report.id = id;
  return report;
}

}  // namespace alcap
