// SPDX-License-Identifier: MIT
//
// system.cpp: the matrix of a design, 2 S + w M and the strokes where that is cheaper than an update, its
// factorisation, and the right-hand side of the guidance.
#include <algorithm>
#include <cmath>

#include "src/base/array.h"
#include "src/base/parallel.h"
#include "src/design/tolerances.h"
#include "src/design/variational/free_fields.h"
#include "src/design/variational/state.h"
#include "src/design/weight_range.h"
#include "src/field/component_blocks.h"

namespace alcap {
namespace {

using C = Complex<double>;
using detail::ControlRow;
using detail::free_length;
using detail::parallel_energy;
using detail::probe_lift;

// Columns solved for at once, and between two looks at whether to go on.
constexpr Eigen::Index columns_at_once = 16;

}  // namespace

Designer::State::State(const ConnectedSurface& surface_, const DesignerOptions& options_)
    : surface(surface_),
      mesh(surface.mesh()),
      geometry(surface.geometry()),
      connection(surface.connection()),
      options(options_),
      pattern(mesh),
      loads({mesh, surface.V(), geometry, connection, operators, options.n, geometry.total_area()}) {
  validate();
  tell("assembly");
  StiffnessMass matrices = stiffness_and_mass(mesh, pattern, geometry, connection, options.n);
  M.swap(matrices.M);  // sparse matrices copy when they are moved
  S2.swap(matrices.S);
  apply_energy_family(mesh, pattern, geometry, connection, options.n, options.s, S2);
  check_t();
  S2 *= C(2);
  for (Index v = 0; v < mesh.vertices(); ++v)
    if (!mesh.referenced(v)) S2.valuePtr()[pattern.diagonal(v)] = 1;  // stays zero
  operators = first_order_operators(mesh, geometry, connection, {.n = options.n, .kind = options.kind});
  if (surface.in_space()) frames = surface.frames();
  guidance = ComplexVectorX<double>::Zero(mesh.vertices());
  solver = make_linear_solver<C>({.name = options.solver, .right_hand_sides = all_right_hand_sides()});
  solver->set_transport(M);
  tell("analyse");
  solver->analyse(S2);
  make_matrix(false);
  factorise();
}

void Designer::State::validate() const {
  if (options.n < 1) throw OptionError("n", options.n, "the degree of a field is at least 1");
  detail::check_tolerances(options.tolerances);
  check_guidance_weight(options.guidance_weight);
  if (options.t && !(std::abs(*options.t) <= detail::most_weight))
    throw OptionError("t", *options.t, "must be in [-1e12, 1e12]");
  if (options.t && options.guidance_weight > 0) throw OptionError("t", *options.t, "give either t or guidance_weight");
  if (!(options.s >= -1 && options.s <= 1)) throw OptionError("s", options.s, "must be in [-1, 1]");
  if (options.largest_rank < 0) throw OptionError("largest_rank", options.largest_rank, "must not be negative");
}

void Designer::State::check_guidance_weight(double weight) {
  if (!detail::fit_weight_or_zero(weight)) throw OptionError("guidance_weight", weight, detail::weight_or_zero_rule);
}

void Designer::State::check_t() const {
  if (!options.t || *options.t < 0) return;
  // Only whether lambda_1 lies above matters: a few digits do. Vertices that no face uses get an eigenvalue far
  // above.
  SparseMatrix<C> S, mass;  // assigned: Eigen's constructors leak where memory runs out in the middle of them
  S = S2;
  mass = M;
  const double tiny = 1e-6 * M.coeffs().cwiseAbs().maxCoeff();
  for (Index v = 0; v < mesh.vertices(); ++v)
    if (!mesh.referenced(v)) {
      S.valuePtr()[pattern.diagonal(v)] = 1;
      mass.valuePtr()[pattern.diagonal(v)] = tiny;
    }
  const EigenResult smallest = smallest_eigenpair(S, mass, geometry.total_area(), {.tolerance = 1e-6});
  const double limit = 2 * smallest.report.lambda / unit();
  if (!(*options.t < limit * (1 - 1e-6))) detail::throw_above_smallest(*options.t, limit);
}

void Designer::State::make_matrix(bool fold) {
  const detail::CarriedScope whole(nullptr);  // a matrix that is half of the old and half of the new is no use
  const double w = mass_weight();
  const SparseMatrix<C>& m = mass();
  if (A.rows() == 0) A = S2;
  parallel_for(A.nonZeros(), [&](std::int64_t k) { A.valuePtr()[k] = S2.valuePtr()[k] + w * m.valuePtr()[k]; });
  if (fold)
    for (const auto& [id, p] : prepared) {
      if (!p.load.soft()) continue;
      for (const ControlRow& row : p.load.rows)
        row.add_product(row.weight, [&](Index i, Index j, C value) { A.coeffRef(i, j) += value; });
    }
  folded = fold;
  soft_changed = false;
  if (singular) hold_kernel();
  forget();
}

double Designer::State::anchor() const {
  double sum = 0;
  for (Index v = 0; v < mesh.vertices(); ++v) sum += S2.valuePtr()[pattern.diagonal(v)].real();
  return sum / static_cast<double>(mesh.vertices());
}

void Designer::State::hold_kernel() {
  const double weight = anchor();
  for (const auto& [id, p] : prepared)
    for (const ControlRow& row : p.load.rows)
      if (!p.load.soft()) row.add_product(weight, [&](Index i, Index j, C value) { A.coeffRef(i, j) += value; });
  lift_parallel(A);
}

void Designer::State::lift_parallel(SparseMatrix<C>& matrix) const {
  // 2: something fixes the length of parallel fields as well; 1: their directions alone; 0: nothing.
  std::vector<char> touched(surface.topology().components.size(), 0);
  for (const auto& [id, p] : prepared)
    for (const ControlRow& row : p.load.rows) {
      char& mark = touched[static_cast<std::size_t>(
          surface.topology().vertex_component[static_cast<std::size_t>(row.vertex[0])])];
      mark = std::max(mark, row.direction_only ? char{1} : char{2});
    }
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const Index c = surface.topology().vertex_component[static_cast<std::size_t>(v)];
    if (c == none || touched[static_cast<std::size_t>(c)] == 2 || parallel[static_cast<std::size_t>(c)] == 0) continue;
    const double w = unit() * (touched[static_cast<std::size_t>(c)] == 1 ? free_length : 1);
    for (Index k = matrix.outerIndexPtr()[v]; k < matrix.outerIndexPtr()[v + 1]; ++k)
      matrix.valuePtr()[k] += w * M.valuePtr()[k];
  }
}

