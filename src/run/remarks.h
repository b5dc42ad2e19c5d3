// SPDX-License-Identifier: MIT
//
// remarks.h: remarks that fields and designs share. Internal to run.
#pragma once

#include <string>

#include "alcap/field_run.h"

namespace alcap::detail {

/// About a flat connection whose cones or holonomies are not multiples of 1/n.
[[nodiscard]] inline Remark not_parallel(int n) {
  return {.code = "no_parallel_field",
          .warning = false,
          .message = "cones or holonomies of this connection are not multiples of 1/" + std::to_string(n) +
                     ": no field of this degree is parallel to it, and the result turns gently everywhere instead"};
}

}  // namespace alcap::detail
