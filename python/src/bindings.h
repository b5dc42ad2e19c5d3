// SPDX-License-Identifier: MIT
//
// bindings.h: the parts of the extension module _alcap, one file each: pybind11 compiles slowly.
#pragma once

#include <pybind11/pybind11.h>

#define ALCAP_BINDINGS(X) \
  X(errors)               \
  X(surface)              \
  X(shapes)               \
  X(intrinsic)            \
  X(connection) X(field) X(operators) X(solve) X(backends) X(curves) X(design) X(aligned) X(io) X(run) X(tables)

namespace alcap::python {

#define ALCAP_DECLARE(part) void bind_##part(pybind11::module_& m);
ALCAP_BINDINGS(ALCAP_DECLARE)
#undef ALCAP_DECLARE

}  // namespace alcap::python
