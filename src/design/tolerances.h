// SPDX-License-Identifier: MIT
//
// tolerances.h: which ControlTolerances there may be. Internal, of designs and runs.
#pragma once

#include <array>
#include <string>

#include "alcap/controls.h"
#include "alcap/errors.h"

namespace alcap::detail {

/// Throws OptionError for one that is not in its range.
inline void check_tolerances(const ControlTolerances& tolerances) {
  struct Kind {
    const char* field;
    double value;
    bool degrees;  // else relative
  };
  const std::array<Kind, 7> kinds{{{"singularity_degrees", tolerances.singularity_degrees, true},
                                   {"fixed_degrees", tolerances.fixed_degrees, true},
                                   {"stroke_degrees", tolerances.stroke_degrees, true},
                                   {"boundary_degrees", tolerances.boundary_degrees, true},
                                   {"cone_degrees", tolerances.cone_degrees, true},
                                   {"fixed_value", tolerances.fixed_value, false},
                                   {"pin_length", tolerances.pin_length, false}}};
  for (const Kind& kind : kinds)
    if (!(kind.value > 0 && kind.value <= (kind.degrees ? 180 : 1)))
      throw OptionError(std::string("tolerances.") + kind.field, kind.value,
                        kind.degrees ? "must be in (0, 180], degrees" : "must be in (0, 1]");
}

}  // namespace alcap::detail
