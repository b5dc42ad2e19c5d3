// SPDX-License-Identifier: MIT
//
// eigen.cpp: the smoothest field with S and M in hand by every eigensolver, and what tools do today, with the polar map
// and a fixed number of inverse iterations: 50 over Eigen's simplicial L D L', 20 over CHOLMOD. Ratios come from one
// run.
#include "perf/common.h"

namespace {

using namespace alcap;
using perf::Prepared;
using Scalar = Complex<double>;

StiffnessMass<double> matrices(const Prepared& p, int n, bool polar_map) {
  const Connection<double> c = polar_map ? polar(p.mesh, p.geometry) : globally_optimal(p.mesh, p.geometry);
  return stiffness_and_mass(p.mesh, HermitianPattern(p.mesh), p.geometry, c, n);
}

void ours(benchmark::State& state, const Prepared& p, int threads, int n, const std::string& method) {
  const auto [S, M] = matrices(p, n, false);
  EigenResult result;
  perf::timed(state, threads, [&] {
    result = smallest_eigenpair(S, M, p.geometry.total_area(), {.tolerance = 1e-6, .method = method});
  });
  state.counters["its"] = result.report.iterations;
  state.counters["residual"] = perf::eigen_residual(S, M, result.u);
  state.SetLabel(result.report.solver);
}

void baseline(benchmark::State& state, const Prepared& p, int threads, int n, const std::string& backend, int count) {
  const auto [S, M] = matrices(p, n, true);
  const double shift = 1e-8 / p.geometry.total_area();
  MatrixX<Scalar> u(S.rows(), 1);
  perf::timed(state, threads, [&] {
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
  constexpr std::int64_t direct_up_to = 400000, simplicial_up_to = 100000;
  for (const int n : plan.degrees) {
    const std::string degree = "n:" + std::to_string(n);
    std::vector<std::string> methods{"auto"};
    for (const std::string& m : eigen_solvers())
      if (m != "dense") methods.push_back(m);
    for (const std::string& method : methods)
      perf::add(
          plan, "eigen", degree + "/backend:" + method,
          [=](benchmark::State& state, const Prepared& p, int threads) { ours(state, p, threads, n, method); },
          method == "lanczos" ? direct_up_to : std::int64_t{1} << 40);
    perf::add(
        plan, "eigen", degree + "/backend:polar+eigen-ldlt+50",
        [=](benchmark::State& state, const Prepared& p, int threads) {
          baseline(state, p, threads, n, "eigen-ldlt", 50);
        },
        simplicial_up_to);
    perf::add(
        plan, "eigen", degree + "/backend:polar+cholmod+20",
        [=](benchmark::State& state, const Prepared& p, int threads) { baseline(state, p, threads, n, "cholmod", 20); },
        direct_up_to);
  }
}

}  // namespace

int main(int argc, char** argv) { return perf::run(argc, argv, declare); }
