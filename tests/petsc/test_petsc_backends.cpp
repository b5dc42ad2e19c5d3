// SPDX-License-Identifier: MIT
//
// PETSc's linear solvers and SLEPc's eigensolvers against the library's own and the dense solver: solutions agree, what
// is claimed is recomputed, bad systems are refused, calls can be cancelled and made on several threads, nothing is
// printed.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <complex>
#include <csignal>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "alcap/designer.h"
#include "alcap/field_run.h"
#include "alcap/generators.h"
#include "alcap/petsc.h"
#include "alcap/solve.h"
#include "tests/solvers/solver_fixture.h"

using namespace alcap;
using namespace alcap::test;

namespace {

const std::vector<std::string> linear{"petsc-cg-gamg", "petsc-mumps", "petsc"};
const std::vector<std::string> eigen{"slepc-krylovschur", "slepc-lobpcg", "slepc-gd", "slepc-jd"};

const std::vector<MeshData>& surfaces() {
  static const std::vector<MeshData> all{bumpy_sphere(2, 0.3, 5), disk(9), torus_random_diagonals(30, 16, 1, 0.4, 2),
                                         noisy_scan(3, 0.2, 3)};
  return all;
}

struct Solved {
  Dense x;
  SolveReport report;
};

Solved solved(const std::string& name, const Hermitian& A, const Dense& b, double tolerance = 1e-10) {
  const auto solver = make_linear_solver<Z>({.name = name, .tolerance = tolerance, .max_iterations = 3000});
  solver->analyse(A);
  solver->factorise(A);
  Solved s{.x = Dense(b.rows(), b.cols()), .report = {}};
  s.report = solver->solve(b, s.x);
  return s;
}

/// What is written to stdout and stderr while it lives.
class Captured {
 public:
  Captured() {
    for (const int k : {1, 2}) saved_[k - 1] = ::dup(k);
    file_ = std::tmpfile();
    (void)std::fflush(nullptr);
    for (const int k : {1, 2}) ::dup2(::fileno(file_), k);
  }
  Captured(const Captured&) = delete;
  Captured& operator=(const Captured&) = delete;
  ~Captured() {
    restore();
    (void)std::fclose(file_);
  }
  [[nodiscard]] long bytes() {
    restore();
    struct stat status {};
    return ::fstat(::fileno(file_), &status) == 0 ? status.st_size : -1;
  }

 private:
  void restore() {
    (void)std::fflush(nullptr);
    for (const int k : {1, 2}) {
      if (saved_[k - 1] < 0) continue;
      ::dup2(saved_[k - 1], k);
      ::close(saved_[k - 1]);
      saved_[k - 1] = -1;
    }
  }
  int saved_[2] = {-1, -1};
  std::FILE* file_ = nullptr;
};

}  // namespace

TEST_CASE("names are known as long as their registration lives, and signals stay the program's own") {
  const std::size_t before = linear_solvers().size() + eigen_solvers().size();
  {
    const auto petsc = register_petsc_backends();
    CHECK(linear_solvers().size() + eigen_solvers().size() == before + petsc.size());
    CHECK_THROWS_AS(static_cast<void>(register_petsc_backends()), OptionError);
    struct sigaction action {
    }, now{};
    ::sigaction(SIGSEGV, nullptr, &action);
    const Problem p = problem_of(disk(5), 2);
    CHECK(solved("petsc-mumps", p.shifted(), random_dense(p.S.rows(), 1, 1)).report.converged);
    ::sigaction(SIGSEGV, nullptr, &now);
    CHECK((now.sa_handler == action.sa_handler));
  }
  CHECK(linear_solvers().size() + eigen_solvers().size() == before);
}

TEST_CASE("linear systems: every backend against the solution, complex and real") {
  const auto petsc = register_petsc_backends();
  for (const MeshData& surface : surfaces()) {
    for (const int n : {1, 4}) {
      const Problem p = problem_of(surface, n);
      const Hermitian A = p.shifted();
      const Dense exact = random_dense(A.rows(), 2, 3);
      const Dense b = A * exact;
      for (const std::string& name : linear) {
        CAPTURE(name);
        CAPTURE(n);
        const Solved s = solved(name, A, b, 1e-11);
        CHECK(s.report.converged);
        CHECK(s.report.solver == name);
        CHECK((s.report.iterations == 0) == (name == "petsc-mumps"));
        const double after = residual<Z>(A, s.x, b);
        CHECK(after <= 1e-11);
        CHECK(s.report.residual == doctest::Approx(after).epsilon(0.01));
        CHECK((s.x - exact).norm() <= 1e-7 * exact.norm());
        if (name != "petsc") CHECK(s.report.factor_nonzeros > A.nonZeros() / 2);
      }
    }
  }
  for (const std::string& name : linear) check_small_real_system(name, 1e-10);
}

