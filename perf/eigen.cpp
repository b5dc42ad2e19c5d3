// SPDX-License-Identifier: MIT
//
// eigen.cpp: the smoothest field with S and M in hand by every eigensolver, and what tools do today, with the polar map
// and a fixed number of inverse iterations: 50 over Eigen's simplicial L D L', 20 over CHOLMOD. Ratios come from one
// run. "eigen_tolerance" asks small meshes for more and more digits.
#include "perf/common.h"

namespace {

using namespace alcap;
using perf::Prepared;
using Scalar = Complex<double>;

struct Method {
  std::string name, method, solver = "auto";
  perf::Limits limits = {};
  Prove prove = Prove::never;
};

// Factors of large meshes and hundreds of solves only waste time.
const perf::Limits direct{.faces = 400'000, .bytes_per_face = 2000}, simplicial{.faces = 100'000};

std::vector<Method> methods() {
  std::vector<Method> all{{.name = "auto", .method = "auto"},
                          {.name = "auto+proof", .method = "auto", .prove = Prove::always}};
  for (const std::string& m : eigen_solvers()) {
    if (m == "dense") continue;
    all.push_back({.name = m, .method = m, .limits = m == "lobpcg" ? perf::Limits{} : direct});
  }
  all.push_back({.name = "lanczos+multigrid", .method = "lanczos", .solver = "multigrid", .limits = direct});
  all.push_back({.name = "lanczos+eigen-ldlt", .method = "lanczos", .solver = "eigen-ldlt", .limits = simplicial});
  return all;
}

void ours(benchmark::State& state, const Prepared& p, int threads, int n, const Method& method, double tolerance) {
  const auto& [S, M] = p.matrices(n);
  EigenResult result;
  perf::timed_solver(state, p, threads, [&] {
    result = smallest_eigenpair(
        S, M, p.geometry.total_area(),
        {.tolerance = tolerance, .solver = method.solver, .method = method.method, .prove_smallest = method.prove});
  });
  state.counters["its"] = result.report.iterations;
  state.counters["residual"] = perf::eigen_residual(S, M, result.u);
  state.SetLabel(result.report.solver);
}

void baseline(benchmark::State& state, const Prepared& p, int threads, int n, const std::string& backend, int count) {
  const auto [S, M] = stiffness_and_mass(p.mesh, HermitianPattern(p.mesh), p.geometry, polar(p.mesh, p.geometry), n);
  const double shift = 1e-8 / p.geometry.total_area();
  MatrixX<Scalar> u(S.rows(), 1);
  perf::timed_solver(state, p, threads, [&, &S = S, &M = M] {
    const SparseMatrix<Scalar> A = S + shift * M;
    const auto solver = make_linear_solver<Scalar>({.name = backend});
    solver->analyse(A);
    solver->factorise(A);
    for (Index v = 0; v < S.rows(); ++v) u(v, 0) = {std::cos(1.7 * v), std::sin(2.3 * v)};
    MatrixX<Scalar> Mu(S.rows(), 1);
    for (int i = 0; i < count; ++i) {
      hermitian_product(M, u.data(), Mu.data());
      (void)solver->solve(Mu, u);
      u /= u.norm();
    }
  });
  state.counters["its"] = count;
  state.counters["residual"] = perf::eigen_residual(S, M, u);
}

void declare(const perf::Plan& plan) {
  constexpr double tolerance = 1e-6;
  for (const int n : plan.degrees) {
    const std::string degree = "n:" + std::to_string(n);
    for (const Method& method : methods())
      perf::add(
          plan, "eigen", degree + "/backend:" + method.name,
          [=](benchmark::State& state, const Prepared& p, int threads) {
            ours(state, p, threads, n, method, tolerance);
          },
          method.limits);
    perf::add(
        plan, "eigen", degree + "/backend:polar+eigen-ldlt+50",
        [=](benchmark::State& state, const Prepared& p, int threads) {
          baseline(state, p, threads, n, "eigen-ldlt", 50);
        },
        simplicial);
    perf::add(
        plan, "eigen", degree + "/backend:polar+cholmod+20",
        [=](benchmark::State& state, const Prepared& p, int threads) { baseline(state, p, threads, n, "cholmod", 20); },
        direct);
    for (const Method& method : methods()) {
      if (method.method == "auto" || method.solver != "auto") continue;
      perf::Limits small = method.limits;
      small.faces = std::min<std::int64_t>(small.faces, 100'000);
      for (const char* digits : {"1e-4", "1e-6", "1e-9"})
        perf::add(
            plan, "eigen_tolerance", degree + "/backend:" + method.name + "/tolerance:" + digits,
            [=](benchmark::State& state, const Prepared& p, int threads) {
              ours(state, p, threads, n, method, std::atof(digits));
            },
            small);
    }
  }
}

}  // namespace

int main(int argc, char** argv) { return perf::run(argc, argv, declare); }
