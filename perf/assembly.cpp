// SPDX-License-Identifier: MIT
//
// assembly.cpp: the pattern, S and M together, and what a parallel copy of their values costs.
#include <algorithm>

#include "perf/common.h"
#include "perf/flops.h"

namespace {

using namespace alcap;
using perf::Prepared;

void declare(const perf::Plan& plan) {
  perf::add(plan, "pattern", "", [](benchmark::State& state, const Prepared& p, int threads) {
    perf::timed(state, threads, [&] { benchmark::DoNotOptimize(HermitianPattern(p.mesh)); });
  });
  perf::add(plan, "assembly", "n:4", [](benchmark::State& state, const Prepared& p, int threads) {
    const Connection& c = p.connection();
    const HermitianPattern pattern(p.mesh);
    perf::timed(state, threads,
                [&] { benchmark::DoNotOptimize(stiffness_and_mass(p.mesh, pattern, p.geometry, c, 4)); });
    perf::bandwidth(state, 2.0 * 16 * pattern.nonzeros());
    // Curvatures are small on fine meshes: the series.
    perf::flops(state, perf::flops_of_entries(1e-3) * p.mesh.faces());
  });
  // Into memory that is as new as the matrices' is.
  perf::add(plan, "assembly_copy", "", [](benchmark::State& state, const Prepared& p, int threads) {
    const std::int64_t n = 2 * std::int64_t{HermitianPattern(p.mesh).nonzeros()};
    const std::vector<Complex<double>> from(static_cast<std::size_t>(n), 1.0);
    perf::timed(state, threads, [&] {
      const std::unique_ptr<Complex<double>[]> to = std::make_unique_for_overwrite<Complex<double>[]>(from.size());
      parallel_ranges(n, sequential_below, [&](std::int64_t begin, std::int64_t end) {
        std::copy(from.data() + begin, from.data() + end, to.get() + begin);
      });
      benchmark::DoNotOptimize(to.get());
      benchmark::ClobberMemory();
    });
    perf::bandwidth(state, 16.0 * double(n));
  });
}

}  // namespace

int main(int argc, char** argv) { return perf::run(argc, argv, declare); }
