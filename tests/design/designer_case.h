// SPDX-License-Identifier: MIT
//
// designer_case.h: a surface on which tests design.
#pragma once

#include "alcap/designer.h"
#include "tests/support/mesh_case.h"

namespace alcap::test {

struct DesignerCase : ConnectedCase {
  using ConnectedCase::ConnectedCase;
  [[nodiscard]] Designer designer(const DesignerOptions& options) const { return Designer(connected(), options); }
};

}  // namespace alcap::test
