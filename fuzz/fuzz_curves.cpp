// SPDX-License-Identifier: MIT
//
// Curves of any field on any small mesh end, within their budget, with finite points.
#include "alcap/connected_surface.h"
#include "alcap/errors.h"
#include "alcap/streamlines.h"
#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace alcap;
  fuzz::Bytes in(data, size);
  const int n = 1 + in.below(6);
  const MeshData m = fuzz::small_mesh(in);
  try {
    const ConnectedSurface surface = connect(Surface(m.V, m.F), {.kind = ConnectionKind::local});
    Field field{.n = n, .u = ComplexVectorX<double>(m.V.rows()), .frames = surface.frames()};
    for (Eigen::Index v = 0; v < m.V.rows(); ++v) field.u[v] = {in.real(), in.real()};
    const StreamlineOptions options{.spacing = 0.05 * in.scale(1), .max_points = 3'000};
    const CurveSet even = streamlines(surface, field, options);
    const CurveSet leaving = separatrices(surface, field, find_singularities(surface, field), options);
    for (const CurveSet* c : {&even, &leaving}) {
      fuzz::demand(c->points.allFinite(), "points are finite");
      fuzz::demand(c->points.rows() <= options.max_points + 4 * c->size(), "curves have a budget");
    }
  } catch (const Error&) {
  }
  return 0;
}
