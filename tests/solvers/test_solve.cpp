// SPDX-License-Identifier: MIT
//
// Linear solvers and eigensolvers against known spectra, dense solvers and each other. The matrices are connection
// Laplacians of graphs, made here.
#include <doctest/doctest.h>

#include <algorithm>
#include <complex>
#include <string>
#include <thread>
#include <vector>

#include "alcap/memory.h"
#include "alcap/solve.h"
#include "src/base/parallel.h"
#include "src/base/random.h"
#include "tests/solvers/solver_fixture.h"

using namespace alcap;
using namespace alcap::test;

namespace {

Z turn(double angle) { return std::polar(1.0, angle); }

/// Graph Laplacian with transports: sum over edges of w |u_i - e^{i angle} u_j|^2.
class Builder {
 public:
  explicit Builder(Index rows) : rows_(rows) {}
  void edge(Index i, Index j, double weight, double angle) {
    add(i, i, weight);
    add(j, j, weight);
    add(i, j, -weight * turn(angle));
    add(j, i, -weight * turn(-angle));
  }
  void add(Index i, Index j, Z value) { entries_.emplace_back(i, j, value); }
  [[nodiscard]] Hermitian matrix() const {
    Hermitian A(rows_, rows_);
    A.setFromTriplets(entries_.begin(), entries_.end());
    return A;
  }

 private:
  Index rows_;
  std::vector<Eigen::Triplet<Z, Index>> entries_;
};

Hermitian identity(Index rows, double value = 1) {
  Hermitian I(rows, rows);
  I.setIdentity();
  return value * I;
}

/// N vertices in a ring whose transports sum to `flux`: eigenvalues 2 - 2 cos((2 pi k + flux) / N).
Hermitian ring(Index N, double flux, std::uint64_t seed) {
  detail::Random random(seed);
  std::vector<double> gauge(static_cast<std::size_t>(N));
  for (double& a : gauge) a = random.uniform(-pi<double>, pi<double>);
  Builder b(N);
  for (Index i = 0; i < N; ++i) {
    const Index j = (i + 1) % N;
    b.edge(i, j, 1, flux / N + gauge[static_cast<std::size_t>(i)] - gauge[static_cast<std::size_t>(j)]);
  }
  return b.matrix();
}

/// nx by ny torus grid with random weights; transports sum to flux / faces around each square, so that a flux of 0 has
/// the eigenvalue 0 in a random gauge.
Hermitian torus_grid(Index nx, Index ny, double field, std::uint64_t seed) {
  detail::Random random(seed);
  std::vector<double> gauge(static_cast<std::size_t>(nx * ny));
  for (double& a : gauge) a = random.uniform(-pi<double>, pi<double>);
  const auto at = [=](Index x, Index y) { return (x % nx) * ny + y % ny; };
  Builder b(nx * ny);
  const auto link = [&](Index i, Index j, double angle) {
    b.edge(i, j, random.uniform(0.5, 2),
           angle + gauge[static_cast<std::size_t>(i)] - gauge[static_cast<std::size_t>(j)]);
  };
  for (Index x = 0; x < nx; ++x)
    for (Index y = 0; y < ny; ++y) {
      link(at(x, y), at(x, y + 1), field * x);
      link(at(x, y), at(x + 1, y), 0);
    }
  return b.matrix();
}

/// A positive definite mass matrix with the pattern of A.
Hermitian consistent_mass(const Hermitian& A) {
  Hermitian M = A;
  for (Index j = 0; j < M.cols(); ++j)
    for (Hermitian::InnerIterator it(M, j); it; ++it)
      it.valueRef() = it.row() == j ? Z(1.0) : -0.1 * it.value() / std::abs(it.value());
  return M;
}

SolverOptions backend(const std::string& name) { return {.name = name, .tolerance = 1e-13}; }

/// Backends that see every pivot, and so what is wrong with a matrix.
std::vector<std::string> direct_solvers() {
  std::vector<std::string> names = linear_solvers();
  std::erase(names, "multigrid");
  std::erase(names, "eigen-cg");
  return names;
}

Dense solve(const std::string& name, const Hermitian& A, const Dense& B) {
  auto solver = make_linear_solver<Z>(backend(name));
  solver->analyse(A);
  solver->factorise(A);
  Dense X(B.rows(), B.cols());
  CHECK(solver->solve(B, X).converged);
  return X;
}

}  // namespace

