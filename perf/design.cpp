// SPDX-License-Identifier: MIT
//
// design.cpp: editing a design live: preparing the system, the answer to a target that was turned in its face (free,
// and pinned), to one that was moved to another face, and to a stroke of 40 points that was moved. The paper reports 5
// s for the factorisation and 0.5 s for a solve at 50K triangles (LTGD 2016, Sec. 8.3).
#include "alcap/connected_surface.h"
#include "alcap/designer.h"
#include "perf/common.h"

namespace {

using namespace alcap;
using perf::Prepared;

ConnectedSurface connected(const Prepared& p) { return {Surface(p.surface.V, p.surface.F), p.connection()}; }

Designer make_designer(const ConnectedSurface& s) {
  Designer designer(s, {.n = 4, .guidance_weight = 0.1});
  (void)designer.add(SingularityTarget{.face = s.mesh().faces() / 3, .sign = -1, .orientation = 0.2});
  return designer;
}

// 40 points along edges, from vertex to vertex.
Stroke forty_points(const Prepared& p, Index start) {
  Stroke stroke;
  Index h = start;
  while (stroke.points.size() < 40) {
    SurfacePoint point{Mesh::face(h), {}};
    point.barycentric[static_cast<std::size_t>(h % 3)] = 1;
    stroke.points.push_back(point);
    // Straight on: the third halfedge that leaves the tip, counted from the way back.
    const Index back = p.mesh.twin(h);
    Index next = back == none ? Mesh::next(h) : back;
    for (int turn = 0; turn < 3 && next != none; ++turn) next = p.mesh.twin(Mesh::prev(next));
    h = next == none ? Mesh::next(h) : next;
  }
  return stroke;
}

void time_prepare(benchmark::State& state, const Prepared& p, int threads) {
  const ConnectedSurface c = connected(p);
  perf::timed(state, threads, [&] { benchmark::DoNotOptimize(make_designer(c).solve()); });
}

void time_turn(benchmark::State& state, const Prepared& p, int threads) {
  const ConnectedSurface c = connected(p);
  Designer designer = make_designer(c);
  const ControlId id = designer.add(SingularityTarget{.face = 7});
  DesignResult result = designer.solve();
  double angle = 0;
  const auto turn = [&] {
    designer.set(id, SingularityTarget{.face = 7, .orientation = angle += 0.01});
    result = designer.solve();
  };
  turn();  // from here on the target has a solution of its own
  perf::timed(state, threads, turn);
  state.counters["residual"] = result.residual;
}

void time_turn_pinned(benchmark::State& state, const Prepared& p, int threads) {
  const ConnectedSurface c = connected(p);
  Designer designer = make_designer(c);
  SingularityTarget target{.face = 7, .pin = std::array{0.3, 0.3, 0.4}};
  const ControlId id = designer.add(target);
  DesignResult result = designer.solve();
  const auto turn = [&] {
    target.orientation += 0.01;
    designer.set(id, target);
    result = designer.solve();
  };
  turn();
  perf::timed(state, threads, turn);
  state.counters["solves"] = result.solves;
}

void time_move(benchmark::State& state, const Prepared& p, int threads) {
  const ConnectedSurface c = connected(p);
  Designer designer = make_designer(c);
  const ControlId id = designer.add(SingularityTarget{.face = 7});
  DesignResult result = designer.solve();
  Index face = 0;
  const auto move = [&] {
    designer.set(id, SingularityTarget{.face = face = (face + 1) % p.mesh.faces()});
    result = designer.solve();
  };
  move();
  perf::timed(state, threads, move);
  state.counters["residual"] = result.residual;
}

void time_stroke(benchmark::State& state, const Prepared& p, int threads) {
  const ConnectedSurface c = connected(p);
  Designer designer = make_designer(c);
  Index start = 3 * (p.mesh.faces() / 2);
  const ControlId id = designer.add(forty_points(p, start));
  DesignResult result = designer.solve();
  perf::timed(state, threads, [&] {
    designer.set(id, forty_points(p, start += 3));
    result = designer.solve();
  });
  state.counters["residual"] = result.residual;
  state.counters["rows"] = result.rows;
}

void declare(const perf::Plan& plan) {
  const perf::Limits direct{.bytes_per_face = 3000};
  perf::add(plan, "design_prepare", "n:4", time_prepare, direct);
  perf::add(plan, "design_target", "n:4", time_turn, direct);
  perf::add(plan, "design_turn_pinned", "n:4", time_turn_pinned, direct);
  perf::add(plan, "design_move", "n:4", time_move, direct);
  perf::add(plan, "design_stroke", "n:4", time_stroke, direct);
}

}  // namespace

int main(int argc, char** argv) { return perf::run(argc, argv, declare); }