void Designer::State::forget() {
  stale = true;
  common.resize(0, 0);
  for (auto& [id, p] : prepared) {
    p.forget_rows();
    p.own.resize(0);
  }
}

void Designer::State::factorise() {
  if (!stale) return;
  tell("factorise");
  const bool bare = mass_weight() == 0 && !folded;
  try {
    solver->factorise(A);
    // Iterative backends only find out here.
    singular = singular || (bare && is_singular());
  } catch (const SolveError&) {
    if (!bare) throw;
    singular = true;
  }
  stale = bare && singular;
  if (stale) find_parallel();
}

bool Designer::State::is_singular() const {
  MatrixX<C> x = MatrixX<C>::Ones(mesh.vertices(), 1), Mx(mesh.vertices(), 1);
  double energy = 0;
  for (int round = 0; round < detail::singular_probes; ++round) {
    hermitian_product(M, x.data(), Mx.data());
    const double size = x.col(0).dot(Mx.col(0)).real();
    Mx /= std::sqrt(size);
    (void)solver->solve(Mx, x);
    energy = 1 / std::sqrt(std::max(0.0, x.col(0).dot(M * x.col(0)).real()));
  }
  return !(energy * geometry.total_area() > parallel_energy);
}

void Designer::State::find_parallel() {
  const Topology& topology = surface.topology();
  parallel.assign(topology.components.size(), 1);
  if (parallel.size() == 1) return;
  SparseMatrix<C> lifted;
  lifted = S2;
  for (Index k = 0; k < lifted.nonZeros(); ++k) lifted.valuePtr()[k] += probe_lift * unit() * M.valuePtr()[k];
  const auto probe = make_linear_solver<C>({.name = options.solver, .right_hand_sides = detail::singular_probes});
  probe->set_transport(M);
  probe->analyse(lifted);
  probe->factorise(lifted);
  const auto count = static_cast<Eigen::Index>(parallel.size());
  // Per component: x' M x.
  const auto sizes = [&](const MatrixX<C>& x) {
    MatrixX<C> Mx(mesh.vertices(), 1);
    hermitian_product(M, x.data(), Mx.data());
    VectorX<double> sum = VectorX<double>::Zero(count);
    for (Index v = 0; v < mesh.vertices(); ++v)
      if (const Index c = topology.vertex_component[detail::at(v)]; c != none)
        sum[c] += (std::conj(x(v, 0)) * Mx(v, 0)).real();
    return sum;
  };
  MatrixX<C> x = MatrixX<C>::Ones(mesh.vertices(), 1), Mx(mesh.vertices(), 1);
  VectorX<double> energy(count);
  for (int round = 0; round < detail::singular_probes; ++round) {
    const VectorX<double> size = sizes(x).cwiseSqrt();
    hermitian_product(M, x.data(), Mx.data());
    for (Index v = 0; v < mesh.vertices(); ++v)
      if (const Index c = topology.vertex_component[detail::at(v)]; c != none) Mx(v, 0) /= size[c];
    (void)probe->solve(Mx, x);
    energy = sizes(x).cwiseMax(0.0).cwiseSqrt().cwiseInverse();
  }
  const std::vector<double> areas = detail::areas_of_components(geometry, topology);
  for (std::size_t c = 0; c < parallel.size(); ++c) {
    const double own = energy[static_cast<Eigen::Index>(c)] - probe_lift * unit();
    parallel[c] = own * areas[c] > parallel_energy ? 0 : 1;  // also where nothing can be told
  }
}

