// SPDX-License-Identifier: MIT
//
// backends.cpp: one backend on one matrix to a residual that is the same for all: the tolerance that a backend is given
// is tightened until the residual recomputed here is met, and what that last run took is printed as one line of JSON.
// One run per process, so that memory is the backend's own. scripts/backends_table.py makes tables of it.
//
//   perf_backends FAMILY FACES N RESIDUAL linear NAME
//   perf_backends FAMILY FACES N RESIDUAL eigen METHOD SOLVER
#include <ctime>
#include <iostream>

#include "perf/common.h"

namespace {

using namespace alcap;
using Scalar = Complex<double>;

constexpr int most_rounds = 8;
constexpr int most_iterations = 20000;

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Row {
  double setup = 0, solve = 0;  ///< CPU seconds
  double tolerance = 0, residual = HUGE_VAL, bytes = 0, lambda = 0;
  int iterations = 0;
  std::int64_t entries = 0;
  std::string says = {};
};

/// run(tolerance) fills a row; again with a tighter tolerance until `wanted` is met or nothing changes.
template <class Run>
Row to_residual(double wanted, Run&& run) {
  Row row;
  double tolerance = wanted;
  for (int round = 0; round < most_rounds; ++round) {
    const Row next = run(tolerance);
    const bool gained = next.residual < 0.9 * row.residual;
    if (gained || round == 0) row = next;
    if (row.residual <= wanted || !gained) break;
    tolerance *= std::clamp(0.5 * wanted / row.residual, 1e-3, 0.5);
    if (tolerance < 1e-15) break;
  }
  return row;
}

Row linear(const perf::Prepared& p, int n, double wanted, const std::string& name) {
  const auto& [S, M] = p.matrices(n);
  const SparseMatrix<Scalar> A = 2.0 * S + 8 * pi<double> / p.geometry.total_area() * M;
  MatrixX<Scalar> b(A.rows(), 1), x(A.rows(), 1);
  for (Index v = 0; v < A.rows(); ++v) b(v, 0) = {std::cos(1.7 * v), std::sin(2.3 * v)};
  return to_residual(wanted, [&](double tolerance) {
    Row row{.tolerance = tolerance};
    const perf::Watermark memory;
    const double start = cpu_seconds();
    const auto solver =
        make_linear_solver<Scalar>({.name = name, .tolerance = tolerance, .max_iterations = most_iterations});
    solver->set_transport(M);
    solver->analyse(A);
    solver->factorise(A);
    const double ready = cpu_seconds();
    const SolveReport report = solver->solve(b, x);
    row.solve = cpu_seconds() - ready;
    row.setup = ready - start;
    row.bytes = memory.bytes();
    row.residual = (perf::product(A, x.col(0)) - b.col(0)).norm() / b.norm();
    row.iterations = report.iterations;
    row.entries = report.factor_nonzeros;
    row.says = report.solver;
    return row;
  });
}

Row eigen(const perf::Prepared& p, int n, double wanted, const std::string& method, const std::string& solver) {
  const auto& [S, M] = p.matrices(n);
  return to_residual(wanted, [&, &S = S, &M = M](double tolerance) {
    Row row{.tolerance = tolerance};
    const perf::Watermark memory;
    const double start = cpu_seconds();
    const EigenResult result =
        smallest_eigenpair(S, M, p.geometry.total_area(),
                           {.tolerance = tolerance,
                            .solver = solver,
                            .method = method,
                            .max_iterations = most_iterations,
                            .prove_smallest = Prove::never});  // costs the same after every method
    row.solve = cpu_seconds() - start;
    row.bytes = memory.bytes();
    row.residual = perf::eigen_residual(S, M, result.u);
    row.iterations = result.report.iterations;
    row.lambda = result.report.lambda;
    row.says = result.report.solver;
    return row;
  });
}

int run(const std::vector<std::string>& words) {
#ifdef ALCAP_WITH_PETSC
  const auto petsc = register_petsc_backends();
#endif
  if (words.size() == 1 && words[0] == "list") {
    for (const std::string& name : linear_solvers()) std::cout << "linear " << name << "\n";
    for (const std::string& name : eigen_solvers()) std::cout << "eigen " << name << "\n";
    return 0;
  }
  if (words.size() < 6 || (words[4] == "eigen" && words.size() < 7)) {
    std::cerr << "perf_backends list, or FAMILY FACES N RESIDUAL linear NAME, or ... eigen METHOD SOLVER\n";
    return 2;
  }
  const perf::Prepared p(perf::make_surface(words[0], std::stoll(words[1])));
  const int n = std::stoi(words[2]);
  const double wanted = std::stod(words[3]);
  Row row;
  run_with_threads(1, [&] {
    static_cast<void>(p.matrices(n));
    if (words[4] == "eigen") {  // MPI starts here, before anything is measured
      const perf::Prepared tiny(perf::make_surface("torus", 1000));
      static_cast<void>(eigen(tiny, 1, 1e-2, words[5], words[6]));
      row = eigen(p, n, wanted, words[5], words[6]);
    } else {
      const perf::Prepared tiny(perf::make_surface("torus", 1000));
      static_cast<void>(linear(tiny, 1, 1e-2, words[5]));
      row = linear(p, n, wanted, words[5]);
    }
  });
  std::cout.precision(12);
  std::cout << "{\"faces\": " << p.mesh.faces() << ", \"vertices\": " << p.mesh.vertices()
            << ", \"setup\": " << row.setup << ", \"solve\": " << row.solve << ", \"iterations\": " << row.iterations
            << ", \"residual\": " << row.residual << ", \"tolerance\": " << row.tolerance
            << ", \"bytes\": " << row.bytes << ", \"lambda\": " << row.lambda << ", \"entries\": " << row.entries
            << ", \"solver\": \"" << row.says << "\"}\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& e) {
    std::cerr << e.what() << "\n";
    return 1;
  }
}