TEST_CASE("the smallest eigenpair: every method over every kind of preconditioner, against the library and dense") {
  const auto petsc = register_petsc_backends();
  for (const MeshData& surface : surfaces()) {
    for (const int n : {1, 4}) {
      const Problem p = problem_of(surface, n);
      const double exact = dense_spectrum(p.S, p.M)[0];
      CHECK(smallest_eigenpair(p.S, p.M, p.area).report.lambda == doctest::Approx(exact).epsilon(1e-8));
      for (const std::string& method : eigen) {
        for (const std::string solver : {"auto", "petsc-mumps", "petsc-cg-gamg", "multigrid", "eigen-ldlt"}) {
          CAPTURE(n);
          CAPTURE(method);
          CAPTURE(solver);
          const EigenResult r =
              smallest_eigenpair(p.S, p.M, p.area, {.solver = solver, .method = method, .max_iterations = 5000});
          CHECK(r.report.converged);
          CHECK(true_residual(p, r) <= 1e-8);
          CHECK(r.report.smallest == Smallest::proven);  // by the library, whoever found it
          CHECK(r.report.residual == doctest::Approx(true_residual(p, r)).epsilon(0.05));
          CHECK(std::abs(r.report.lambda - exact) <= 1e-8 * std::max(exact, 1 / p.area));
          CHECK(std::abs(r.u.dot(p.M * r.u) - 1.0) <= 1e-10);
          CHECK(r.report.solver.starts_with("SLEPc "));
          CHECK(r.report.solver.ends_with(solver != "auto"                ? solver
                                          : method == "slepc-krylovschur" ? "petsc-mumps"
                                                                          : "multigrid"));
        }
      }
    }
  }
}

TEST_CASE("ninefold eigenvalues, tiny problems, too few iterations") {
  const auto petsc = register_petsc_backends();
  const Problem sphere = problem_of(icosphere(3), 4), tiny = problem_of(tetrahedron(), 1);
  const double lambda = smallest_eigenpair(sphere.S, sphere.M, sphere.area).report.lambda;
  for (const std::string& method : eigen) {
    CAPTURE(method);
    const EigenResult r = smallest_eigenpair(sphere.S, sphere.M, sphere.area, {.method = method});
    CHECK(r.report.converged);
    CHECK(r.report.lambda == doctest::Approx(lambda).epsilon(1e-8));
    CHECK(smallest_eigenpair(tiny.S, tiny.M, tiny.area, {.method = method}).report.converged);
    if (method == "slepc-krylovschur") continue;
    const EigenResult few = smallest_eigenpair(sphere.S, sphere.M, sphere.area,
                                               {.tolerance = 1e-10, .method = method, .max_iterations = 1});
    CHECK(!few.report.converged);
    CHECK(few.report.residual > 1e-10);
    CHECK(!few.report.message.empty());
  }
}

TEST_CASE("whole runs: a field with its certificate, a design, options of one's own") {
  const auto petsc = register_petsc_backends();
  const MeshData surface = bumpy_sphere(3, 0.3, 5);
  const FieldRun expected = run_field(surface.V, surface.F, {.n = 2});
  for (const EigenOptions& options : {EigenOptions{.method = "slepc-lobpcg"}, EigenOptions{.solver = "petsc-mumps"}}) {
    const FieldRun run = run_field(surface.V, surface.F, {.n = 2, .eigen = options});
    CHECK(run.certificate.holds());
    CHECK(run.eigen.at(0).lambda == doctest::Approx(expected.eigen.at(0).lambda).epsilon(1e-8));
    CHECK((run.field.u - expected.field.u).norm() <= 1e-5 * expected.field.u.norm());
  }
  const ConnectedCase shape(surface);
  const auto design = [&](const std::string& solver) {
    Designer designer(shape.connected(), {.n = 2, .guidance_weight = 1, .solver = solver});
    designer.add(SingularityTarget{.face = 17});
    return designer.solve();
  };
  const DesignResult usual = design("auto");
  const auto own = register_petsc_solver("own", "-ksp_type minres -pc_type jacobi -ksp_max_it 100000");
  for (const std::string name : {"petsc-mumps", "petsc-cg-gamg", "own"})
    CHECK((design(name).field.u - usual.field.u).norm() <= 1e-6 * usual.field.u.norm());
}

