// SPDX-License-Identifier: MIT
//
// remarks.h: remarks that fields and designs share, on one machine and over ranks. Internal to run and distributed.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "alcap/field_run.h"

namespace alcap::detail {

/// About a flat connection whose cones or holonomies are not multiples of 1/n.
[[nodiscard]] inline Remark not_parallel(int n) {
  return {.code = "no_parallel_field",
          .warning = false,
          .message = "cones or holonomies of this connection are not multiples of 1/" + std::to_string(n) +
                     ": no field of this degree is parallel to it, and the result turns gently everywhere instead"};
}

/// What became of a field, as its remarks see it.
struct FieldOutcome {
  const ConnectionReport& connection;
  bool parallel = true;  ///< false: flat, and without parallel fields of this degree
  int n = 1;
  std::span<const EigenReport> eigen;               ///< of each component
  std::function<bool(const EigenReport&)> reached;  ///< whether its residuals are within what was asked for
  std::span<const IndexSum> index_sums;             ///< of each component
  bool finite = true;
};

/// What did not come out as asked for, and what is not unique.
void outcome_remarks(const FieldOutcome& run, std::vector<Remark>& remarks);

}  // namespace alcap::detail
