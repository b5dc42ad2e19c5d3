// SPDX-License-Identifier: MIT
#include "src/distributed/multigrid.h"

#include <algorithm>
#include <cmath>

#include "solvers/multigrid/hierarchy.h"
#include "src/base/array.h"

namespace alcap::detail::distributed {
namespace {

/// A level of so few rows is solved directly.
constexpr PetscInt coarsest_rows = 100;
/// Below so many rows per rank, fewer ranks share a level: a message takes as long as the work on some thousand rows.
constexpr std::int64_t least_rows = 1000;
/// Coarsening that keeps more than this part of the rows has come to its end.
constexpr double stalled = 0.8;
/// Of the smoothing of prolongations, as solvers/multigrid/prolongation.cpp: damping, and the least part of a diagonal
/// entry that weak couplings leave.
constexpr double omega = 0.75, least = 0.25;

/// What aggregation follows: A with couplings against the transports lumped into the diagonal.
struct Guide {
  std::vector<double> diagonal;        // of own rows
  std::vector<double> other_diagonal;  // of the columns of others
  std::vector<C> own, other;           // off-diagonal entries in the order of the arrays; zero where lumped
};

std::vector<double> values_of_others(Mat A, const LocalRows& rows, const std::vector<double>& own) {
  const std::vector<PetscInt> columns(rows.other_column, rows.other_column + rows.others);
  return Exchange(rows.rows, nodes_of_rows(A, columns)).fetch(own);
}

Guide make_guide(Mat A, Mat transport) {
  const LocalRows rows(A);
  const LocalRows turns(transport == nullptr ? A : transport);
  Guide g;
  g.diagonal.assign(at(rows.rows), 0);
  const auto follow = [&](const LocalRows::Part& part, const LocalRows::Part& turn, bool has_diagonal,
                          std::vector<C>& out) {
    out.assign(at(part.start[rows.rows]), 0);
    for (PetscInt i = 0; i < rows.rows; ++i)
      for (PetscInt e = part.start[i]; e < part.start[i + 1]; ++e) {
        const C a = part.value[e];
        if (has_diagonal && part.column[e] == i) {
          g.diagonal[at(i)] += a.real();
          continue;
        }
        out[at(e)] = a;
        if (transport == nullptr) continue;
        const C t = turn.value[e];
        const double against = a.real() * t.real() + a.imag() * t.imag();
        if (against < 0) continue;
        out[at(e)] = 0;
        if (against > 0) g.diagonal[at(i)] += against / std::abs(t);
      }
  };
  follow(rows.own, turns.own, true, g.own);
  follow(rows.other, turns.other, false, g.other);
  g.other_diagonal = values_of_others(A, rows, g.diagonal);
  return g;
}

bool strong_entry(C a, double d_i, double d_j) {
  constexpr double theta = 0.08;  // as strong() of solvers/multigrid/hierarchy.h
  return std::norm(a) > theta * theta * d_i * d_j;
}

/// The aggregates of this rank's rows.
Aggregates aggregate_here(const LocalRows& rows, const Guide& g) {
  alcap::detail::Level level;
  const auto n = static_cast<Index>(rows.rows);
  level.off.start = Buffer<std::int64_t>(std::int64_t{n} + 1);
  level.near = Buffer<float>(n);
  std::int64_t count = 0;
  for (Index i = 0; i < n; ++i) {
    level.near[i] = static_cast<float>(std::sqrt(g.diagonal[at(i)]));
    level.off.start[i] = count;
    for (PetscInt e = rows.own.start[i]; e < rows.own.start[i + 1]; ++e) count += rows.own.column[e] != i ? 1 : 0;
  }
  level.off.start[n] = count;
  level.off.column = Buffer<Index>(count);
  level.off.value = Buffer<ComplexF>(count);
  std::int64_t to = 0;
  for (Index i = 0; i < n; ++i)
    for (PetscInt e = rows.own.start[i]; e < rows.own.start[i + 1]; ++e) {
      const Index j = rows.own.column[e];
      if (j == i) continue;
      level.off.column[to] = j;
      level.off.value[to++] = ComplexF(g.own[at(e)] / std::sqrt(g.diagonal[at(i)] * g.diagonal[at(j)]));
    }
  return aggregate(level);
}

/// How many of a coarse level's rows this rank gets: those of its own aggregates, or an even share of all, on fewer
/// ranks, where the level is too small for all of them. Aggregates are numbered by ranks, so most stay near.
PetscInt share_of(std::int64_t all, std::int64_t own) {
  const std::int64_t sharing = std::max(std::int64_t{1}, all / least_rows);
  const std::int64_t P = ranks();
  if (sharing >= P) return static_cast<PetscInt>(own);
  const std::int64_t k = (rank() * sharing + P - 1) / P;  // the first share whose rank, k P / sharing, is not before us
  if (k >= sharing || k * P / sharing != rank()) return 0;
  return static_cast<PetscInt>(all * (k + 1) / sharing - all * k / sharing);
}

/// `columns` of the coarse level's rows will be on this rank.
petsc::OwnedMat tentative(const Aggregates& aggregates, PetscInt rows, PetscInt columns) {
  petsc::OwnedMat P;
  const auto first = static_cast<PetscInt>(sum_before(std::int64_t{aggregates.count}));
  std::vector<PetscInt> start{0}, column;
  std::vector<PetscScalar> value;
  for (PetscInt i = 0; i < rows; ++i) {
    if (aggregates.aggregate[i] != none) {
      column.push_back(first + aggregates.aggregate[i]);
      value.emplace_back(C(aggregates.transport[i]));
    }
    start.push_back(static_cast<PetscInt>(column.size()));
  }
  check(MatCreateMPIAIJWithArrays(PETSC_COMM_WORLD, rows, columns, PETSC_DETERMINE, PETSC_DETERMINE, start.data(),
                                  column.data(), value.data(), P.out()));
  return P;
}

/// I - omega D_F^-1 A_F, with A_F the strong entries of the guide (solvers/multigrid/prolongation.cpp).
petsc::OwnedMat smoother_of_prolongation(Mat A, const LocalRows& rows, const Guide& g) {
  std::vector<PetscInt> start{0}, column;
  std::vector<PetscScalar> value;
  std::vector<std::pair<PetscInt, C>> row;
  for (PetscInt i = 0; i < rows.rows; ++i) {
    const double d = g.diagonal[at(i)];
    double weak = 0;
    row.clear();
    const auto take = [&](C a, double d_j, PetscInt j) {
      if (strong_entry(a, d, d_j))
        row.emplace_back(j, a);
      else
        weak += std::abs(a);
    };
    for (PetscInt e = rows.own.start[i]; e < rows.own.start[i + 1]; ++e)
      if (rows.own.column[e] != i)
        take(g.own[at(e)], g.diagonal[at(rows.own.column[e])], rows.first + rows.own.column[e]);
    for (PetscInt e = rows.other.start[i]; e < rows.other.start[i + 1]; ++e)
      take(g.other[at(e)], g.other_diagonal[at(rows.other.column[e])], rows.other_column[rows.other.column[e]]);
    const double factor = -omega / std::max(d - weak, least * d);
    for (auto& entry : row) entry.second *= factor;
    row.emplace_back(rows.first + i, 1 - omega);
    std::ranges::sort(row, {}, &std::pair<PetscInt, C>::first);
    for (const auto& [j, a] : row) {
      column.push_back(j);
      value.push_back(a);
    }
    start.push_back(static_cast<PetscInt>(column.size()));
  }
  petsc::OwnedMat B;
  PetscInt columns = 0;
  check(MatGetLocalSize(A, nullptr, &columns));
  check(MatCreateMPIAIJWithArrays(PETSC_COMM_WORLD, rows.rows, columns, PETSC_DETERMINE, PETSC_DETERMINE, start.data(),
                                  column.data(), value.data(), B.out()));
  return B;
}

/// L U of the coarsest level. On the one rank that has it, as usual, or on every rank, if coarsening ended early.
/// PETSc's own also where there is only one rank: PCREDUNDANT would take MUMPS there, which never returns from solves
/// with systems that are singular up to rounding.
void factorise(KSP ksp, PC pc, Mat A) {
  PetscInt all = 0, own = 0;
  check(MatGetSize(A, &all, nullptr));
  check(MatGetLocalSize(A, &own, nullptr));
  if (any(own > 0 && own < all)) {
    check(PCSetType(pc, PCREDUNDANT));
    return;
  }
  KSP* blocks = nullptr;
  PC block = nullptr;
  check(PCSetType(pc, PCBJACOBI));
  check(KSPSetUp(ksp));
  check(PCBJacobiGetSubKSP(pc, nullptr, nullptr, &blocks));
  check(KSPSetType(blocks[0], KSPPREONLY));
  check(KSPGetPC(blocks[0], &block));
  check(PCSetType(block, PCLU));
}

}  // namespace

Multigrid::Multigrid(petsc::OwnedMat A, Mat transport) {
  levels_.emplace_back();
  levels_[0].A = std::move(A);
  for (;;) {
    Level& fine = levels_.back();
    PetscInt all = 0;
    check(MatGetSize(fine.A.get(), &all, nullptr));
    if (all <= coarsest_rows) return;
    const Guide guide = make_guide(fine.A.get(), levels_.size() == 1 ? transport : nullptr);
    const LocalRows rows(fine.A.get());
    Aggregates aggregates;
    agreed([&] {
      if (rows.rows > 0) aggregates = aggregate_here(rows, guide);
    });
    const std::int64_t coarse_rows = sum(std::int64_t{aggregates.count});
    if (coarse_rows == 0 || static_cast<double>(coarse_rows) > stalled * all) return;
    const petsc::OwnedMat P0 = tentative(aggregates, rows.rows, share_of(coarse_rows, aggregates.count));
    const petsc::OwnedMat B = smoother_of_prolongation(fine.A.get(), rows, guide);
    check(MatMatMult(B.get(), P0.get(), MAT_INITIAL_MATRIX, PETSC_DEFAULT, fine.P.out()));
    check(MatDuplicate(fine.P.get(), MAT_COPY_VALUES, fine.P_conj.out()));
    check(MatConjugate(fine.P_conj.get()));
    petsc::OwnedMat AP;
    Level coarse;
    check(MatMatMult(fine.A.get(), fine.P.get(), MAT_INITIAL_MATRIX, PETSC_DEFAULT, AP.out()));
    check(MatTransposeMatMult(fine.P_conj.get(), AP.get(), MAT_INITIAL_MATRIX, PETSC_DEFAULT, coarse.A.out()));
    check(MatSetOption(coarse.A.get(), MAT_HERMITIAN, PETSC_TRUE));
    levels_.push_back(std::move(coarse));
  }
}

void Multigrid::configure(PC pc) const {
  const auto count = static_cast<PetscInt>(levels_.size());
  check(PCSetType(pc, PCMG));
  check(PCMGSetLevels(pc, count, nullptr));
  check(PCMGSetGalerkin(pc, PC_MG_GALERKIN_NONE));
  check(PCMGSetCycleType(pc, PC_MG_CYCLE_W));
  for (PetscInt l = 0; l < count; ++l) {  // 0 is the coarsest for PETSc
    const Level& level = levels_[at(count - 1 - l)];
    KSP ksp = nullptr;
    PC inner = nullptr;
    check(PCMGGetSmoother(pc, l, &ksp));
    check(KSPSetOperators(ksp, level.A.get(), level.A.get()));
    check(KSPGetPC(ksp, &inner));
    if (l == 0) {
      check(KSPSetType(ksp, KSPPREONLY));
      factorise(ksp, inner, level.A.get());
      continue;
    }
    check(KSPSetType(ksp, KSPCHEBYSHEV));
    check(PCSetType(inner, PCJACOBI));
    check(KSPChebyshevEstEigSet(ksp, 0, 1.0 / 6, 0, 1.1));
    check(KSPSetTolerances(ksp, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, 2));
    check(KSPSetNormType(ksp, KSP_NORM_NONE));
    check(PCMGSetInterpolation(pc, l, level.P.get()));
    check(PCMGSetRestriction(pc, l, level.P_conj.get()));
  }
}

}  // namespace alcap::detail::distributed
