// SPDX-License-Identifier: MIT
//
// Linear backends and eigensolvers registered from outside: their names work wherever built-in ones do and give the
// same results, what they claim is not believed, bad names are refused, and threads do not get into each other's way.
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <complex>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "alcap/backends.h"
#include "alcap/cones.h"
#include "alcap/designer.h"
#include "alcap/field_run.h"
#include "alcap/generators.h"
#include "tests/solvers/solver_fixture.h"

using namespace alcap;
using namespace alcap::test;

namespace {

/// A = L L^H by hand.
class Factor {
 public:
  explicit Factor(Dense A) : L_(std::move(A)) {
    for (Eigen::Index j = 0; j < L_.cols(); ++j) {
      for (Eigen::Index k = 0; k < j; ++k)
        L_.col(j).tail(L_.rows() - j) -= std::conj(L_(j, k)) * L_.col(k).tail(L_.rows() - j);
      const double pivot = L_(j, j).real();
      if (!(pivot > 0)) throw SolveError("by hand: the matrix is not positive definite");
      L_.col(j).tail(L_.rows() - j) /= std::sqrt(pivot);
    }
  }
  [[nodiscard]] Dense solve(Dense X) const {
    const Eigen::Index n = L_.rows();
    for (Eigen::Index c = 0; c < X.cols(); ++c) {
      for (Eigen::Index j = 0; j < n; ++j) {
        X(j, c) /= L_(j, j);
        X.col(c).tail(n - j - 1) -= X(j, c) * L_.col(j).tail(n - j - 1);
      }
      for (Eigen::Index j = n; j-- > 0;)
        X(j, c) = (X(j, c) - L_.col(j).tail(n - j - 1).dot(X.col(c).tail(n - j - 1))) / std::conj(L_(j, j));
    }
    return X;
  }

 private:
  Dense L_;
};

class ByHand final : public LinearSolver<Z> {
 public:
  void analyse(const Hermitian&) override {}
  void factorise(const Hermitian& A) override { factor_ = std::make_unique<Factor>(Dense(A)); }
  SolveReport solve(const Eigen::Ref<const Dense>& B, Eigen::Ref<Dense> X) const override {
    X = factor_->solve(B);
    SolveReport report;
    report.solver = name();
    report.converged = true;
    return report;
  }
  [[nodiscard]] std::string name() const override { return "by-hand"; }

