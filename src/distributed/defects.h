// SPDX-License-Identifier: MIT
//
// defects.h: what is wrong with a mesh, put together from what several ranks see of it. Internal to src/distributed.
#pragma once

#include <cstdint>
#include <vector>

#include "alcap/errors.h"

namespace alcap::detail::distributed {

/// A defect in users' numbers: the first elements that one rank saw, and how many it saw.
struct NamedDefect {
  Defect defect;
  Element element;
  std::int64_t count;
  std::vector<std::int32_t> first;
};

/// Throws MeshError for the kind of defect that one machine would name first, with the elements of all ranks.
[[noreturn]] void throw_first_defect(const std::vector<NamedDefect>& seen);

}  // namespace alcap::detail::distributed