TEST_CASE("every backend finds the solution it is given, one or many right-hand sides") {
  const Hermitian A = torus_grid(23, 17, 0.3, 1) + identity(23 * 17, 0.01);
  const Dense X = random_dense(A.rows(), 5, 2);
  const Dense B = A * X;
  for (const std::string& name : linear_solvers()) {
    CAPTURE(name);
    const Dense all = solve(name, A, B);
    CHECK((all - X).norm() <= 1e-10 * X.norm());
    CHECK(residual<Z>(A, all, B) <= 1e-12);
    for (Eigen::Index c = 0; c < B.cols(); ++c)
      CHECK((solve(name, A, B.col(c)) - all.col(c)).norm() <= 1e-12 * X.norm());
  }
}

TEST_CASE("backends solve in place of strided blocks and for no right-hand side at all") {
  const Hermitian A = ring(30, 1, 3) + identity(30);
  for (const std::string& name : linear_solvers()) {
    CAPTURE(name);
    auto solver = make_linear_solver<Z>(backend(name));
    solver->analyse(A);
    solver->factorise(A);
    const Dense X = random_dense(30, 2, 4);
    Dense big_b = Dense::Zero(40, 2);
    big_b.middleRows(3, 30) = A * X;
    Dense big_x = Dense::Constant(40, 2, Z(7));
    solver->solve(big_b.middleRows(3, 30), big_x.middleRows(3, 30));
    CHECK((big_x.middleRows(3, 30) - X).norm() <= 1e-10 * X.norm());
    CHECK((big_x.topRows(3).array() == Z(7)).all());
    CHECK((big_x.bottomRows(7).array() == Z(7)).all());
    Dense none_x(30, 0);
    CHECK(solver->solve(Dense(30, 0), none_x).converged);
    Dense short_x(29, 1);
    CHECK_THROWS_AS(solver->solve(X.leftCols(1), short_x), SolveError);
  }
}

TEST_CASE("real symmetric systems") {
  Builder b(400);
  detail::Random random(5);
  for (Index i = 0; i < 400; ++i)
    b.edge(i, (i + 1 + static_cast<Index>(random.below(398))) % 400, random.uniform(0.1, 3), 0);
  const SparseMatrix<double> A = SparseMatrix<double>(b.matrix().real()) + SparseMatrix<double>(identity(400).real());
  const MatrixX<double> X = random_dense(400, 3, 6).real();
  for (const std::string& name : linear_solvers()) {
    CAPTURE(name);
    auto solver = make_linear_solver<double>(backend(name));
    solver->analyse(A);
    solver->factorise(A);
    MatrixX<double> Y(400, 3);
    solver->solve(A * X, Y);
    CHECK((Y - X).norm() <= 1e-10 * X.norm());
  }
}

TEST_CASE("one analysis serves any values, and only its pattern") {
  Hermitian A = torus_grid(12, 12, 0.2, 7) + identity(144);
  for (const std::string& name : linear_solvers()) {
    CAPTURE(name);
    auto solver = make_linear_solver<Z>(backend(name));
    Dense X(144, 1);
    CHECK_THROWS_AS(solver->factorise(A), SolveError);
    solver->analyse(A);
    CHECK_THROWS_AS(solver->solve(X, X), SolveError);
    for (const double field : {0.1, 0.9}) {
      const Hermitian other = torus_grid(12, 12, field, 8) + identity(144);
      solver->factorise(other);
      const Dense B = random_dense(144, 1, 9);
      solver->solve(B, X);
      CHECK(residual<Z>(other, X, B) <= 1e-12);
    }
    CHECK_THROWS_AS(solver->factorise(identity(144)), SolveError);
    CHECK_THROWS_AS(solver->analyse(Hermitian(3, 4)), SolveError);
  }
}

TEST_CASE("indefinite and singular matrices are refused, and the message says so") {
  const Index n = 60;
  Hermitian indefinite = ring(n, 1, 10) + identity(n);
  indefinite.coeffRef(17, 17) = -5;
  for (const std::string& name : direct_solvers()) {
    CAPTURE(name);
    auto solver = make_linear_solver<Z>(backend(name));
    for (const Hermitian& A : {indefinite, Hermitian(ring(n, 0, 11)), Hermitian(torus_grid(30, 30, 0, 12))}) {
      solver->analyse(A);
      try {
        solver->factorise(A);
        FAIL("no error");
      } catch (const SolveError& e) {
        const std::string what = e.what();
        const bool singular = what.find("singular") != std::string::npos;
        CHECK((singular || what.find("not positive definite") != std::string::npos));
      }
      Dense X(A.rows(), 1);
      CHECK_THROWS_AS(solver->solve(X, X), SolveError);
    }
  }
}

