// SPDX-License-Identifier: MIT
//
// solve.cpp: small components each by one rank, with the library's own eigensolver; large ones by all ranks, one after
// the other.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "solvers/eigenpair/problem.h"
#include "solvers/linear/backends.h"
#include "src/base/array.h"
#include "src/distributed/eigen.h"

namespace alcap::detail::distributed {
namespace {

/// A report as bytes for all ranks.
struct PlainReport {
  int component, iterations, converged, smallest, has_next, has_bound;
  double lambda, residual, energy, next, bound, seconds, proof_seconds;
  std::array<char, 240> solver, note, message;
};

std::array<char, 240> plain_text(const std::string& text) {
  std::array<char, 240> out{};
  text.copy(out.data(), out.size() - 1);
  return out;
}

PlainReport plain(int component, const EigenReport& r) {
  return {component,
          r.iterations,
          r.converged ? 1 : 0,
          static_cast<int>(r.smallest),
          r.next ? 1 : 0,
          r.lower_bound ? 1 : 0,
          r.lambda,
          r.residual,
          r.energy_residual,
          r.next.value_or(0),
          r.lower_bound.value_or(0),
          r.seconds,
          r.proof_seconds,
          plain_text(r.solver),
          plain_text(r.smallest_note),
          plain_text(r.message)};
}

EigenReport report_of(const PlainReport& p) {
  EigenReport r;
  r.solver = p.solver.data();
  r.converged = p.converged != 0;
  r.iterations = p.iterations;
  r.lambda = p.lambda;
  if (p.has_next != 0) r.next = p.next;
  r.residual = p.residual;
  r.energy_residual = p.energy;
  r.smallest = static_cast<Smallest>(p.smallest);
  if (p.has_bound != 0) r.lower_bound = p.bound;
  r.smallest_note = p.note.data();
  r.seconds = p.seconds;
  r.proof_seconds = p.proof_seconds;
  r.message = p.message.data();
  return r;
}

/// A row of a component that this rank solves, wherever it is owned.
struct TakenRow {
  Index component, number;  // the user's
  PetscInt row;
  friend auto operator<=>(const TakenRow&, const TakenRow&) = default;
};

/// The small components' rows, each component at one rank: dealt out so that all get as many rows.
std::vector<TakenRow> take_rows(const Patch& patch, const Components& components, const petsc::OwnedMat& A,
                                const std::vector<char>& small) {
  std::vector<std::int64_t> load(at(ranks()), 0);
  std::vector<int> taker(components.list.size(), -1);
  for (std::size_t k = 0; k < taker.size(); ++k) {
    if (small[k] == 0) continue;
    taker[k] = static_cast<int>(std::ranges::min_element(load) - load.begin());
    load[at(taker[k])] += components.list[k].vertices;
  }
  std::vector<PetscInt> target(at(patch.owned), -1);
  std::vector<std::array<Index, 2>> names(at(patch.owned));
  for (Index v = 0; v < patch.owned; ++v) {
    const Index c = components.of_vertex[at(v)];
    names[at(v)] = {c, patch.vertex[at(v)]};
    if (c != none) target[at(v)] = taker[at(c)];
  }
  petsc::Owned<IS, ISDestroy> to, from;
  check(ISCreateGeneral(PETSC_COMM_WORLD, patch.owned, target.data(), PETSC_COPY_VALUES, to.out()));
  check(ISBuildTwoSided(to.get(), nullptr, from.out()));
  PetscInt size = 0;
  const PetscInt* row = nullptr;
  check(ISGetLocalSize(from.get(), &size));
  check(ISGetIndices(from.get(), &row));
  const std::vector<PetscInt> rows(row, row + size);
  check(ISRestoreIndices(from.get(), &row));
  const std::vector<std::array<Index, 2>> found = Exchange(patch.owned, nodes_of_rows(A.get(), rows)).fetch(names);
  std::vector<TakenRow> taken;
  for (std::size_t k = 0; k < rows.size(); ++k) taken.push_back({found[k][0], found[k][1], rows[k]});
  std::sort(taken.begin(), taken.end());
  return taken;
}

std::vector<PetscInt> row_numbers(const std::vector<TakenRow>& taken) {
  std::vector<PetscInt> rows;
  for (const TakenRow& t : taken) rows.push_back(t.row);
  return rows;
}

/// Rows [begin, end) of this rank's, which have no entries outside of these columns.
SparseMatrix<C> block_of(const LocalRows& rows, Index begin, Index end) {
  SparseMatrix<C> A(end - begin, end - begin);
  std::vector<Eigen::Triplet<C, Index>> entries;
  for (Index i = begin; i < end; ++i)
    for (PetscInt e = rows.own.start[i]; e < rows.own.start[i + 1]; ++e)
      entries.emplace_back(i - begin, rows.own.column[e] - begin, rows.own.value[e]);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

EigenOptions eigen_options(const DistributedOptions& options) {
  return {.tolerance = options.tolerance,
          .max_iterations = options.max_iterations,
          .seed = options.seed,
          .prove_smallest = options.prove_smallest};
}

/// Solves what this rank has taken; the values of its rows, and reports.
std::vector<PlainReport> solve_taken(const std::vector<TakenRow>& taken, Mat S, Mat M, const Components& components,
                                     const DistributedOptions& options, std::vector<C>& values) {
  std::vector<PlainReport> reports;
  const LocalRows s(S), m(M);
  values.resize(taken.size());
  for (std::size_t begin = 0, end = 0; begin < taken.size(); begin = end) {
    while (end < taken.size() && taken[end].component == taken[begin].component) ++end;
    const auto first = static_cast<Index>(begin), last = static_cast<Index>(end);
    const Index c = taken[begin].component;
    const EigenResult found = smallest_eigenpair(block_of(s, first, last), block_of(m, first, last),
                                                 components.list[at(c)].area, eigen_options(options));
    for (std::size_t k = begin; k < end; ++k) values[k] = found.u[static_cast<Eigen::Index>(k - begin)];
    reports.push_back(plain(c, found.report));
  }
  return reports;
}

void solve_small(const Patch& patch, const Matrices& matrices, Components& components,
                 const DistributedOptions& options, const std::vector<char>& small, ComplexVectorX<double>& u) {
  if (std::ranges::find(small, char{1}) == small.end()) return;
  const std::vector<TakenRow> taken = take_rows(patch, components, matrices.S, small);
  const std::vector<PetscInt> rows = row_numbers(taken);
  const petsc::OwnedMat S = principal_part(matrices.S, rows), M = principal_part(matrices.M, rows);
  std::vector<C> values;
  std::vector<PlainReport> reports;
  agreed([&] { reports = solve_taken(taken, S.get(), M.get(), components, options, values); });
  for (const PlainReport& p : gather_all(reports)) components.list[at(p.component)].eigen = report_of(p);
  Exchange(patch.owned, nodes_of_rows(matrices.S.get(), rows)).reduce(values.data(), u.data(), MPI_REPLACE);
}

/// The proof of one machine for component k, by a rank that gets its matrices and its vector; where it finds a smaller
/// eigenvalue it replaces the vector.
void prove_on_one_rank(const Patch& patch, const Matrices& matrices, Components& components, std::size_t k,
                       const DistributedOptions& options, ComplexVectorX<double>& u) {
  EigenReport& report = components.list[k].eigen;
  std::vector<char> chosen(components.list.size(), 0);
  chosen[k] = 1;
  const std::vector<TakenRow> taken = take_rows(patch, components, matrices.S, chosen);
  const std::vector<PetscInt> rows = row_numbers(taken);
  const petsc::OwnedMat S = principal_part(matrices.S, rows), M = principal_part(matrices.M, rows);
  const Exchange to_owners(patch.owned, nodes_of_rows(matrices.S.get(), rows));
  std::vector<C> values(taken.size());
  to_owners.fetch(u.data(), values.data());
  std::vector<PlainReport> reports;
  agreed([&] {
    if (taken.empty()) return;
    const LocalRows s(S.get()), m(M.get());
    const auto size = static_cast<Index>(taken.size());
    const SparseMatrix<C> here_S = block_of(s, 0, size), here_M = block_of(m, 0, size);
    const EigenProblem problem{.S = here_S,
                               .M = here_M,
                               .area = components.list[k].area,
                               .transport = same_pattern(here_S, here_M) ? &here_M : nullptr};
    EigenResult result{Eigen::Map<const ComplexVectorX<double>>(values.data(), size), report};
    prove_smallest(problem, eigen_options(options), true, result, {});
    for (Index i = 0; i < size; ++i) values[at(i)] = result.u[i];
    reports.push_back(plain(static_cast<int>(k), result.report));
  });
  const double seconds = report.seconds;
  report = report_of(gather_all(reports).at(0));
  report.seconds = seconds;
  to_owners.reduce(values.data(), u.data(), MPI_REPLACE);
}

/// The phase of EigenResult::u: the first entry, in the users' order, of the largest is real and positive.
void fix_phase_of(const std::vector<Index>& numbers, ComplexVectorX<double>& u) {
  constexpr double as_large = 1e-6;
  double most = 0;
  for (const C& z : u) most = std::max(most, std::abs(z));
  most = largest(most);
  struct First {
    Index number;
    double re, im;
  };
  std::vector<First> mine;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    if (std::abs(u[i]) < (1 - as_large) * most) continue;
    if (mine.empty() || numbers[at(i)] < mine[0].number) mine.assign(1, {numbers[at(i)], u[i].real(), u[i].imag()});
  }
  const std::vector<First> all = gather_all(mine);
  if (all.empty() || !(most > 0)) return;
  const First& first = *std::ranges::min_element(all, {}, &First::number);
  const C z(first.re, first.im);
  u *= std::conj(z) / std::abs(z);
}

void solve_large(const Patch& patch, const Matrices& matrices, Components& components, std::size_t k,
                 const DistributedOptions& options, ComplexVectorX<double>& u) {
  std::vector<PetscInt> rows;
  std::vector<Index> numbers, locals;
  for (Index v = 0; v < patch.owned; ++v) {
    if (components.of_vertex[at(v)] != static_cast<Index>(k)) continue;
    rows.push_back(patch.row[at(v)]);
    numbers.push_back(patch.vertex[at(v)]);
    locals.push_back(v);
  }
  DistributedComponent& component = components.list[k];
  ComplexVectorX<double> part;
  if (any(count_of(rows) != patch.owned)) {
    const petsc::OwnedMat S = principal_part(matrices.S, rows), M = principal_part(matrices.M, rows);
    component.eigen = smallest_together(S, M, component.area, numbers, options, part);
  } else {
    component.eigen = smallest_together(matrices.S, matrices.M, component.area, numbers, options, part);
  }
  for (std::size_t i = 0; i < locals.size(); ++i) u[locals[i]] = part[static_cast<Eigen::Index>(i)];
  if (component.eigen.converged && asks_for_proof(eigen_options(options), component.vertices)) {
    prove_on_one_rank(patch, matrices, components, k, options, u);
    for (std::size_t i = 0; i < locals.size(); ++i) part[static_cast<Eigen::Index>(i)] = u[locals[i]];
  } else {
    component.eigen.next.reset();
    component.eigen.smallest_note = !component.eigen.converged ? "the eigenpair did not converge"
                                    : options.prove_smallest == Prove::never
                                        ? "no proof was asked for"
                                        : "more than 200,000 vertices: DistributedOptions::prove_smallest asks for it";
  }
  fix_phase_of(numbers, part);
  for (std::size_t i = 0; i < locals.size(); ++i) u[locals[i]] = part[static_cast<Eigen::Index>(i)];
}

}  // namespace

ComplexVectorX<double> solve_components(const Patch& patch, const Matrices& matrices, Components& components,
                                        const DistributedOptions& options, const std::vector<char>& wanted) {
  ComplexVectorX<double> u = ComplexVectorX<double>::Zero(patch.owned);
  std::vector<char> small(components.list.size(), 0), large = small;
  for (std::size_t k = 0; k < small.size(); ++k)
    if (wanted.empty() || wanted[k] != 0) (components.list[k].vertices <= options.gather_below ? small : large)[k] = 1;
  solve_small(patch, matrices, components, options, small, u);
  for (std::size_t k = 0; k < large.size(); ++k)
    if (large[k] != 0) solve_large(patch, matrices, components, k, options, u);
  return u;
}

}  // namespace alcap::detail::distributed
