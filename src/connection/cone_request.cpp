// SPDX-License-Identifier: MIT
#include "src/connection/cone_request.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "src/base/array.h"
#include "src/base/numbers.h"

namespace alcap::detail {
namespace {

// How far sums of indices that are no multiples of anything may be off, in turns.
constexpr double turn_tolerance = 1e-6;

// What the indices of a component sum to and should; throws unless it can be met.
void check_sum(const ConeRequest& request, std::size_t component, double euler, double sum) {
  const double missing = euler - sum;
  if (std::abs(missing) * std::max(1, request.n) <= (request.any() ? turn_tolerance : multiple_tolerance)) return;
  const auto shown = [&](double turns) { return request.any() ? turns : nearest_multiple(turns, request.n); };
  throw OptionError("cones", shown(sum),
                    "the indices of component " + std::to_string(component) + " must sum to its Euler characteristic " +
                        number_text(euler) + "; " + number_text(shown(missing)) + " is missing");
}

void check_cone_place(const ConeRequest& request, const ConeSurface& surface, const Cone& cone,
                      const ConePlace& place) {
  const std::string name = std::to_string(cone.vertex);
  if (cone.vertex < 0 || cone.vertex >= surface.vertices)
    throw OptionError("cones", name, "there is no such vertex; the mesh has " + std::to_string(surface.vertices));
  if (place.component == none) throw OptionError("cones", name, "no face uses this vertex");
  if (place.boundary)
    throw OptionError("cones", name, "this vertex lies on the boundary; give its loop an index instead");
  request.check("cones", cone.index);
}

}  // namespace

void check_cones(const ConeRequest& request, const ConeSurface& surface, const std::vector<ConePlace>& places) {
  std::vector<double> sum(surface.euler.size(), 0.0);
  for (std::size_t k = 0; k < request.cones.size(); ++k) {
    check_cone_place(request, surface, request.cones[k], places[k]);
    sum[at(places[k].component)] += request.cones[k].index;
  }
  std::vector<char> open(surface.euler.size(), 0);
  for (const Index c : surface.loop_component) open[at(c)] = 1;
  if (!request.loop_index.empty()) {
    if (request.loop_index.size() != surface.loop_component.size())
      throw OptionError("loop_index", std::to_string(request.loop_index.size()) + " entries",
                        "needs one per boundary loop, " + std::to_string(surface.loop_component.size()));
    for (std::size_t l = 0; l < surface.loop_component.size(); ++l) {
      request.check("loop_index", request.loop_index[l]);
      sum[at(surface.loop_component[l])] += request.loop_index[l];
    }
  }
  for (std::size_t c = 0; c < sum.size(); ++c)
    if (open[c] == 0 || !request.loop_index.empty()) check_sum(request, c, surface.euler[c], sum[c]);
}

std::vector<double> round_loops(const ConeRequest& request, const ConeSurface& surface,
                                const std::vector<ConePlace>& places, const std::vector<double>& turns) {
  const int n = request.n;
  std::vector<double> rounded_turns(turns.size()), missing = surface.euler;
  std::vector<std::vector<std::size_t>> loops(missing.size());
  for (std::size_t k = 0; k < places.size(); ++k) missing[at(places[k].component)] -= request.cones[k].index;
  for (std::size_t l = 0; l < turns.size(); ++l) {
    const std::size_t c = at(surface.loop_component[l]);
    loops[c].push_back(l);
    missing[c] -= rounded_turns[l] = nearest_multiple(turns[l], n);
  }
  for (std::size_t c = 0; c < loops.size(); ++c) {
    if (loops[c].empty()) continue;
    // Whole steps of 1/n are left over, fewer than there are loops unless the cones take far too much. They are spread
    // evenly, and the last ones go where rounding went furthest the other way.
    const auto steps = rounded<std::int64_t>(missing[c] * n);
    if (!steps)
      throw SolveError(
          "the boundary loops have no finite turns: the mesh is too far from regular triangles; Repair::mollify or an "
          "intrinsic triangulation helps");
    const std::int64_t count = count_of(loops[c]), even = *steps / count, rest = *steps % count;
    const double step = rest > 0 ? 1.0 : -1.0;
    std::stable_sort(loops[c].begin(), loops[c].end(), [&](std::size_t i, std::size_t j) {
      return step * (turns[i] - rounded_turns[i]) > step * (turns[j] - rounded_turns[j]);
    });
    for (std::int64_t k = 0; k < count; ++k)
      rounded_turns[loops[c][at(k)]] += (double(even) + (k < std::abs(rest) ? step : 0.0)) / n;
  }
  return rounded_turns;
}

}  // namespace alcap::detail
