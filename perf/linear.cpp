// SPDX-License-Identifier: MIT
//
// linear.cpp: (2 S + w M) u = b by every backend: setup and solve apart, one and eight right-hand sides, and the
// product A x that all of them are measured against; w is that of a design whose guidance weighs like smoothness.
#include "perf/common.h"

namespace {

using namespace alcap;
using perf::Prepared;
using Scalar = Complex<double>;

struct System {
  SparseMatrix<Scalar> A;
  const SparseMatrix<Scalar>& M;
  MatrixX<Scalar> b;
};

System make_system(const Prepared& p, int columns) {
  const auto& [S, M] = p.matrices(4);
  const double w = 8 * pi<double> / p.geometry.total_area();
  System system{2.0 * S + w * M, M, MatrixX<Scalar>(p.mesh.vertices(), columns)};
  for (Index c = 0; c < columns; ++c)
    for (Index v = 0; v < p.mesh.vertices(); ++v) system.b(v, c) = {std::cos(1.7 * v + c), std::sin(2.3 * v - c)};
  return system;
}

double largest_residual(const System& s, const MatrixX<Scalar>& x) {
  double worst = 0;
  for (Index c = 0; c < x.cols(); ++c)
    worst = std::max(worst, (perf::product(s.A, x.col(c)) - s.b.col(c)).norm() / s.b.col(c).norm());
  return worst;
}

auto setup(const System& s, const std::string& backend, double tolerance) {
  auto solver = make_linear_solver<Scalar>({.name = backend, .tolerance = tolerance, .max_iterations = 5000});
  solver->set_transport(s.M);
  solver->analyse(s.A);
  solver->factorise(s.A);
  return solver;
}

void solve(benchmark::State& state, const Prepared& p, int threads, const std::string& backend, double tolerance,
           int columns) {
  const System s = make_system(p, columns);
  MatrixX<Scalar> x(s.b.rows(), columns);
  const auto solver = setup(s, backend, tolerance);
  SolveReport report;
  perf::timed_solver(state, p, threads, [&] { report = solver->solve(s.b, x); });
  state.counters["its"] = report.iterations;
  state.counters["residual"] = largest_residual(s, x);
}

void declare(const perf::Plan& plan) {
  perf::add(plan, "product", "", [](benchmark::State& state, const Prepared& p, int threads) {
    const SparseMatrix<Scalar>& S = p.matrices(4).S;
    ComplexVectorX<double> x = ComplexVectorX<double>::Ones(S.rows()), y(S.rows());
    perf::timed(state, threads, [&] { hermitian_product(S, x.data(), y.data()); });
    // Values, row numbers and starts once, x and y once: what memory must move when x stays in the caches.
    perf::bandwidth(state, 20.0 * double(S.nonZeros()) + 36.0 * double(S.rows()));
    perf::flops(state, 8.0 * double(S.nonZeros()));
  });
  constexpr double tolerance = 1e-8;
  for (const std::string& backend : linear_solvers()) {
    perf::Limits limits;
    if (backend.starts_with("cholmod")) limits.bytes_per_face = 2200;
    // Simplicial factors do not scale, nor does CG with an incomplete one; beyond this they only waste time.
    if (backend == "eigen-ldlt") limits.faces = 100'000;
    if (backend == "eigen-cg" || backend.starts_with("petsc")) limits.faces = 400'000;
    const std::string extra = "backend:" + backend;
    perf::add(
        plan, "linear_setup", extra,
        [=](benchmark::State& state, const Prepared& p, int threads) {
          const System s = make_system(p, 1);
          perf::timed_solver(state, p, threads, [&] { benchmark::DoNotOptimize(setup(s, backend, tolerance)); });
        },
        limits);
    perf::add(
        plan, "linear_solve", extra,
        [=](benchmark::State& state, const Prepared& p, int threads) {
          solve(state, p, threads, backend, tolerance, 1);
        },
        limits);
    perf::add(
        plan, "linear_solve8", extra,
        [=](benchmark::State& state, const Prepared& p, int threads) {
          solve(state, p, threads, backend, tolerance, 8);
        },
        limits);
    limits.faces = std::min<std::int64_t>(limits.faces, 100'000);
    for (const char* digits : {"1e-4", "1e-6", "1e-8", "1e-10", "1e-12"}) {
      // Direct ones know no tolerance.
      const bool direct = backend.starts_with("cholmod") || backend == "eigen-ldlt" || backend == "petsc-mumps";
      if (direct && std::string(digits) != "1e-12") continue;
      perf::add(
          plan, "linear_tolerance", extra + "/tolerance:" + digits,
          [=](benchmark::State& state, const Prepared& p, int threads) {
            const System s = make_system(p, 1);
            MatrixX<Scalar> x(s.b.rows(), 1);
            SolveReport report;
            perf::timed_solver(state, p, threads,
                               [&] { report = setup(s, backend, std::atof(digits))->solve(s.b, x); });
            state.counters["its"] = report.iterations;
            state.counters["residual"] = largest_residual(s, x);
          },
          limits);
    }
  }
}

}  // namespace

int main(int argc, char** argv) { return perf::run(argc, argv, declare); }
