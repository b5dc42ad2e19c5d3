// SPDX-License-Identifier: MIT
//
// module.cpp: the extension module. What users call is in python/alcap; this is the thin layer below it.
#include "alcap/memory.h"
#include "alcap/version.h"
#include "python/src/bindings.h"

PYBIND11_MODULE(_alcap, m) {
  m.doc() = "The compiled part of alcap: use the package alcap.";
  m.attr("__version__") = alcap::version();
  m.def("peak_memory_bytes", &alcap::peak_memory_bytes);
#define ALCAP_BIND(part) alcap::python::bind_##part(m);
  ALCAP_BINDINGS(ALCAP_BIND)
#undef ALCAP_BIND
}