TEST_CASE("what cannot be solved is a SolveError that says why, and prints nothing") {
  const auto petsc = register_petsc_backends();
  const auto wrong = register_petsc_solver("wrong", "-ksp_type abacus");
  const Problem p = problem_of(bumpy_sphere(2, 0.3, 5), 1);
  Hermitian indefinite = p.S - 40.0 / p.area * p.M;
  const Dense b = random_dense(p.S.rows(), 1, 1);
  Hermitian negative = p.shifted();
  negative.coeffRef(7, 7) = -1;
  Hermitian singular(3, 3);
  singular.setIdentity();
  singular.coeffRef(0, 1) = singular.coeffRef(1, 0) = 1;
  Captured captured;
  std::string bad_option, messages;
  const auto message = [&](const std::string& name, const Hermitian& A, const Dense& rhs) {
    try {
      static_cast<void>(solved(name, A, rhs));
    } catch (const SolveError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  for (const std::string& name : linear) messages += message(name, negative, b).empty() ? name : "";
  messages += message("petsc-mumps", singular, Dense::Random(3, 1)).empty() ? "singular" : "";
  messages += message("petsc-cg-gamg", indefinite, b).empty() ? "indefinite" : "";
  bad_option = message("wrong", p.shifted(), b);
  const long bytes = captured.bytes();
  CHECK(messages == "");
  CHECK(bad_option.find("abacus") != std::string::npos);
  CHECK(bytes == 0);
  // And all is well afterwards.
  CHECK(solved("petsc-cg-gamg", p.shifted(), b).report.converged);
  const auto unready = make_linear_solver<Z>({.name = "petsc-mumps"});
  CHECK_THROWS_AS(unready->factorise(p.S), SolveError);
}

TEST_CASE("cancelled after any number of questions, and used again") {
  const auto petsc = register_petsc_backends();
  const Problem p = problem_of(bumpy_sphere(3, 0.3, 5), 4);
  const Hermitian A = p.shifted();
  const Dense b = random_dense(A.rows(), 1, 1);
  for (const int count : {0, 1, 2, 3, 5, 8}) {
    CAPTURE(count);
    int left = count;
    bool asked = false;
    const auto cancel = [&] { return asked = true, left-- <= 0; };
    for (const std::string& method : eigen) {
      CAPTURE(method);
      left = count;
      asked = false;
      CHECK_THROWS_AS(static_cast<void>(smallest_eigenpair(p.S, p.M, p.area,
                                                           {.tolerance = 1e-12, .method = method, .cancel = cancel})),
                      Cancelled);
      CHECK(asked);
    }
    if (count > 5) continue;
    const auto solver = make_linear_solver<Z>({.name = "petsc-cg-gamg", .cancel = cancel});
    const auto go = [&] {
      Dense x(b.rows(), 1);
      solver->analyse(A);
      solver->factorise(A);
      return solver->solve(b, x).converged;
    };
    left = count;
    CHECK_THROWS_AS(static_cast<void>(go()), Cancelled);
    left = 1 << 30;
    CHECK(go());
  }
  CHECK(smallest_eigenpair(p.S, p.M, p.area, {.method = "slepc-jd"}).report.converged);
}

TEST_CASE("on several threads at once: calls take turns, results are the same") {
  const auto petsc = register_petsc_backends();
  const Problem p = problem_of(torus_random_diagonals(30, 16, 1, 0.4, 2), 4);
  const Hermitian A = p.shifted();
  const Dense b = random_dense(A.rows(), 1, 1);
  const Dense expected = solved("petsc-cg-gamg", A, b).x;
  const ComplexVectorX<double> u = smallest_eigenpair(p.S, p.M, p.area, {.method = "slepc-lobpcg"}).u;
  std::atomic<int> same{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      if (t % 2 == 0) same += solved("petsc-cg-gamg", A, b).x == expected ? 1 : 0;
      if (t % 2 == 1) same += smallest_eigenpair(p.S, p.M, p.area, {.method = "slepc-lobpcg"}).u == u ? 1 : 0;
    });
  for (std::thread& t : threads) t.join();
  CHECK(same == 4);
}
