// SPDX-License-Identifier: MIT
//
// common.h: what the benchmark programs share: mesh families of any size, their own flags beside Google Benchmark's,
// names that scripts/bench_report.py takes apart, residuals computed without the library's solvers, memory, and the
// time of one matrix product, in which the work of solvers is counted ("sweeps").
//
//   perf_connection --faces=50000,327680 --threads=1,2 --families=jittered,torus --benchmark_repetitions=5
//
// A benchmark is called PHASE/family/faces, then key:value pairs (n:4/backend:lobpcg/threads:2). Times are wall-clock.
// Every result carries faces, vertices and what the phase reports; "residual" is always recomputed here.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "alcap/connection.h"
#include "alcap/energies.h"
#include "alcap/petsc.h"
#include "alcap/solve.h"
#include "perf/spheres.h"
#include "src/base/clock.h"
#include "src/base/parallel.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace alcap::perf {

/// Flags of all programs: --faces, --threads, --families, --degrees; comma-separated.
struct Plan {
  std::vector<std::int64_t> faces{50000, 327680};
  std::vector<int> threads{1, 2}, degrees{1, 4};
  std::vector<std::string> families{"jittered"};
};

/// A mesh of about `faces` triangles; spheres have 20 f^2, which all sizes of the targets are. Scans are subdivided and
/// come in sizes 20 4^level: the nearest one.
inline MeshData make_surface(const std::string& family, std::int64_t faces) {
  const int level = std::max(3, static_cast<int>(std::lround(std::log2(double(faces) / 20) / 2)));
  const int across = std::max(3, static_cast<int>(std::lround(std::sqrt(double(faces) / 4))));
  const auto pieces = static_cast<Index>(std::max(3L, std::lround(std::sqrt(double(faces) / 20))));
  if (family == "icosphere") return geodesic_sphere(pieces);
  if (family == "jittered") {
    MeshData sphere = geodesic_sphere(pieces);
    jitter(sphere, 0.2, 1);
    return sphere;
  }
  if (family == "torus") return torus_random_diagonals(2 * across, across, 1.0, 0.4, 1);
  if (family == "scan") return noisy_scan(level, 0.1, 1);
  if (family == "cad") return cad_like(64, std::max(1, static_cast<int>(faces / 256)));
  throw std::runtime_error("unknown family " + family + "; there are icosphere, jittered, torus, scan, cad");
}

/// A mesh, and what benchmarks in a row share of it, made when first asked for.
class Prepared {
 public:
  MeshData surface;
  Mesh mesh;
  Geometry geometry;
  explicit Prepared(MeshData s) : surface(std::move(s)), mesh(surface.F, surface.V.rows()), geometry(mesh, surface.V) {}

  /// Globally optimal.
  [[nodiscard]] const Connection& connection() const {
    if (!connection_) connection_ = std::make_unique<Connection>(globally_optimal(mesh, geometry));
    return *connection_;
  }
  /// Of the global connection; the last degree is kept.
  [[nodiscard]] const StiffnessMass& matrices(int n) const {
    if (!matrices_ || degree_ != n) {
      matrices_.reset();
      matrices_ =
          std::make_unique<StiffnessMass>(stiffness_and_mass(mesh, HermitianPattern(mesh), geometry, connection(), n));
      degree_ = n;
    }
    return *matrices_;
  }
  /// Seconds of one product with S on so many threads, the unit of "sweeps".
  [[nodiscard]] double sweep_seconds(int threads) const {
    double& best = sweeps_[threads];
    if (best > 0) return best;
    const SparseMatrix<Complex<double>>& S = matrices(std::max(degree_, 1)).S;
    ComplexVectorX<double> x = ComplexVectorX<double>::Ones(S.rows()), y(S.rows());
    best = 1e300;
    for (int k = 0; k < 5; ++k) {
      const detail::Stopwatch watch;
      run_with_threads(threads, [&] { hermitian_product(S, x.data(), y.data()); });
      best = std::min(best, watch.seconds());
    }
    return best;
  }