TEST_CASE("conjugate gradients: what they cannot do is said, and so is what they used instead") {
  const Hermitian A = torus_grid(40, 40, 0.2, 3) + identity(1600, 1e-4);
  const Dense B = random_dense(1600, 1, 4);
  Dense X(1600, 1);
  auto limited = make_linear_solver<Z>({.name = "eigen-cg", .tolerance = 1e-12, .max_iterations = 3});
  limited->analyse(A);
  limited->factorise(A);
  const SolveReport stopped = limited->solve(B, X);
  CHECK(!stopped.converged);
  CHECK(stopped.iterations == 3);
  CHECK(stopped.residual > 1e-12);
  CHECK(stopped.residual == doctest::Approx(residual<Z>(A, X, B)).epsilon(1e-6));

  // More couplings than the diagonal holds against: the incomplete factorisation raises it ten times and gives up.
  Hermitian hard = Hermitian(5, 5);
  for (Index i = 0; i < 5; ++i)
    for (Index j = 0; j < 5; ++j) hard.insert(i, j) = i == j ? 1.0 : -1e4;
  auto solver = make_linear_solver<Z>({.name = "eigen-cg"});
  solver->analyse(hard);
  solver->factorise(hard);
  CHECK(solver->name() == "eigen-cg (diagonal)");
  solver->analyse(A);
  solver->factorise(A);
  CHECK(solver->name() == "eigen-cg (incomplete Cholesky)");
  const SolveReport report = solver->solve(B, X);
  CHECK(report.converged);
  CHECK(report.solver == solver->name());
  CHECK(residual<Z>(A, X, B) <= 1e-10);

  Hermitian negative = A;
  negative.coeffRef(7, 7) = -1;
  CHECK_THROWS_AS(solver->factorise(negative), SolveError);
  CHECK_THROWS_AS(static_cast<void>(solver->solve(B, X)), SolveError);
  // Positive diagonal, indefinite all the same.
  const Hermitian indefinite = A - identity(1600, 2);
  solver->factorise(indefinite);
  bool refused = false;
  try {
    refused = !solver->solve(B, X).converged;
  } catch (const SolveError&) {
    refused = true;
  }
  CHECK(refused);
}

TEST_CASE("a matrix of another pattern than the one analysed is refused, also with as many entries") {
  const Index N = 30;
  const Hermitian A = ring(N, 1, 3) + identity(N, 0.1);
  Builder b(N);
  for (Index i = 0; i < N; ++i) b.edge(i, (i + 2) % N, 1, 0);
  const Hermitian other = b.matrix() + identity(N, 0.1);
  REQUIRE(other.nonZeros() == A.nonZeros());
  for (const std::string& name : linear_solvers()) {
    CAPTURE(name);
    const auto solver = make_linear_solver<Z>({.name = name});
    solver->analyse(A);
    CHECK_THROWS_AS(solver->factorise(other), SolveError);
    solver->factorise(A);
    const Dense B = random_dense(N, 1, 1);
    Dense X(N, 1);
    CHECK(solver->solve(B, X).converged);
    CHECK(residual<Z>(A, X, B) <= 1e-9);
    Hermitian loose = A;
    loose.uncompress();
    CHECK_NOTHROW(solver->factorise(loose));
  }
}

TEST_CASE("unknown names are refused with the list of known ones") {
  for (const std::string& name : linear_solvers()) {
    CAPTURE(name);
    try {
      static_cast<void>(make_linear_solver<Z>({.name = "cholesky"}));
      FAIL("no error");
    } catch (const OptionError& e) {
      CHECK(std::string(e.what()).find(name) != std::string::npos);
      CHECK(e.field() == "name");
    }
  }
  const Hermitian I = identity(2);
  CHECK_THROWS_AS(static_cast<void>(smallest_eigenpair(I, I, 1, {.solver = "x"})), OptionError);
  CHECK_THROWS_AS(static_cast<void>(smallest_eigenpair(I, I, 1, {.method = "x"})), OptionError);
  CHECK_THROWS_AS(static_cast<void>(smallest_eigenpair(I, I, 0)), OptionError);
  CHECK_THROWS_AS(static_cast<void>(smallest_eigenpair(I, I, 1, {.tolerance = 0})), OptionError);
  CHECK_THROWS_AS(static_cast<void>(make_linear_solver<Z>({.max_iterations = 0})), OptionError);
  CHECK_THROWS_AS(static_cast<void>(make_linear_solver<Z>({.right_hand_sides = -1})), OptionError);
}