void Designer::State::check_determined() const {
  const Topology& topology = surface.topology();
  std::vector<char> asked(parallel.size(), 0), held(parallel.size(), 0);
  for (const auto& [id, p] : prepared) {
    for (const auto& part : p.load.parts) asked[detail::at(topology.face_component[detail::at(part.face)])] = 1;
    for (const ControlRow& row : p.load.rows)
      held[detail::at(topology.vertex_component[detail::at(row.vertex[0])])] = 1;
  }
  for (std::size_t c = 0; c < parallel.size(); ++c)
    if (parallel[c] != 0 && asked[c] != 0 && held[c] == 0) detail::throw_undetermined(options.guidance_weight, c);
}

void Designer::State::make_guidance() {
  const detail::CarriedScope whole(nullptr);
  common.resize(0, 0);
  if (u0.size() == 0) return;
  hermitian_product(mass(), u0.data(), guidance.data());
  guidance *= guidance_scale();
}

void Designer::State::choose_folding() {
  if (singular) check_determined();
  if (singular && !folded) soft_changed = true;
  if (!soft_changed) return;
  std::size_t soft = 0;
  for (const auto& [id, p] : prepared) soft += p.load.soft() ? p.load.rows.size() : 0;
  const bool fold = singular || soft > static_cast<std::size_t>(options.largest_rank);
  if (fold || folded) make_matrix(fold);
  soft_changed = false;
}

void Designer::State::solve(const MatrixX<C>& B, MatrixX<C>& X, DesignResult& result) const {
  X.resize(B.rows(), B.cols());
  for (Eigen::Index from = 0; from < B.cols(); from += columns_at_once) {
    if (from > 0) tell("rows");
    const Eigen::Index count = std::min(columns_at_once, B.cols() - from);
    (void)solver->solve(B.middleCols(from, count), X.middleCols(from, count));
    result.solves += static_cast<int>(count);
  }
}

}  // namespace alcap
