// SPDX-License-Identifier: MIT
//
// Trivial, metric and nearest connections with any cones, holonomies and indices of loops: one that is flat where it
// says so, or one of the library's exceptions.
#include <cmath>

#include "alcap/cones.h"
#include "alcap/connected_surface.h"
#include "alcap/errors.h"
#include "alcap/topology.h"
#include "fuzz/input.h"

namespace {

using namespace alcap;

std::vector<double> turns(fuzz::Bytes& in, std::size_t count, int n) {
  if (in.below(2) == 0) return {};
  std::vector<double> out(in.below(8) == 0 ? count + 1 : count);
  for (double& t : out) t = in.below(3) == 0 ? in.real() * in.scale(3) : double(in.below(9) - 4) / n;
  return out;
}

Connection make(fuzz::Bytes& in, const Surface& surface) {
  const int n = 1 + in.below(6);
  std::vector<Cone> cones;
  for (int k = in.below(5); k > 0; --k) {
    const int vertex = in.below(static_cast<int>(surface.mesh().vertices()) + 1);
    cones.push_back({static_cast<Index>(vertex), in.below(4) == 0 ? in.real() : double(in.below(9) - 4) / n});
  }
  const int kind = in.below(4);
  if (kind == 0) {
    ConnectionTarget target;
    target.vertex_curvature = VectorX<double>(surface.mesh().vertices());
    for (double& k : target.vertex_curvature) k = in.real();
    target.vertex_curvature.array() +=
        (4 * std::acos(0.0) * double(surface.topology().euler()) - target.vertex_curvature.sum()) /
        double(surface.mesh().vertices());
    return nearest_connection(surface, target, {.spread = in.below(2) == 0});
  }
  const std::size_t generators = homology_generators(surface).size(), loops = surface.topology().loops.size();
  const std::vector<double> holonomy = turns(in, generators, n), index = turns(in, loops, n);
  if (kind == 1) return metric_connection(surface, cones, {.generator_holonomy = holonomy, .loop_index = index});
  if (kind == 2) cones = balance_cones(surface, cones, {.n = n});
  return trivial(surface, cones, {.n = n, .generator_holonomy = holonomy, .loop_index = index});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes in(data, size);
  const MeshData m = fuzz::small_mesh(in);
  try {
    const Surface surface(m.V, m.F);
    const ConnectedSurface connected(surface, make(in, surface));
    const Connection& c = connected.connection();
    fuzz::demand(c.rho.allFinite() && c.rho_e.allFinite() && c.K.allFinite(), "a connection is finite");
    (void)connected.frames();
  } catch (const Error&) {
  }
  return 0;
}
