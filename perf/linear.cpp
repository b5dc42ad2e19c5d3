// SPDX-License-Identifier: MIT
//
// linear.cpp: (2 S + w M) u = b by every backend, setup and solve apart; w is that of a design whose guidance weighs
// like smoothness.
#include "perf/common.h"

namespace {

using namespace alcap;
using perf::Prepared;
using Scalar = Complex<double>;

struct System {
  SparseMatrix<Scalar> A, M;
  MatrixX<Scalar> b;
};

System make_system(const Prepared& p) {
  const Connection<double> c = globally_optimal(p.mesh, p.geometry);
  const HermitianPattern pattern(p.mesh);
  StiffnessMass<double> s = stiffness_and_mass(p.mesh, pattern, p.geometry, c, 4);
  const double w = 8 * pi<double> / p.geometry.total_area();
  System system{2.0 * s.S + w * s.M, std::move(s.M), MatrixX<Scalar>(p.mesh.vertices(), 1)};
  for (Index v = 0; v < p.mesh.vertices(); ++v) system.b(v, 0) = {std::cos(1.7 * v), std::sin(2.3 * v)};
  return system;
}

void declare(const perf::Plan& plan) {
  for (const std::string& backend : linear_solvers()) {
    // Simplicial factors do not scale; beyond this they only waste time.
    const std::int64_t largest = backend == "eigen-ldlt" ? 100000 : std::int64_t{1} << 40;
    const std::string extra = "backend:" + backend;
    const auto setup = [backend](const System& s) {
      auto solver = make_linear_solver<Scalar>({.name = backend, .tolerance = 1e-8});
      solver->set_transport(s.M);
      solver->analyse(s.A);
      solver->factorise(s.A);
      return solver;
    };
    perf::add(
        plan, "linear_setup", extra,
        [setup](benchmark::State& state, const Prepared& p, int threads) {
          const System s = make_system(p);
          perf::timed(state, threads, [&] { benchmark::DoNotOptimize(setup(s)); });
        },
        largest);
    perf::add(
        plan, "linear_solve", extra,
        [setup](benchmark::State& state, const Prepared& p, int threads) {
          const System s = make_system(p);
          MatrixX<Scalar> x(s.b.rows(), 1);
          const auto solver = setup(s);
          SolveReport report;
          perf::timed(state, threads, [&] { report = solver->solve(s.b, x); });
          state.counters["its"] = report.iterations;
          state.counters["residual"] = (perf::product(s.A, x) - s.b).norm() / s.b.norm();
          state.counters["bytes/vertex"] = 20.0 * double(report.factor_nonzeros) / p.mesh.vertices();
        },
        largest);
  }
}

}  // namespace

int main(int argc, char** argv) { return perf::run(argc, argv, declare); }
