// SPDX-License-Identifier: MIT
//
// errors.cpp: the library's exceptions as those of python/alcap/_errors.py, with the same attributes.
#include "alcap/errors.h"

#include <pybind11/stl.h>

#include "apps/alcap/commands/command.h"
#include "python/src/bindings.h"

namespace alcap::python {
namespace {

namespace py = pybind11;

template <class... Arguments>
void raise(const char* type, Arguments&&... arguments) {
  const py::object cls = py::module_::import("alcap._errors").attr(type);
  PyErr_SetObject(cls.ptr(), cls(std::forward<Arguments>(arguments)...).ptr());
}

void translate(std::exception_ptr pointer) {
  try {
    if (pointer) std::rethrow_exception(pointer);
  } catch (const MeshError& e) {
    raise("MeshError", e.what(), name(e.defect()), name(e.element()), e.count(), e.first());
  } catch (const OptionError& e) {
    raise("OptionError", e.what(), e.field(), e.value(), e.rule());
  } catch (const FileError& e) {
    raise("FileError", e.what(), e.path(), e.line(), e.offset());
  } catch (const SolveError& e) {
    raise("SolveError", e.what());
  } catch (const Cancelled& e) {
    raise("Cancelled", e.what());
  } catch (const Error& e) {
    raise("Error", e.what());
  } catch (const app::Failure& e) {
    raise("Error", e.what());
  }
}

}  // namespace

void bind_errors(py::module_&) { py::register_exception_translator(&translate); }

}  // namespace alcap::python
