// SPDX-License-Identifier: MIT
//
// kernels.cpp: the loop over triangles by instruction set (scalar, packs), precision and size of n K (Taylor series,
// Chebyshev series, closed form), other kernels scalar against packs, and the machine's own limits: triad bandwidth and
// peak of multiply-adds.
#include <array>
#include <cstring>
#include <utility>

#include "kernels/edge_operators.h"
#include "kernels/whitney.h"
#include "perf/common.h"
#include "perf/flops.h"
#include "src/simd/triangle_entries.h"

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
  perf::flops(state, double(count) * perf::flops_of_entries(curvature));
}

// y = f(x) for arrays of x_size and y_size numbers per simplex, which lie apart, in lanes of T: a scalar or a pack.
template <class T, int x_size, int y_size, class Kernel>
void simplices(benchmark::State& state, Kernel&& kernel) {
  using V = kernels::Value<T>;
  constexpr int lanes = sizeof(T) / sizeof(V);
  std::vector<V> x(x_size * count), y(y_size * count);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = V(0.5) + V(0.3) * static_cast<V>(std::sin(double(i)));
  for (auto _ : state) {
    for (std::int64_t i = 0; i < count; i += lanes) {
      T in[x_size], out[y_size];
      for (int k = 0; k < x_size; ++k) std::memcpy(&in[k], x.data() + k * count + i, sizeof(T));
      kernel(in, out);
      for (int k = 0; k < y_size; ++k) std::memcpy(y.data() + k * count + i, &out[k], sizeof(T));
    }
    benchmark::ClobberMemory();
  }
  state.counters["ns/triangle"] = benchmark::Counter(
      double(count) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  perf::bandwidth(state, double(count) * (x_size + y_size) * sizeof(V));
}

template <class T>
void other_kernels(const std::string& precision, const std::string& isa) {
  benchmark::RegisterBenchmark(("whitney/" + precision + "/isa:" + isa).c_str(), [](benchmark::State& state) {
    simplices<T, 6, 3>(state, [](const T* x, T* y) {
      const T cot[3] = {x[0], x[1], x[2]}, tau[3] = {x[3], x[4], x[5]};
      T out[3];
      kernels::multiply(kernels::whitney_mass(cot), tau, out);
      for (int k = 0; k < 3; ++k) y[k] = out[k];
    });
  });
  benchmark::RegisterBenchmark(("edge_integral/" + precision + "/isa:" + isa).c_str(), [](benchmark::State& state) {
    simplices<T, 1, 2>(state, [](const T* x, T* y) {
      const auto psi = kernels::edge_weight_integral(x[0]);
      y[0] = psi.re, y[1] = psi.im;
    });
  });
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

// Multiply-adds on values that stay in registers: as many vectors as leave room for the two constants.
#if defined(__x86_64__)
#define ALCAP_CLONES __attribute__((target_clones("avx512f", "arch=haswell", "default")))
#else
#define ALCAP_CLONES
#endif
template <class T, int numbers>
[[gnu::always_inline]] inline double multiply_add(int rounds) {
  T v[numbers];
  for (int k = 0; k < numbers; ++k) v[k] = T(k);
  for (int r = 0; r < rounds; ++r)
    for (T& x : v) x = x * T(0.999) + T(0.001);
  double sum = 0;
  for (const T x : v) sum += double(x);
  return sum;
}
ALCAP_CLONES double multiply_adds_double(int rounds) { return multiply_add<double, 56>(rounds); }
ALCAP_CLONES double multiply_adds_float(int rounds) { return multiply_add<float, 112>(rounds); }

void peak(benchmark::State& state, int threads, bool single) {
  constexpr int rounds = 100000, tasks = 16;
  std::vector<double> sums(tasks);
  perf::timed(state, threads, [&] {
    parallel_for(
        tasks,
        [&](std::int64_t i) {
          sums[static_cast<std::size_t>(i)] = single ? multiply_adds_float(rounds) : multiply_adds_double(rounds);
        },
        1);
  });
  benchmark::DoNotOptimize(sums.data());
  perf::flops(state, 2.0 * (single ? 112 : 56) * rounds * tasks);
}

struct Here;  // tag of packs that are compiled with this file's flags

void declare(const perf::Plan& plan) {
  const std::array<std::pair<const char*, double>, 3> forms{{{"series", 1e-3}, {"chebyshev", 1.0}, {"closed", 5.0}}};
  for (const Isa isa : detail::available_isas())
    for (const auto& [form, curvature] : forms) {
      const std::string end = std::string("/isa:") + detail::name(isa) + "/form:" + form;
      benchmark::RegisterBenchmark(("kernels/float" + end).c_str(),
                                   [isa, K = curvature](benchmark::State& s) { entries<float>(s, isa, K); });
      benchmark::RegisterBenchmark(("kernels/double" + end).c_str(),
                                   [isa, K = curvature](benchmark::State& s) { entries<double>(s, isa, K); });
    }
  other_kernels<float>("float", "scalar");
  other_kernels<double>("double", "scalar");
  other_kernels<kernels::Pack<float, 4, Here>>("float", "portable");
  other_kernels<kernels::Pack<double, 2, Here>>("double", "portable");
  for (const int threads : plan.threads) {
    const std::string end = "/threads:" + std::to_string(threads);
    benchmark::RegisterBenchmark(("machine/triad" + end).c_str(), [=](benchmark::State& s) {
      triad(s, threads);
    })->UseRealTime();
    for (const bool single : {false, true})
      benchmark::RegisterBenchmark((single ? "machine/peak_float" + end : "machine/peak" + end).c_str(),
                                   [=](benchmark::State& s) { peak(s, threads, single); })
          ->UseRealTime();
  }
}

}  // namespace

int main(int argc, char** argv) { return perf::run(argc, argv, declare); }
