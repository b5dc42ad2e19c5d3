// SPDX-License-Identifier: MIT
//
// common.h: what the benchmark programs share: mesh families of any size, their own flags beside Google Benchmark's,
// names that scripts/bench_report.py takes apart, and residuals computed without the library's solvers.
//
//   perf_connection --faces=50000,327680 --threads=1,2 --families=jittered,torus --benchmark_repetitions=5
//
// A benchmark is called PHASE/family/faces, then key:value pairs (n:4/backend:lobpcg/threads:2). Times are wall-clock.
// Every result carries faces, vertices and what the phase reports; "residual" is always recomputed here.
#pragma once

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "alcap/connection.h"
#include "alcap/energies.h"
#include "alcap/generators.h"
#include "alcap/parallel.h"

namespace alcap::perf {

/// Flags of all programs: --faces, --threads, --families, --degrees; comma-separated.
struct Plan {
  std::vector<std::int64_t> faces{50000, 327680};
  std::vector<int> threads{1, 2}, degrees{1, 4};
  std::vector<std::string> families{"jittered"};
};

/// A mesh of about `faces` triangles. Spheres come in sizes 20 4^level: the nearest one.
inline Surface make_surface(const std::string& family, std::int64_t faces) {
  const int level = std::max(3, static_cast<int>(std::lround(std::log2(double(faces) / 20) / 2)));
  const int across = std::max(3, static_cast<int>(std::lround(std::sqrt(double(faces) / 4))));
  if (family == "icosphere") return icosphere(level);
  if (family == "jittered") return jittered_sphere(level, 0.2, 1);
  if (family == "torus") return torus_random_diagonals(2 * across, across, 1.0, 0.4, 1);
  if (family == "scan") return noisy_scan(level, 0.1, 1);
  if (family == "cad") return cad_like(64, std::max(1, static_cast<int>(faces / 256)));
  throw std::runtime_error("unknown family " + family + "; there are icosphere, jittered, torus, scan, cad");
}

struct Prepared {
  Surface surface;
  Mesh mesh;
  Geometry<double> geometry;
  explicit Prepared(Surface s) : surface(std::move(s)), mesh(surface.F, surface.V.rows()), geometry(mesh, surface.V) {}
};

/// The mesh of this family and size; kept until another one is asked for, so that benchmarks in a row share it.
inline std::shared_ptr<const Prepared> prepared(const std::string& family, std::int64_t faces) {
  static std::string kept_family;
  static std::int64_t kept_faces = 0;
  static std::shared_ptr<const Prepared> kept;
  if (!kept || kept_family != family || kept_faces != faces) {
    kept.reset();
    kept = std::make_shared<const Prepared>(make_surface(family, faces));
    kept_family = family;
    kept_faces = faces;
  }
  return kept;
}

inline void counters(benchmark::State& state, const Mesh& mesh, int threads) {
  state.counters["faces"] = mesh.faces();
  state.counters["vertices"] = mesh.vertices();
  state.counters["threads"] = threads;
}

/// GB/s of an operation that moves `bytes` in each iteration.
inline void bandwidth(benchmark::State& state, double bytes) {
  state.counters["GB/s"] = benchmark::Counter(bytes / 1e9, benchmark::Counter::kIsIterationInvariantRate);
}

/// y = A x, one thread, straight from the definition.
inline ComplexVectorX<double> product(const SparseMatrix<Complex<double>>& A, const ComplexVectorX<double>& x) {
  ComplexVectorX<double> y = ComplexVectorX<double>::Zero(A.rows());
  for (Index j = 0; j < A.cols(); ++j)
    for (Index k = A.outerIndexPtr()[j]; k < A.outerIndexPtr()[j + 1]; ++k)
      y[A.innerIndexPtr()[k]] += A.valuePtr()[k] * x[j];
  return y;
}

/// |S u - lambda M u| / |lambda M u| with lambda the Rayleigh quotient of u.
inline double eigen_residual(const SparseMatrix<Complex<double>>& S, const SparseMatrix<Complex<double>>& M,
                             const ComplexVectorX<double>& u) {
  const ComplexVectorX<double> Su = product(S, u), Mu = product(M, u);
  const double lambda = (u.dot(Su) / u.dot(Mu)).real();
  return (Su - lambda * Mu).norm() / (std::abs(lambda) * Mu.norm());
}

/// Registers body(state, mesh, threads) as PHASE/family/faces/extra/threads:t for every combination of the plan.
inline void add(const Plan& plan, const std::string& phase, const std::string& extra,
                const std::function<void(benchmark::State&, const Prepared&, int threads)>& body,
                std::int64_t largest = std::int64_t{1} << 40) {
  for (const std::string& family : plan.families)
    for (const std::int64_t faces : plan.faces) {
      if (faces > largest) continue;
      for (const int threads : plan.threads) {
        std::string name = phase;
        name += "/" + family + "/" + std::to_string(faces) + (extra.empty() ? "" : "/" + extra);
        name += "/threads:" + std::to_string(threads);
        benchmark::RegisterBenchmark(name.c_str(),
                                     [=](benchmark::State& state) {
                                       const auto p = prepared(family, faces);
                                       body(state, *p, threads);
                                       counters(state, p->mesh, threads);
                                     })
            ->UseRealTime()
            ->MeasureProcessCPUTime()
            ->Unit(benchmark::kMillisecond);
      }
    }
}

/// Times body() on `threads` threads.
template <class Body>
void timed(benchmark::State& state, int threads, Body&& body) {
  for (auto _ : state) run_with_threads(threads, body);
}

inline std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> parts(1);
  for (const char c : list) {
    if (c == ',')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

/// main() of every program: reads the flags of Plan, lets `declare` register, runs.
inline int run(int argc, char** argv, const std::function<void(const Plan&)>& declare) {
  benchmark::Initialize(&argc, argv);
  Plan plan;
  for (int i = 1; i < argc; ++i) {
    const std::string flag = argv[i];
    const std::size_t equal = flag.find('=');
    const std::string key = flag.substr(0, equal);
    const std::vector<std::string> values = split(equal == std::string::npos ? "" : flag.substr(equal + 1));
    const auto numbers = [&](auto& out) {
      out.clear();
      for (const std::string& v : values)
        out.push_back(static_cast<typename std::decay_t<decltype(out)>::value_type>(std::atoll(v.c_str())));
    };
    if (key == "--faces") {
      numbers(plan.faces);
    } else if (key == "--threads") {
      numbers(plan.threads);
    } else if (key == "--degrees") {
      numbers(plan.degrees);
    } else if (key == "--families") {
      plan.families = values;
    } else {
      (void)std::fprintf(stderr, "unknown flag %s\n", flag.c_str());
      return 2;
    }
  }
  declare(plan);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace alcap::perf
