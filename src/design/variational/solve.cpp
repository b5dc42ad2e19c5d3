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
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "alcap/singularities.h"
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

// Exact rows get this compliance, relative to the others': rows that say the same twice stay solvable.
constexpr double exact_compliance = 1e-12;

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
      for (std::size_t c = 0; c < 3; ++c) b[row.vertex[c]] += weight * std::conj(row.coefficient[c]) * row.target;
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
    RowGroup group{&p, {}, count};
    for (std::size_t k = 0; k < p.load.rows.size(); ++k) {
      const ControlRow& row = p.load.rows[k];
      const auto number = static_cast<Eigen::Index>(k);
      if (row.direction_only) {
        const C along = std::conj(row.target) / std::abs(row.target);
        group.rows.push_back({&row, number, C(0, -1) * along, 0, 0});
        // The length is free: what hold_kernel() weighs it with goes again.
        if (singular) group.rows.push_back({&row, number, along, 0, -anchor()});
      } else {
        group.rows.push_back({&row, number, 1, row.target.real(), row.weight});
        group.rows.push_back({&row, number, C(0, -1), row.target.imag(), row.weight});
      }
    }
    result.rows += static_cast<int>(p.load.rows.size());
    count += static_cast<Eigen::Index>(group.rows.size());
    groups.push_back(std::move(group));
  }
  return groups;
}

VectorX<double> Designer::State::multipliers(const std::vector<RowGroup>& groups, const ComplexVectorX<double>& u) {
  const Eigen::Index count = groups.back().first + static_cast<Eigen::Index>(groups.back().rows.size());
  MatrixX<double> G = MatrixX<double>::Zero(count, count);
  VectorX<double> missing(count), compliance(count);
  for (const RowGroup& a : groups) {
    for (const RowGroup& b : groups) {
      const MatrixX<C> complex = response(*a.owner, *b.owner);
      for (std::size_t j = 0; j < b.rows.size(); ++j)
        for (std::size_t i = 0; i < a.rows.size(); ++i)
          G(a.first + static_cast<Eigen::Index>(i), b.first + static_cast<Eigen::Index>(j)) =
              (a.rows[i].factor * complex(a.rows[i].number, b.rows[j].number) * std::conj(b.rows[j].factor)).real();
    }
    for (std::size_t i = 0; i < a.rows.size(); ++i) {
      const RealRow& row = a.rows[i];
      const Eigen::Index at = a.first + static_cast<Eigen::Index>(i);
      missing[at] = (row.factor * row.row->at(u)).real() - row.target;
      compliance[at] = row.weight != 0 ? 1 / row.weight : 0;
    }
  }
  const double exact = exact_compliance * G.diagonal().cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < count; ++i) G(i, i) += compliance[i] != 0 ? compliance[i] : exact;
  return G.ldlt().solve(missing);
}

void Designer::State::apply_rows(const ComplexVectorX<double>& load, DesignResult& result) {
  const std::vector<RowGroup> groups = collect_rows(result);
  if (groups.empty()) {
    if (!load.isZero(0)) result.residual = residual<C>(A, result.field.u, load);
    return;
  }
  const VectorX<double> mu = multipliers(groups, result.field.u);
  ComplexVectorX<double> all = ComplexVectorX<double>::Zero(mesh.vertices());  // R' mu
  ComplexVectorX<double> push;                                                 // that of the controls without columns
  for (const RowGroup& group : groups) {
    const auto& rows = group.owner->load.rows;
    ComplexVectorX<double> sum = ComplexVectorX<double>::Zero(static_cast<Eigen::Index>(rows.size()));
    for (std::size_t i = 0; i < group.rows.size(); ++i)
      sum[group.rows[i].number] += mu[group.first + static_cast<Eigen::Index>(i)] * std::conj(group.rows[i].factor);
    const auto add_to = [&](ComplexVectorX<double>& to) {
      for (std::size_t k = 0; k < rows.size(); ++k)
        for (std::size_t c = 0; c < 3; ++c)
          to[rows[k].vertex[c]] += std::conj(rows[k].coefficient[c]) * sum[static_cast<Eigen::Index>(k)];
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
  ControlReport report{.id = id};
  const ControlLoad& load = prepared.at(id).load;
  const double degrees = 180 / pi<double>;
  if (const auto* target = std::get_if<SingularityTarget>(&control)) {
    C value = 0;
    bool all = true;
    for (const detail::TargetPart& part : load.parts) {
      const int index = face_index(mesh, connection, field, part.face);
      report.index += index;
      all = all && index == target->sign;
      C here = 0;
      for (Index c = 0; c < 3; ++c) here += part.coefficient[static_cast<std::size_t>(c)] * u[mesh.F()(part.face, c)];
      if (here != C(0)) value += here / std::abs(here);
    }
    const int turns = detail::target_turns(options.n, *target);
    report.error_degrees = std::abs(wrap(std::arg(value) - turns * target->orientation)) / std::abs(turns) * degrees;
    report.met = all && report.error_degrees <= target_met_degrees;
  } else if (const auto* constraint = std::get_if<VertexConstraint>(&control)) {
    const C value = u[constraint->vertex];
    const double size = std::abs(constraint->value) + u.cwiseAbs().maxCoeff();
    report.error_degrees = std::abs(wrap(std::arg(value) - std::arg(constraint->value))) / options.n * degrees;
    report.met = constraint->direction_only
                     ? std::abs(value) > 1e-9 * size && report.error_degrees <= target_met_degrees
                     : std::abs(value - constraint->value) <= 1e-6 * size;
  } else {
    double sum = 0, weights = 0;
    for (const ControlRow& row : load.rows) {
      sum += row.weight * std::abs(wrap(std::arg(row.at(u)) - std::arg(row.target))) / options.n;
      weights += row.weight;
    }
    report.error_degrees = sum / weights * degrees;
    report.met = report.error_degrees <= stroke_met_degrees;
  }
  return report;
}

}  // namespace alcap