 private:
  mutable std::unique_ptr<Connection> connection_;
  mutable std::unique_ptr<StiffnessMass> matrices_;
  mutable int degree_ = 0;
  mutable std::map<int, double> sweeps_;
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

/// GFlop/s of an operation with so many in each iteration.
inline void flops(benchmark::State& state, double operations) {
  state.counters["GFlop/s"] = benchmark::Counter(operations / 1e9, benchmark::Counter::kIsIterationInvariantRate);
}

/// Bytes that /proc/self/status tells under a key such as "VmRSS:". Linux only, 0 elsewhere.
inline double status_bytes(const std::string& key) {
  std::ifstream in("/proc/self/status");
  for (std::string word; in >> word;)
    if (word == key) {
      double kilobytes = 0;
      in >> kilobytes;
      return 1024 * kilobytes;
    }
  return 0;
}

/// By how much the resident set grows at most from construction on. Linux only, 0 elsewhere.
class Watermark {
 public:
  Watermark() {
#ifdef __GLIBC__
    malloc_trim(0);  // what is free already would hide what is asked for
#endif
    std::ofstream("/proc/self/clear_refs") << "5";  // the peak starts again from here
    before_ = status_bytes("VmRSS:");
  }
  [[nodiscard]] double bytes() const { return std::max(0.0, status_bytes("VmHWM:") - before_); }

 private:
  double before_ = 0;
};

/// True when memory for a problem that needs so many bytes per triangle is there now.
inline bool fits(std::int64_t faces, double bytes_per_face) {
  std::ifstream in("/proc/meminfo");
  for (std::string word; in >> word;)
    if (word == "MemAvailable:") {
      double kilobytes = 0;
      in >> kilobytes;
      return double(faces) * bytes_per_face < 1024 * kilobytes;
    }
  return true;
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

/// Where a benchmark stops to make sense: sizes beyond are left out.
struct Limits {
  std::int64_t faces = std::int64_t{1} << 40;
  // Mesh, geometry, connection, matrices and multigrid: 830 at most were measured, blocks of 16 on round spheres.
  double bytes_per_face = 1000;
};

/// Registers body(state, mesh, threads) as PHASE/family/faces/extra/threads:t for every combination of the plan.
inline void add(const Plan& plan, const std::string& phase, const std::string& extra,
                const std::function<void(benchmark::State&, const Prepared&, int threads)>& body,
                const Limits& limits = {}) {
  for (const std::string& family : plan.families)
    for (const std::int64_t faces : plan.faces) {
      if (faces > limits.faces || !fits(faces, limits.bytes_per_face)) continue;
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

/// Times body() on `threads` threads; the mean seconds of a call.
template <class Body>
double timed(benchmark::State& state, int threads, Body&& body) {
  double seconds = 0;
  int calls = 0;
  for (auto _ : state) {
    const detail::Stopwatch watch;
    run_with_threads(threads, body);
    seconds += watch.seconds();
    ++calls;
  }
  return seconds / std::max(calls, 1);
}

/// The same, for solvers: also counts matrix sweeps and the bytes per vertex that were needed on top.
template <class Body>
void timed_solver(benchmark::State& state, const Prepared& p, int threads, Body&& body) {
  const double sweep = p.sweep_seconds(threads);
  const Watermark memory;
  state.counters["sweeps"] = timed(state, threads, body) / sweep;
  state.counters["bytes/vertex"] = memory.bytes() / p.mesh.vertices();
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
  for (int i = 1; i < argc; ++i)
    if (std::string_view(argv[i]) == "--help")
      (void)std::puts(
          "Flags of the benchmarks of alcap; lists are separated by commas:\n"
          "  --faces=LIST     triangles (50000,327680); sizes that do not fit into memory are left out\n"
          "  --threads=LIST   (1,2)\n"
          "  --degrees=LIST   n of the fields (1,4), where a benchmark has several\n"
          "  --families=LIST  of jittered (default), icosphere, torus, scan, cad\n"
          "Names are PHASE/family/faces/key:value/threads:T. The others are those of Google Benchmark:");
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
#ifdef ALCAP_WITH_PETSC
  const auto petsc = register_petsc_backends();
#endif
  declare(plan);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace alcap::perf
