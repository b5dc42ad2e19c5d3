// SPDX-License-Identifier: MIT
//
// problem.h: what is wrong with a design and where, before it becomes a FileError or an OptionError.
#pragma once

#include <string>

#include "alcap/design_file.h"

namespace alcap::detail {

struct Problem {
  std::string path;   ///< JSON pointer
  std::string value;  ///< as JSON, shortened
  std::string rule;
};

/// Throws Problem.
void check_design_values(const DesignFile& design);

/// Moves, merges and splits the singularities of a placed design, and takes the edits out.
void apply_edits(const Surface& surface, DesignFile& design);

/// The name of a control for messages: the user's, or what and where it is.
[[nodiscard]] std::string label(const DesignSingularity& s);
[[nodiscard]] std::string label(const DesignFixed& f);
[[nodiscard]] std::string label(const DesignStroke& s, std::size_t number);

}  // namespace alcap::detail