TEST_CASE("auto: multigrid for a few solves of a large system, a factorisation otherwise") {
  const Problem large = problem_of(icosphere(5), 4), small = problem_of(icosphere(3), 4);
  REQUIRE(large.S.rows() >= 10'000);
  const auto chosen = [](const Problem& p, int right_hand_sides) {
    const Hermitian A = p.shifted();
    const auto solver = make_linear_solver<Z>({.right_hand_sides = right_hand_sides});
    CHECK(solver->name() == "auto");
    solver->set_transport(p.M);
    solver->analyse(A);
    solver->factorise(A);
    const Dense b = random_dense(A.rows(), 2, 1);
    Dense x(b.rows(), b.cols());
    const SolveReport report = solver->solve(b, x);
    CHECK(report.converged);
    CHECK(residual<Z>(A, x, b) <= 1e-10);
    CHECK(report.solver.find(solver->name()) == 0);
    return solver->name();
  };
  const auto factorisation = [](const std::string& name) { return name != "multigrid" && name != "auto"; };
  CHECK(chosen(large, 2) == "multigrid");
  CHECK(factorisation(chosen(large, 0)));
  CHECK(factorisation(chosen(large, 100)));
  CHECK(factorisation(chosen(small, 2)));
  // One solver for a small matrix and then a large one.
  const auto solver = make_linear_solver<Z>({.right_hand_sides = 2});
  solver->analyse(small.shifted());
  CHECK(factorisation(solver->name()));
  solver->set_transport(small.M);
  solver->analyse(large.shifted());
  CHECK(solver->name() == "multigrid");
  CHECK_THROWS_AS(solver->factorise(large.shifted()), SolveError);  // of another pattern: it did get there
  solver->set_transport(large.M);
  solver->factorise(large.shifted());
  const Dense b = random_dense(large.S.rows(), 1, 1);
  Dense x(b.rows(), 1);
  CHECK(solver->solve(b, x).converged);
  CHECK_THROWS_AS(static_cast<void>(make_linear_solver<Z>()->solve(x, x)), SolveError);
}

TEST_CASE("one solver serves several threads, several solvers do not disturb each other") {
  const Hermitian A = torus_grid(40, 31, 0.1, 13) + identity(40 * 31, 0.1);
  const Dense B = random_dense(A.rows(), 3, 14);
  for (const std::string& name : linear_solvers()) {
    CAPTURE(name);
    const Dense expected = solve(name, A, B);
    auto shared = make_linear_solver<Z>(backend(name));
    shared->analyse(A);
    shared->factorise(A);
    std::vector<Dense> X(4, Dense(B.rows(), B.cols()));
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&, t] {
        for (int repeat = 0; repeat < 5; ++repeat) {
          if (t < 2) {
            shared->solve(B, X[static_cast<std::size_t>(t)]);
          } else {
            auto own = make_linear_solver<Z>(backend(name));
            own->analyse(A);
            own->factorise(A);
            own->solve(B, X[static_cast<std::size_t>(t)]);
          }
        }
      });
    }
    for (std::thread& t : threads) t.join();
    for (const Dense& x : X) CHECK((x - expected).norm() <= 1e-12 * expected.norm());
  }
}

TEST_CASE("the Hermitian product agrees with Eigen's and does not depend on threads") {
  const Hermitian A = torus_grid(90, 80, 0.7, 15);
  const ComplexVectorX<double> x = random_dense(A.rows(), 1, 16);
  ComplexVectorX<double> y(x.size());
  ComplexVectorX<double> one(x.size());
  hermitian_product(A, x.data(), y.data());
  run_with_threads(1, [&] { hermitian_product(A, x.data(), one.data()); });
  CHECK((y - A * x).norm() <= 1e-14 * y.norm());
  CHECK(y == one);
  Hermitian loose = A;
  loose.reserve(VectorX<Index>::Constant(A.cols(), 3));
  REQUIRE(!loose.isCompressed());
  hermitian_product(loose, x.data(), one.data());
  CHECK(y == one);
}

