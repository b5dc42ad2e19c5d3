// SPDX-License-Identifier: MIT
//
// held.cpp: designs whose features hold directions. Thousands of vertices with one real unknown each, their length, are
// too many for rows: they are eliminated. u = T y + o over the reals, with two unknowns at vertices that are free, one
// where the direction is held, none where the value is known, and
//   T' A T y = T' (b - A o),
// A with every soft row in it. Pins stay rows, with multipliers. A length that comes out below `least_length`, or
// negative, which is another direction, is set to it, and the rest solved again: at most `most_rounds` times; a feature
// that then still turns over is judged as what it is, not met. Edits that leave T' A T as it was, such as turning a
// singularity, use its factorisation again.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <variant>

#include "alcap/assembly.h"
#include "solvers/dense/hermitian.h"
#include "src/design/variational/state.h"

namespace alcap {
namespace {

using C = Complex<double>;
using detail::ControlRow;

// Of a field along held features, which the weight of the features draws to 1.
constexpr double least_length = 0.1;
// Of setting lengths and solving again; CAD parts take one to three.
constexpr std::size_t most_rounds = 20;
// Factorisations that are kept for the next edit, those of the first rounds.
constexpr std::size_t kept_factors = 3;

/// What is known of the field at vertices.
struct HeldVertices {
  enum class Known : char { nothing, direction, feature, value };  // feature: a direction that must not turn over
  std::vector<Known> known;
  ComplexVectorX<double> at;  // a unit vector, or the value

  explicit HeldVertices(Index vertices)
      : known(static_cast<std::size_t>(vertices), Known::nothing), at(ComplexVectorX<double>::Zero(vertices)) {}

  void set(Index v, Known what, C value) {
    known[static_cast<std::size_t>(v)] = what;
    at[v] = value;
  }
  [[nodiscard]] Known of(Eigen::Index v) const { return known[static_cast<std::size_t>(v)]; }
};

/// u = T y + offset, real and imaginary parts interleaved.
struct HeldUnknowns {
  SparseMatrix<double> T;
  VectorX<double> offset;

  explicit HeldUnknowns(const HeldVertices& held) : offset(VectorX<double>::Zero(2 * held.at.size())) {
    using Known = HeldVertices::Known;
    std::vector<Eigen::Triplet<double, Index>> entries;
    Index next = 0;
    for (Index v = 0; v < held.at.size(); ++v) {
      const C d = held.at[v];
      if (held.of(v) == Known::nothing) {
        entries.emplace_back(2 * v, next++, 1.0);
        entries.emplace_back(2 * v + 1, next++, 1.0);
      } else if (held.of(v) == Known::value) {
        offset[2 * v] = d.real();
        offset[2 * v + 1] = d.imag();
      } else {
        entries.emplace_back(2 * v, next, d.real());
        entries.emplace_back(2 * v + 1, next++, d.imag());
      }
    }
    T.resize(offset.size(), next);
    T.setFromTriplets(entries.begin(), entries.end());
  }
};

VectorX<double> interleaved_parts(const ComplexVectorX<double>& u) {
  return Eigen::Map<const VectorX<double>>(reinterpret_cast<const double*>(u.data()), 2 * u.size());
}

/// Real and imaginary parts of every row.
SparseMatrix<double> parts_of_rows(const std::vector<ControlRow>& rows, Index vertices) {
  std::vector<Eigen::Triplet<double, Index>> entries;
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c) {
      const auto r = static_cast<Index>(2 * k);
      const Index v = rows[k].vertex[c];
      const C z = rows[k].coefficient[c];
      entries.emplace_back(r, 2 * v, z.real());
      entries.emplace_back(r, 2 * v + 1, -z.imag());
      entries.emplace_back(r + 1, 2 * v, z.imag());
      entries.emplace_back(r + 1, 2 * v + 1, z.real());
    }
  SparseMatrix<double> R(static_cast<Index>(2 * rows.size()), 2 * vertices);
  R.setFromTriplets(entries.begin(), entries.end());
  return R;
}

/// Sets the lengths along features that are too short; false where none is.
bool set_short_lengths(const ComplexVectorX<double>& u, HeldVertices& held) {
  bool any = false;
  for (Index v = 0; v < u.size(); ++v) {
    if (held.of(v) != HeldVertices::Known::feature) continue;
    if ((u[v] * std::conj(held.at[v])).real() >= least_length) continue;
    held.set(v, HeldVertices::Known::value, least_length * held.at[v]);
    any = true;
  }
  return any;
}

template <class T>
bool same_entries(const T* a, const T* b, Eigen::Index count) {
  return std::equal(a, a + count, b);
}

/// The solver of this matrix: factorised unless it already is.
const LinearSolver<double>& factor_of(detail::HeldFactor& kept, const SparseMatrix<double>& A,
                                      const std::string& solver_name) {
  const Eigen::Index entries = A.nonZeros();
  const bool same_pattern = kept.solver && A.rows() == kept.matrix.rows() && entries == kept.matrix.nonZeros() &&
                            same_entries(A.outerIndexPtr(), kept.matrix.outerIndexPtr(), A.outerSize() + 1) &&
                            same_entries(A.innerIndexPtr(), kept.matrix.innerIndexPtr(), entries);
  if (same_pattern && same_entries(A.valuePtr(), kept.matrix.valuePtr(), entries)) return *kept.solver;
  auto solver = same_pattern ? std::move(kept.solver) : make_linear_solver<double>({.name = solver_name});
  kept.solver = nullptr;  // nothing is kept if one of these throws
  if (!same_pattern) solver->analyse(A);
  solver->factorise(A);
  kept.matrix = A;
  kept.solver = std::move(solver);
  return *kept.solver;
}

/// The shortest x with A x = b, as far as there is one; A is symmetric and positive semidefinite.
VectorX<double> least_solution(const MatrixX<double>& A, const VectorX<double>& b) {
  const detail::Eigenpairs<double> pairs = detail::hermitian_eigenpairs<double>(A);
  const double rounding =
      static_cast<double>(A.rows()) * std::numeric_limits<double>::epsilon() * pairs.values.cwiseAbs().maxCoeff();
  VectorX<double> x = VectorX<double>::Zero(A.rows());
  for (Eigen::Index k = 0; k < A.rows(); ++k)
    if (pairs.values[k] > rounding) x += pairs.vectors.col(k).dot(b) / pairs.values[k] * pairs.vectors.col(k);
  return x;
}

/// min 1/2 u' A u - b' u with what is known, and with these rows at 0.
void solve_known(const SparseMatrix<double>& A, const VectorX<double>& b, const HeldVertices& held,
                 const std::vector<ControlRow>& rows, const std::string& solver_name, detail::HeldFactor& kept,
                 DesignResult& result) {
  const HeldUnknowns unknowns(held);
  const SparseMatrix<double>& T = unknowns.T;
  SparseMatrix<double> reduced, R;  // assigned: Eigen's constructors leak where memory runs out in the middle of them
  reduced = T.transpose() * A * T;
  const VectorX<double> rest = b - A * unknowns.offset, load = T.transpose() * rest;
  const LinearSolver<double>& solver = factor_of(kept, reduced, solver_name);
  MatrixX<double> y(load.size(), 1);
  (void)solver.solve(load, y);
  ++result.solves;
  VectorX<double> pull = VectorX<double>::Zero(load.size());  // of the multipliers
  if (!rows.empty()) {
    const SparseMatrix<double> all = parts_of_rows(rows, static_cast<Index>(held.at.size()));
    R = all * T;
    MatrixX<double> Rt = MatrixX<double>(R).transpose(), Y(Rt.rows(), Rt.cols());
    (void)solver.solve(Rt, Y);
    result.solves += static_cast<int>(Rt.cols());
    // Rows whose vertices are all known say nothing, or cannot be met.
    const VectorX<double> mu = least_solution(R * Y, R * y.col(0) + all * unknowns.offset);
    y.col(0) -= Y * mu;
    pull = Rt * mu;
  }
  const VectorX<double> u = T * y.col(0) + unknowns.offset;
  result.field.u = Eigen::Map<const ComplexVectorX<double>>(reinterpret_cast<const C*>(u.data()), held.at.size());
  const double size = load.norm() + pull.norm();
  result.residual = size > 0 ? (reduced * y.col(0) + pull - load).norm() / size : 0;
  result.solver = solver.name();
}

}  // namespace

