// SPDX-License-Identifier: MIT
//
// connection.cpp: the connections, and the global one by detail. "residual" is the energy's gradient with respect to
// rho_ij, from its definition (the difference of W tau across each edge), relative to that of the polar map.
#include "perf/common.h"

namespace {

using namespace alcap;
using perf::Prepared;

void global(benchmark::State& state, const Prepared& p, int threads, double detail) {
  // Of a face, relaxed in a pair mostly, and its 1.06 outer edges in one step: counted from the code.
  constexpr double operations = 280, bytes = 320;
  Connection c;
  const perf::Watermark memory;
  const double seconds =
      perf::timed(state, threads, [&] { c = globally_optimal(p.mesh, p.geometry, {.detail = detail}); });
  const double steps = double(p.mesh.faces()) * std::max(c.report.iterations, 1);
  state.counters["bytes/vertex"] = memory.bytes() / p.mesh.vertices();
  state.counters["ns/triangle/its"] = 1e9 * seconds / steps;
  state.counters["GFlop/s"] = 1e-9 * operations * steps / seconds;
  state.counters["GB/s"] = 1e-9 * bytes * steps / seconds;
  state.counters["its"] = c.report.iterations;
  state.counters["converged"] = c.report.converged ? 1 : 0;
  const auto force = [&](const Connection& at, Index h) {
    const Index t = Mesh::face(h), k = h - 3 * t;
    double out = 0;
    for (Index j = 0; j < 3; ++j) {
      const auto cot = [&](Index corner) { return p.geometry.cot(3 * t + corner % 3); };
      const double w = j == k             ? (cot(k) + cot(k + 1) + 3 * cot(k + 2)) / 12
                       : j == (k + 1) % 3 ? (cot(k + 1) - cot(k) - cot(k + 2)) / 12
                                          : (cot(k) - cot(k + 2) - cot(k + 1)) / 12;
      out += w * at.tau[3 * t + j];
    }
    return out;
  };
  const auto norm = [&](const Connection& at) {
    double sum = 0;
    for (Index e = 0; e < p.mesh.edges(); ++e) {
      const Index h = p.mesh.halfedge(e), g = p.mesh.twin(h);
      const double d = force(at, h) - (g == none ? 0.0 : force(at, g));
      sum += d * d;
    }
    return std::sqrt(sum);
  };
  state.counters["residual"] = norm(c) / norm(polar(p.mesh, p.geometry));
}

void declare(const perf::Plan& plan) {
  perf::add(plan, "polar", "", [](benchmark::State& state, const Prepared& p, int threads) {
    perf::timed(state, threads, [&] { benchmark::DoNotOptimize(polar(p.mesh, p.geometry)); });
  });
  for (const double detail : {1.0, 0.1, 0.01}) {
    std::string text = std::to_string(detail);
    text.erase(text.find_last_not_of("0.") + 1);
    perf::add(plan, "connection", "detail:" + text,
              [detail](benchmark::State& state, const Prepared& p, int threads) { global(state, p, threads, detail); });
  }
}

}  // namespace

int main(int argc, char** argv) { return perf::run(argc, argv, declare); }
