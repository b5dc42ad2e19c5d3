// SPDX-License-Identifier: MIT
//
// kernels.cpp: the loop over triangles by instruction set, precision and size of n K (series below, closed forms
// above), and the machine's own limits: triad bandwidth and peak of multiply-adds.
#include <thread>

#include "alcap/detail/triangle_entries.h"
#include "perf/common.h"

namespace {

using namespace alcap;
using detail::Isa;

constexpr std::int64_t count = 1 << 16;

template <class T>
void entries(benchmark::State& state, Isa isa, double curvature) {
  std::vector<T> cot(3 * count, T(0.5773)), area(count, T(1)), K(count, static_cast<T>(curvature)), diagonal(3 * count);
  std::vector<std::complex<T>> off(3 * count), mass(count);
  const detail::TriangleInputs<T> in{.cot = cot.data(), .area = area.data(), .curvature = K.data(), .n = T(1)};
  const detail::TriangleOutputs<T> out{
      .stiffness_diagonal = diagonal.data(), .stiffness_off = off.data(), .mass_off = mass.data()};
  for (auto _ : state) {
    detail::triangle_entries<T>(0, count, in, out, isa);
    benchmark::ClobberMemory();
  }
  state.counters["ns/triangle"] = benchmark::Counter(
      double(count) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  perf::bandwidth(state, double(count) * 16 * sizeof(T));
}

// a = b + s c over arrays far larger than the caches of one core.
void triad(benchmark::State& state, int threads) {
  constexpr std::int64_t n = 1 << 24;
  const std::unique_ptr<double[]> a(new double[n]), b(new double[n]), c(new double[n]);
  parallel_for(n, [&](std::int64_t i) { a[i] = b[i] = c[i] = 1; });
  perf::timed(state, threads, [&] {
    parallel_ranges(n, 1 << 15, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) a[i] = b[i] + 3.0 * c[i];
    });
  });
  perf::bandwidth(state, 24.0 * double(n));
}

// Multiply-adds on values that stay in registers.
#if defined(__x86_64__)
__attribute__((target_clones("avx512f", "avx2", "default")))
#endif
double
multiply_adds(int rounds) {
  double v[64];
  for (int k = 0; k < 64; ++k) v[k] = k;
  for (int r = 0; r < rounds; ++r)
    for (double& x : v) x = x * 0.999 + 0.001;
  double sum = 0;
  for (const double x : v) sum += x;
  return sum;
}

void peak(benchmark::State& state, int threads) {
  constexpr int rounds = 100000, tasks = 16;
  std::vector<double> sums(tasks);
  perf::timed(state, threads, [&] {
    parallel_for(
        tasks, [&](std::int64_t i) { sums[static_cast<std::size_t>(i)] = multiply_adds(rounds); }, 1);
  });
  benchmark::DoNotOptimize(sums.data());
  state.counters["GFlop/s"] =
      benchmark::Counter(1e-9 * 2 * 64 * rounds * tasks, benchmark::Counter::kIsIterationInvariantRate);
}

void declare(const perf::Plan& plan) {
  for (const Isa isa : detail::available_isas())
    for (const bool series : {true, false}) {
      const std::string end = std::string("/isa:") + detail::name(isa) + (series ? "/form:series" : "/form:closed");
      const double curvature = series ? 1e-3 : 3.0;
      benchmark::RegisterBenchmark(("kernels/float" + end).c_str(),
                                   [=](benchmark::State& s) { entries<float>(s, isa, curvature); });
      benchmark::RegisterBenchmark(("kernels/double" + end).c_str(),
                                   [=](benchmark::State& s) { entries<double>(s, isa, curvature); });
    }
  for (const int threads : plan.threads) {
    const std::string end = "/threads:" + std::to_string(threads);
    benchmark::RegisterBenchmark(("machine/triad" + end).c_str(), [=](benchmark::State& s) {
      triad(s, threads);
    })->UseRealTime();
    benchmark::RegisterBenchmark(("machine/peak" + end).c_str(), [=](benchmark::State& s) {
      peak(s, threads);
    })->UseRealTime();
  }
}

}  // namespace

int main(int argc, char** argv) { return perf::run(argc, argv, declare); }