bool Designer::State::holds_features() const {
  return std::any_of(prepared.begin(), prepared.end(),
                     [](const auto& entry) { return !entry.second.load.held.empty(); });
}

void Designer::State::solve_held(DesignResult& result) {
  if (singular) check_determined();
  tell("factorise");
  SparseMatrix<C> whole;  // assigned: Eigen's constructors leak where memory runs out in the middle of them
  whole = S2 + mass_weight() * mass();
  ComplexVectorX<double> b = guidance;
  HeldVertices held(mesh.vertices());
  std::vector<ControlRow> pins;
  using Known = HeldVertices::Known;
  for (const auto& [id, p] : prepared)
    for (const VertexConstraint& h : p.load.held) held.set(h.vertex, Known::feature, h.value);
  for (const auto& [id, p] : prepared) {
    if (p.load.target()) add_target(p.load, p.load.density, b);
    const auto* const fixed = std::get_if<VertexConstraint>(&controls.at(id));
    for (const ControlRow& row : p.load.rows) {
      if (fixed != nullptr) {
        const double length = fixed->direction_only ? std::abs(fixed->value) : 1;
        held.set(fixed->vertex, fixed->direction_only ? Known::direction : Known::value, fixed->value / length);
      } else if (row.weight > 0) {
        row.add_product(row.weight, [&](Index i, Index j, C value) { whole.coeffRef(i, j) += value; });
        row.add_adjoint(row.weight * row.target, [&](Index v, C value) { b[v] += value; });
      } else {
        pins.push_back(row);
      }
    }
  }
  if (singular) lift_parallel(whole);
  const SparseMatrix<double> matrix = real_view(whole);
  const VectorX<double> load = interleaved_parts(b);
  result.rows = static_cast<int>(pins.size());
  detail::HeldFactor last;  // of the rounds that are not kept
  for (std::size_t round = 0; round < most_rounds; ++round) {
    detail::check_cancelled();
    if (round < kept_factors && round == held_factors.size()) held_factors.emplace_back();
    solve_known(matrix, load, held, pins, options.solver, round < kept_factors ? held_factors[round] : last, result);
    if (!set_short_lengths(result.field.u, held)) return;
  }
}

}  // namespace alcap
