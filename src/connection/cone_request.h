// SPDX-License-Identifier: MIT
//
// cone_request.h: what cones and boundary loops are asked for, and whether a surface can have it: on one machine and
// over several ranks. Internal to src/connection and src/distributed.
#pragma once

#include <cstdint>
#include <vector>

#include "alcap/connection.h"
#include "src/connection/cone_index.h"

namespace alcap::detail {

/// What is asked for. n = 0: cones, holonomies and indices of any size.
struct ConeRequest {
  const std::vector<Cone>& cones;
  int n;
  const std::vector<double>& loop_index;  ///< empty: free

  [[nodiscard]] bool any() const { return n == 0; }
  /// Throws OptionError unless `turns` can be asked for.
  void check(const char* field, double turns) const {
    check_turns(field, turns);
    if (!any()) check_multiple(field, turns, n);
  }
};

/// What of a surface decides whether it can be had.
struct ConeSurface {
  std::int64_t vertices = 0;
  std::vector<double> euler = {};          ///< of each component
  std::vector<Index> loop_component = {};  ///< of each boundary loop
};

/// Where the vertex of a cone lies.
struct ConePlace {
  Index component = none;  ///< `none`: no face uses it
  bool boundary = false;
};

/// Throws OptionError unless every component's sum of indices can be met. places: of each cone; any for vertices that
/// do not exist.
void check_cones(const ConeRequest& request, const ConeSurface& surface, const std::vector<ConePlace>& places);

/// Loop indices: multiples of 1/n nearest to `turns` whose sum over each component is what the cones leave. Throws
/// SolveError for turns that are not finite.
[[nodiscard]] std::vector<double> round_loops(const ConeRequest& request, const ConeSurface& surface,
                                              const std::vector<ConePlace>& places, const std::vector<double>& turns);

}  // namespace alcap::detail
