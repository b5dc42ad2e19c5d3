// SPDX-License-Identifier: MIT
//
// long_call.h: how Python watches and stops the library.
//
// The work runs without the interpreter's lock on a second thread, which each calling thread keeps, while the calling
// thread waits: there it handles signals, so that Ctrl-C ends the work within a tenth of a second with
// KeyboardInterrupt, and there it calls `progress`. What either raises ends the call. The work must not touch Python
// objects.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <optional>
#include <type_traits>
#include <utility>

namespace alcap::python {

namespace py = pybind11;

/// Runs the body as said above. `progress` is None or callable(phase, fraction).
void long_call(const py::object& progress, int threads, const std::function<void()>& body);

/// The same for a body with a result.
template <class Body>
auto watched(const py::object& progress, int threads, Body&& body) {
  using Result = std::invoke_result_t<Body>;
  std::optional<Result> result;
  long_call(progress, threads, [&] { result.emplace(body()); });
  return std::move(*result);
}

}  // namespace alcap::python