 private:
  std::unique_ptr<Factor> factor_;
};

BackendRegistration register_by_hand(const std::string& name = "by-hand") {
  return register_linear_solver(name, [](const SolverOptions&) { return std::make_unique<ByHand>(); });
}

/// Inverse iteration by hand; what it says of the result is as wrong as can be.
EigenResult boastful(const EigenProblem& p, const EigenOptions& options) {
  const Factor factor(Dense(p.S + 1e-3 / p.area * p.M));
  EigenResult result;
  result.u = random_dense(p.S.rows(), 1, options.seed).col(0);
  for (int step = 0; step < options.max_iterations; ++step)
    result.u = factor.solve(Dense(p.M * result.u)).col(0).normalized();
  result.u *= Z(0, 7);
  result.report.iterations = options.max_iterations;
  result.report.converged = false;
  result.report.lambda = -1;
  result.report.residual = 1e9;
  result.report.message = "by hand";
  return result;
}

bool known(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The error of `call`, which must be an OptionError of `field`.
template <class Call>
std::string refusal(const std::string& field, Call&& call) {
  try {
    static_cast<void>(call());
  } catch (const OptionError& e) {
    CHECK(e.field() == field);
    return e.what();
  }
  FAIL("no error");
  return "";
}

/// |u^H M v|, 1 for vectors that differ by a phase.
double overlap(const Problem& p, const EigenResult& a, const EigenResult& b) { return std::abs(a.u.dot(p.M * b.u)); }

}  // namespace

TEST_CASE("a linear backend from outside serves fields, designs and real systems by its name") {
  const auto by_hand = register_by_hand();
  CHECK(linear_solvers().back() == "by-hand");
  const MeshData surface = bumpy_sphere(2, 0.3, 5);

  const FieldRun expected = run_field(surface.V, surface.F, {.n = 2});
  const FieldRun run = run_field(surface.V, surface.F, {.n = 2, .eigen = {.solver = "by-hand"}});
  CHECK(run.certificate.holds());
  CHECK(run.eigen.at(0).solver == "shift-invert Lanczos, by-hand");
  CHECK(run.eigen.at(0).lambda == doctest::Approx(expected.eigen.at(0).lambda).epsilon(1e-8));
  CHECK((run.field.u - expected.field.u).norm() <= 1e-5 * expected.field.u.norm());

  const ConnectedCase shape(surface);
  const auto design = [&](const std::string& solver) {
    Designer designer(shape.connected(), {.n = 2, .guidance_weight = 1, .solver = solver});
    designer.add(SingularityTarget{.face = 17});
    return designer.solve();
  };
  const DesignResult designed = design("by-hand"), usual = design("auto");
  CHECK(designed.solver == "by-hand");
  CHECK((designed.field.u - usual.field.u).norm() <= 1e-8 * usual.field.u.norm());

  check_small_real_system("by-hand", 1e-15);
}

TEST_CASE("an eigensolver from outside is judged by what is recomputed") {
  const Problem p = problem_of(bumpy_sphere(2, 0.3, 5), 1);
  const auto registration = register_eigen_solver("by-hand", boastful);
  CHECK(eigen_solvers().back() == "by-hand");
  const EigenResult expected = smallest_eigenpair(p.S, p.M, p.area);
  const EigenResult good = smallest_eigenpair(p.S, p.M, p.area, {.method = "by-hand", .max_iterations = 1500});
  CHECK(good.report.converged);
  CHECK(good.report.solver == "by-hand");
  CHECK(good.report.iterations == 1500);
  CHECK(good.report.message == "by hand");
  CHECK(good.report.lambda == doctest::Approx(expected.report.lambda).epsilon(1e-8));
  CHECK(good.report.residual == doctest::Approx(true_residual(p, good)).epsilon(1e-3));
  const double next = expected.report.next.value();
  CHECK(good.report.next.value_or(next) == doctest::Approx(next).epsilon(1e-3));
  CHECK(good.report.smallest == Smallest::proven);
  CHECK(std::abs(good.u.dot(p.M * good.u) - 1.0) <= 1e-12);
  CHECK(overlap(p, good, expected) == doctest::Approx(1).epsilon(1e-8));
  CHECK((good.u - expected.u).norm() <= 1e-4 * expected.u.norm());  // the phase as well

  // Too few steps: no claim makes it converged.
  const auto liar = register_eigen_solver("liar", [](const EigenProblem& q, const EigenOptions& options) {
    EigenResult result = boastful(q, options);
    result.report.converged = true;
    result.report.residual = 0;
    result.report.angle = 0;
    result.report.angle_at_vertices = 0;
    result.report.angle_check = AngleCheck::bounded;
    result.report.message = "";
    return result;
  });
  const EigenResult bad = smallest_eigenpair(p.S, p.M, p.area, {.method = "liar", .max_iterations = 1});
  CHECK(!bad.report.converged);
  CHECK(bad.report.residual > 1e-8);
  CHECK(bad.report.message.starts_with("the residual asked for was not reached: try another EigenOptions::solver"));
  for (const Prove prove : {Prove::automatic, Prove::never}) {
    const EigenResult angled =
        smallest_eigenpair(p.S, p.M, p.area, {.method = "liar", .max_iterations = 1, .prove_smallest = prove});
    CHECK(angled.report.angle.value_or(90) > 0.01);
    CHECK(angled.report.angle_at_vertices.value_or(90) > 0.01);
    if (prove == Prove::never) CHECK(angled.report.angle_check != AngleCheck::bounded);
  }
  const MeshData surface = bumpy_sphere(2, 0.3, 5);
  CHECK(!run_field(surface.V, surface.F, {.n = 1, .eigen = {.method = "liar", .max_iterations = 1}})
             .certificate.eigen_converged);
}

TEST_CASE("what no vector can be made of is an error that names the eigensolver") {
  const Problem p = problem_of(icosphere(1), 1);
  const auto returns = [&](const ComplexVectorX<double>& u) {
    const auto registration = register_eigen_solver("strange", [&](const EigenProblem&, const EigenOptions&) {
      EigenResult result;
      result.u = u;
      return result;
    });
    try {
      static_cast<void>(smallest_eigenpair(p.S, p.M, p.area, {.method = "strange"}));
    } catch (const SolveError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  ComplexVectorX<double> u = ComplexVectorX<double>::Zero(p.S.rows());
  CHECK(returns(u).find("'strange'") != std::string::npos);
  u[3] = std::nan("");
  CHECK(returns(u).find("'strange'") != std::string::npos);
  CHECK(returns(ComplexVectorX<double>::Ones(5)).find("5 entries") != std::string::npos);
  CHECK(returns(ComplexVectorX<double>::Ones(p.S.rows())).empty());
}

TEST_CASE("an eigensolver from outside sees the transport only where M is one") {
  const Problem p = problem_of(icosphere(1), 1);
  bool given = false;
  const auto registration = register_eigen_solver("watching", [&](const EigenProblem& q, const EigenOptions& options) {
    given = q.transport != nullptr;
    if (given) CHECK(q.transport == &q.M);
    return boastful(q, options);
  });
  const EigenOptions options{.method = "watching", .max_iterations = 5};
  static_cast<void>(smallest_eigenpair(p.S, p.M, p.area, options));
  CHECK(given);
  Hermitian lumped(p.M.rows(), p.M.cols());
  lumped.setIdentity();
  static_cast<void>(smallest_eigenpair(p.S, lumped, p.area, options));
  CHECK(!given);
}

TEST_CASE("names that cannot be asked for, or are taken, are refused") {
  const auto made = [](const SolverOptions&) { return std::make_unique<ByHand>(); };
  for (const char* name : {"", "auto", "two words", "eigen-cg", "multigrid"}) {
    CAPTURE(name);
    CHECK(refusal("name", [&] { return register_linear_solver(name, made); }).find(name) != std::string::npos);
  }
  for (const char* name : {"", "auto", "tab\t", "lanczos", "dense"}) {
    CAPTURE(name);
    CHECK(refusal("name", [&] { return register_eigen_solver(name, boastful); }).find(name) != std::string::npos);
  }
  refusal("complex", [] { return register_linear_solver("nothing", nullptr); });
  refusal("solver", [] { return register_eigen_solver("nothing", nullptr); });
  const std::vector<std::string> before = linear_solvers();
  {
    auto first = register_by_hand();
    refusal("name", [&] { return register_by_hand(); });
    const BackendRegistration moved = std::move(first);
    CHECK(known(linear_solvers(), "by-hand"));
    // Unknown names are answered with what there is.
    const Hermitian A(1, 1);
    for (const std::string& text : {refusal("name", [] { return make_linear_solver<Z>({.name = "by-foot"}); }),
                                    refusal("solver", [&] { return smallest_eigenpair(A, A, 1, {.solver = "x"}); })})
      CHECK(text.find("multigrid, by-hand") != std::string::npos);
  }
  CHECK(linear_solvers() == before);
  refusal("name", [] { return make_linear_solver<Z>({.name = "by-hand"}); });
  const auto again = register_by_hand();  // free again
}

TEST_CASE("a solver outlives its registration") {
  std::unique_ptr<LinearSolver<Z>> solver;
  {
    const auto registration = register_by_hand();
    solver = make_linear_solver<Z>({.name = "by-hand"});
  }
  Hermitian A(2, 2);
  A.setIdentity();
  solver->factorise(A);
  Dense X(2, 1);
  CHECK(solver->solve(Dense::Ones(2, 1), X).converged);
  CHECK(X == Dense::Ones(2, 1));
}

TEST_CASE("a factory or solver that throws reaches the caller, and the tables stay as they are") {
  const auto throwing = register_linear_solver(
      "throwing",
      [](const SolverOptions&) -> std::unique_ptr<LinearSolver<Z>> { throw std::logic_error("no licence"); });
  const auto empty = register_linear_solver("empty", [](const SolverOptions&) { return std::unique_ptr<ByHand>(); });
  const auto hungry = register_eigen_solver(
      "hungry", [](const EigenProblem&, const EigenOptions&) -> EigenResult { throw std::bad_alloc(); });
  const Problem p = problem_of(icosphere(2), 1);
  CHECK_THROWS_WITH_AS(static_cast<void>(make_linear_solver<Z>({.name = "throwing"})), "no licence", std::logic_error);
  CHECK_THROWS_AS(static_cast<void>(make_linear_solver<double>({.name = "throwing"})), std::logic_error);
  CHECK_THROWS_AS(static_cast<void>(smallest_eigenpair(p.S, p.M, p.area, {.solver = "throwing"})), std::logic_error);
  CHECK_THROWS_AS(static_cast<void>(make_linear_solver<Z>({.name = "empty"})), SolveError);
  CHECK_THROWS_AS(static_cast<void>(make_linear_solver<double>({.name = "empty"})), SolveError);
  CHECK_THROWS_AS(static_cast<void>(smallest_eigenpair(p.S, p.M, p.area, {.method = "hungry"})), SolveError);
  CHECK_THROWS_WITH_AS(static_cast<void>(eigenpairs(p.S, p.M, p.area, 2, {.method = "hungry"})),
                       doctest::Contains("option 'method' = hungry: must be one of the library's own"), OptionError);
  // A factory may ask the library itself.
  const auto nested = register_linear_solver("nested", [](const SolverOptions&) {
    const auto inner = register_by_hand("inner");
    return make_linear_solver<Z>({.name = "inner"});
  });
  CHECK(make_linear_solver<Z>({.name = "nested"})->name() == "by-hand");
  CHECK(!known(linear_solvers(), "inner"));
}

TEST_CASE("threads register and make solvers at once") {
  const Problem p = problem_of(icosphere(0), 1);
  const Hermitian A = p.shifted();
  const Dense b = random_dense(A.rows(), 1, 3);
  std::atomic<int> wrong{0};
  const auto work = [&](const std::string& name) {
    for (int round = 0; round < 100; ++round) {
      const auto linear = register_by_hand(name);
      const auto eigen = register_eigen_solver(name, boastful);
      if (!known(linear_solvers(), name) || !known(eigen_solvers(), name)) ++wrong;
      for (const std::string& solver : {name, std::string("eigen-ldlt")}) {
        const auto made = make_linear_solver<Z>({.name = solver});
        made->analyse(A);
        made->factorise(A);
        Dense x(A.rows(), 1);
        static_cast<void>(made->solve(b, x));
        if (!(residual<Z>(A, x, b) <= 1e-12)) ++wrong;
      }
      const EigenResult r = smallest_eigenpair(p.S, p.M, p.area, {.solver = name, .method = name, .max_iterations = 3});
      if (r.report.solver != name) ++wrong;
    }
  };
  std::thread other(work, "first");
  work("second");
  other.join();
  CHECK(wrong == 0);
  CHECK(!known(linear_solvers(), "first"));
  CHECK(!known(linear_solvers(), "second"));
}