TEST_CASE("half solves: their products are B' A^-1 C, for backends that have them") {
  const Index rows = 30 * 20;
  const Hermitian A = Hermitian(torus_grid(30, 20, 0.1, 3) + identity(rows, 0.1));
  detail::Random random(4);
  const auto sparse = [&](Index from, Index columns) {
    Hermitian B(rows, columns);
    for (Index c = 0; c < columns; ++c)
      for (Index k = 0; k < 3; ++k)
        B.coeffRef((from + 5 * c + k) % rows, c) += Z(random.uniform(-1, 1), random.uniform(-1, 1));
    return B;
  };
  const Hermitian B = sparse(17, 12), C = sparse(300, 5);
  int able = 0;
  for (const std::string& name : linear_solvers()) {
    CAPTURE(name);
    const auto solver = make_linear_solver<Z>({.name = name});
    solver->analyse(A);
    solver->factorise(A);
    const auto b = solver->half_solve(B), c = solver->half_solve(C);
    CHECK(b.has_value() == c.has_value());
    if (!b) continue;
    ++able;
    Dense X(rows, 5);
    (void)solver->solve(Dense(C), X);
    const Dense expected = Dense(B).adjoint() * X;
    CHECK((b->product(*c) - expected).norm() < 1e-12 * expected.norm());
    CHECK((c->product(*b) - expected.adjoint()).norm() < 1e-12 * expected.norm());
    CHECK((b->product(*b) - b->values.adjoint() * b->values).norm() < 1e-14 * b->values.squaredNorm());
    CHECK(b->rows.size() < static_cast<std::size_t>(rows));
    CHECK_THROWS_AS((void)solver->half_solve(Hermitian(3, 1)), SolveError);
  }
  const std::vector<std::string> names = linear_solvers();
  if (std::find(names.begin(), names.end(), "cholmod") != names.end()) CHECK(able == 3);
}

TEST_CASE("residual of a wrong solution is what it is") {
  const Hermitian A = identity(3, 2);
  const Dense B = Dense::Constant(3, 2, Z(1));
  Dense X = Dense::Constant(3, 2, Z(0.5));
  CHECK(residual<Z>(A, X, B) == 0);
  X.col(1).setConstant(Z(0, 0.5));
  CHECK(residual<Z>(A, X, B) == doctest::Approx(std::sqrt(2.0)));
}

TEST_CASE("S and M of different patterns with as many entries") {
  // Neighbours in S, next but one in M: every column has three entries.
  const Index N = 60;
  const Hermitian S = ring(N, 1, 3);
  Builder b(N);
  for (Index i = 0; i < N; ++i) {
    b.add(i, i, 1);
    b.add(i, (i + 2) % N, 0.1);
    b.add((i + 2) % N, i, 0.1);
  }
  const Hermitian M = b.matrix();
  REQUIRE(M.nonZeros() == S.nonZeros());
  const double lambda = dense_spectrum(S, M)[0];
  for (const std::string& solver : linear_solvers()) {
    for (const char* method : {"lanczos", "inverse-iteration", "lobpcg"}) {
      CAPTURE(solver);
      CAPTURE(method);
      const EigenResult r = smallest_eigenpair(S, M, N * N, {.solver = solver, .method = method});
      CHECK(r.report.converged);
      CHECK(std::abs(r.report.lambda - lambda) <= 1e-8);
    }
  }
}

TEST_CASE("ring with flux: the known spectrum, for every method and backend") {
  for (const Index N : {1, 2, 3, 7, 60, 500}) {
    for (const double flux : {0.0, 1.0, pi<double>}) {
      if (N < 3 && flux != 0) continue;  // double edges and loops: other formulas
      CAPTURE(N);
      CAPTURE(flux);
      const Hermitian S = N < 3 ? identity(N) : ring(N, flux, 17);
      const Hermitian M = identity(N);
      const double lambda = N < 3 ? 1 : 2 - 2 * std::cos(flux / N);
      const double next = N == 1 ? lambda : N == 2 ? 1 : 2 - 2 * std::cos((2 * pi<double> - flux) / N);
      for (const std::string& solver : linear_solvers()) {
        for (const std::string& method : eigen_solvers()) {
          CAPTURE(solver);
          CAPTURE(method);
          if (method == "dense" && N > 100) continue;  // its rounding grows with the norm of S
          // The scale of a ring's eigenvalues is (2 pi / N)^2: an "area" of N^2.
          const double area = static_cast<double>(N) * N;
          const EigenResult r = smallest_eigenpair(S, M, area, {.tolerance = 1e-9, .solver = solver, .method = method});
          CHECK(r.report.converged);
          CHECK(r.report.message == "");
          CHECK(std::abs(r.report.lambda - lambda) <= 1e-9 * std::max(lambda, 1 / area));
          CHECK(r.report.smallest == Smallest::proven);
          CHECK(r.report.next.has_value() == (N > 1));
          if (flux != pi<double> && N > 1) CHECK(std::abs(r.report.next.value() - next) <= 1e-3 * next);
          CHECK(true_residual(S, M, area, r) <= 1e-9);
          CHECK(r.report.residual == doctest::Approx(true_residual(S, M, area, r)).epsilon(1e-3));
          CHECK(std::abs(r.u.norm() - 1) <= 1e-12);
        }
      }
    }
  }
}

