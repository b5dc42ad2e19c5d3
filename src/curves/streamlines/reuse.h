// SPDX-License-Identifier: MIT
//
// reuse.h: what of earlier curves still follows a field that has changed. Internal to streamlines.
#pragma once

#include <cstdint>
#include <vector>

#include "src/curves/streamlines/chart.h"

namespace alcap::detail {

/// Points first to last of an earlier curve, all of whose segments follow the field; `open` where the curve went on.
struct KeptRun {
  std::size_t curve = 0;  ///< of the earlier set
  std::int64_t first = 0, last = 0;
  bool open_start = false, open_end = false;
};

struct Reuse {
  std::vector<KeptRun> runs;     ///< in the order of the earlier set
  std::vector<Cplx> directions;  ///< of the segment before each point, in its face
  std::vector<char> kept;        ///< whether the segment before each point is in a run
};

/// Runs no shorter than `shortest`, along which the field is within `degrees` of the direction of the curve. Throws
/// OptionError for a set that is not of this surface.
[[nodiscard]] Reuse still_followed(const Flow& flow, const CurveSet& earlier, double degrees, double shortest);

}  // namespace alcap::detail
