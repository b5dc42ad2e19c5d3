// SPDX-License-Identifier: MIT
//
// Multigrid over several ranks on a square grid: levels move to fewer ranks as they become small, and solve as before.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "src/distributed/linear.h"
#include "src/distributed/multigrid.h"
#include "src/distributed/together.h"

using namespace alcap;
using namespace alcap::detail::distributed;

namespace {

constexpr PetscInt across = 110;

/// The five-point Laplacian of a grid of across x across points, plus 1e-4; rows are dealt out evenly.
alcap::detail::petsc::OwnedMat laplacian() {
  constexpr PetscInt all = across * across;
  const PetscInt first = all * rank() / ranks(), stop = all * (rank() + 1) / ranks();
  std::vector<PetscInt> start{0}, column;
  std::vector<PetscScalar> value;
  for (PetscInt i = first; i < stop; ++i) {
    const PetscInt x = i % across, y = i / across;
    const auto add = [&](bool there, PetscInt j, double a) {
      if (!there) return;
      column.push_back(j);
      value.emplace_back(a);
    };
    add(y > 0, i - across, -1);
    add(x > 0, i - 1, -1);
    add(true, i, 1e-4 + double((y > 0) + (x > 0) + (x + 1 < across) + (y + 1 < across)));
    add(x + 1 < across, i + 1, -1);
    add(y + 1 < across, i + across, -1);
    start.push_back(static_cast<PetscInt>(column.size()));
  }
  alcap::detail::petsc::OwnedMat A;
  check(MatCreateMPIAIJWithArrays(PETSC_COMM_WORLD, stop - first, stop - first, all, all, start.data(), column.data(),
                                  value.data(), A.out()));
  return A;
}

PetscInt rows_here(Mat A) {
  PetscInt rows = 0;
  check(MatGetLocalSize(A, &rows, nullptr));
  return rows;
}

}  // namespace

TEST_CASE("a level of fewer than a thousand rows per rank is shared by fewer ranks, evenly") {
  const Multigrid multigrid(laplacian(), nullptr);
  REQUIRE(multigrid.levels() >= 3);
  for (std::size_t l = 1; l < multigrid.levels(); ++l) {
    const std::int64_t here = rows_here(multigrid.matrix(l)), all = sum(here);
    const std::int64_t sharing = sum(std::int64_t{here > 0});
    CAPTURE(l);
    CAPTURE(all);
    CHECK(sharing == std::min(std::int64_t{ranks()}, std::max(std::int64_t{1}, all / 1000)));
    if (sharing < ranks() && here > 0) CHECK(std::abs(here - all / sharing) <= 1);
  }
  const std::int64_t coarsest = rows_here(multigrid.matrix(multigrid.levels() - 1));
  CHECK(sum(std::int64_t{coarsest > 0}) == 1);
}

TEST_CASE("systems are solved on any number of ranks in as many steps") {
  LinearSystem system(laplacian(), nullptr, 1e-10, 200);
  const PetscInt all = across * across, first = all * rank() / ranks();
  ComplexVectorX<double> x(all * (rank() + 1) / ranks() - first), b, found;
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = {std::sin(0.01 * double(first + i)), std::cos(double(first + i))};
  system.multiply(x, b);
  system.solve(b, found);
  CHECK(norm(found - x) < 1e-6 * norm(x));  // the condition number is 8e4
  CHECK(system.iterations() > 0);
  CHECK(system.iterations() <= 40);
}