TEST_CASE("lambda = 0 in a random gauge: found with a residual that means something") {
  const Hermitian S = torus_grid(25, 20, 0, 18);
  const Hermitian M = identity(500, 0.002);
  for (const std::string& solver : linear_solvers()) {
    const EigenResult r = smallest_eigenpair(S, M, 1, {.solver = solver});
    CAPTURE(solver);
    CHECK(r.report.converged);
    CHECK(std::abs(r.report.lambda) <= 1e-8);
    CHECK(r.report.next.value() > 1);
    // The kernel is covariantly constant: all moduli are equal.
    CHECK(r.u.cwiseAbs().maxCoeff() - r.u.cwiseAbs().minCoeff() <= 1e-6 * r.u.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("smallest eigenpair against the dense solver, with a consistent mass, at any scale") {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const Hermitian S = torus_grid(13, 9, 0.15 * static_cast<double>(seed), 20 + seed);
    for (const double scale : {1.0, 1e-12, 1e12}) {
      const Hermitian M = scale * consistent_mass(S);
      const double area = scale * static_cast<double>(S.rows());
      const VectorX<double> exact = dense_spectrum(S, M);
      for (const std::string& method : eigen_solvers()) {
        CAPTURE(seed);
        CAPTURE(scale);
        CAPTURE(method);
        const EigenResult r = smallest_eigenpair(S, M, area, {.method = method});
        CHECK(r.report.converged);
        CHECK(std::abs(r.report.lambda - exact[0]) <= 1e-9 * std::max(exact[0], 1 / area));
        CHECK(r.report.smallest == Smallest::proven);
        CHECK(std::abs(r.report.next.value() - exact[1]) <= 1e-3 * exact[1]);
        CHECK(std::abs(r.u.dot(M * r.u) - 1.0) <= 1e-12);
        CHECK(true_residual(S, M, area, r) <= 1e-8);
      }
    }
  }
}

TEST_CASE("multiple and nearly multiple eigenvalues converge") {
  // Nine pieces, the same but for a relative 0, 1e-12, 1e-6 or 1e-3: a nine-fold cluster at the bottom.
  const Hermitian piece = ring(40, 1, 30);
  for (const double split : {0.0, 1e-12, 1e-6, 1e-3}) {
    Builder b(360);
    for (Index c = 0; c < 9; ++c)
      for (Index j = 0; j < 40; ++j)
        for (Hermitian::InnerIterator it(piece, j); it; ++it)
          b.add(40 * c + static_cast<Index>(it.row()), 40 * c + j, it.value() * (1 + split * c));
    const Hermitian S = b.matrix();
    const double lambda = 2 - 2 * std::cos(1.0 / 40);
    for (const std::string& solver : linear_solvers()) {
      CAPTURE(split);
      CAPTURE(solver);
      const EigenResult r = smallest_eigenpair(S, identity(360), 1600, {.solver = solver});
      CHECK(r.report.converged);
      CHECK(std::abs(r.report.lambda / lambda - 1) <= 1e-7 + split * 1e-3);
      CHECK(r.report.residual <= 1e-8);
    }
  }
}

TEST_CASE("a hard spectrum restarts until the tolerance is met, and stops at the limit") {
  // A long ring has its eigenvalues close together: far more solves than the basis has vectors when the shift is far.
  const Hermitian S = ring(3000, 0.5, 31);
  const Hermitian M = identity(3000);
  // A small "area" puts the shift far away.
  const EigenResult r = smallest_eigenpair(S, M, 0.02, {.tolerance = 1e-12});
  CHECK(r.report.converged);
  CHECK(r.report.iterations > 40);
  CHECK(true_residual(S, M, 0.02, r) <= 1e-12);
  const EigenResult stopped = smallest_eigenpair(S, M, 0.02, {.tolerance = 1e-12, .max_iterations = 7});
  CHECK(!stopped.report.converged);
  CHECK(stopped.report.iterations <= 7);
  CHECK(!stopped.report.message.empty());
  CHECK(stopped.report.residual > 1e-12);
  CHECK(stopped.report.residual == doctest::Approx(true_residual(S, M, 0.02, stopped)).epsilon(1e-3));
}

TEST_CASE("a little indefinite is solved, clearly indefinite and bad masses are refused") {
  const Hermitian S = torus_grid(12, 10, 0.3, 32);
  const Hermitian M = consistent_mass(S);
  const double lambda = dense_spectrum(S, M)[0];
  const Hermitian below = S - (lambda + 0.01 / 120) * M;
  const EigenResult r = smallest_eigenpair(below, M, 120, {.method = "lanczos"});
  CHECK(r.report.converged);
  CHECK(r.report.lambda == doctest::Approx(-0.01 / 120).epsilon(1e-6));
  const auto said = [](const Hermitian& stiffness, const Hermitian& mass, const std::string& method) -> std::string {
    try {
      static_cast<void>(smallest_eigenpair(stiffness, mass, 120, {.method = method}));
    } catch (const SolveError& e) {
      return e.what();
    }
    return "nothing";
  };
  for (const std::string method : {"lanczos", "lobpcg", "inverse-iteration"}) {
    CAPTURE(method);
    const std::string indefinite = said(S - 5.0 * M, M, method);
    CHECK(indefinite.find("definite (found at column ") != std::string::npos);
    CHECK(indefinite.find("S - sigma M with sigma = -") != std::string::npos);
    CHECK(said(S, -1.0 * M, method).starts_with("the mass matrix M is not positive definite: entry 0 of its diagonal"));
    CHECK(said(S, identity(7), method) == "S has 120 rows and M 7");
    CHECK_THROWS_WITH_AS(static_cast<void>(eigenpairs(S, -1.0 * M, 120, 3, {.method = method})),
                         doctest::Contains("M is not positive definite"), SolveError);
  }
  // Multigrid finds it out in its own way, and leaves it to the factorisation to say what is wrong.
  const Hermitian larger = torus_grid(40, 40, 0.3, 32);
  for (const double factor : {0.0, -1.0}) {
    const std::string bad_mass = said(larger, factor * consistent_mass(larger), "lobpcg");
    CAPTURE(bad_mass);
    CHECK(bad_mass.find("M") != std::string::npos);
    CHECK(bad_mass.find("definite") != std::string::npos);
  }
  Hermitian saddle = identity(3);
  saddle.coeffRef(0, 1) = saddle.coeffRef(1, 0) = 2;
  CHECK(said(identity(3), identity(3, -1), "auto") ==
        "the mass matrix M is not positive definite: entry 0 of its diagonal is -1");
  CHECK(said(identity(3), saddle, "dense") ==
        "the mass matrix M is not positive definite, although its diagonal is positive");
}

TEST_CASE("the phase is fixed: the result is the same for any seed and any turned start") {
  const Hermitian S = torus_grid(21, 16, 0.4, 33);
  const Hermitian M = consistent_mass(S);
  const EigenResult a = smallest_eigenpair(S, M, 336, {.tolerance = 1e-10, .seed = 1});
  const EigenResult b = smallest_eigenpair(S, M, 336, {.tolerance = 1e-10, .seed = 99});
  CHECK((a.u - b.u).norm() <= 1e-6 * a.u.norm());
  Eigen::Index at = 0;
  a.u.cwiseAbs().maxCoeff(&at);
  CHECK(std::abs(std::arg(a.u[at])) <= 1e-12);
  const EigenResult again = smallest_eigenpair(S, M, 336, {.tolerance = 1e-10, .seed = 1});
  CHECK(a.u == again.u);
}

TEST_CASE("peak memory covers what was just touched") {
  const std::vector<char> block(std::size_t{64} << 20, 'x');
  CHECK(peak_memory_bytes() >= static_cast<std::int64_t>(block.size()));
  CHECK(block.back() == 'x');
}
