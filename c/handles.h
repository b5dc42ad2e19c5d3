// SPDX-License-Identifier: MIT
//
// handles.h: what the handles of alcap_c.h hold, and the guard around every function: no exception leaves.
#pragma once

#include <algorithm>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "alcap/alcap_c.h"
#include "alcap/control.h"
#include "alcap/designer.h"
#include "alcap/field_run.h"

struct alcap_surface {
  alcap::Surface surface;
};

struct alcap_run {
  alcap::ConnectedSurface surface;
  alcap::Field field;
  std::vector<int> indices;
  std::vector<alcap::Singularity> found;
  std::vector<alcap_singularity> singularities;
  std::vector<alcap::EigenReport> eigen;
  alcap_certificate certificate;
  std::string report;
};

struct alcap_designer {
  alcap::ConnectedSurface surface;
  std::unique_ptr<alcap::Designer> designer;
  std::vector<alcap_control_report> reports;
};

namespace alcap::c {

/// The exception that is being handled, as a status; fills what `error` has room for.
alcap_status caught(alcap_error* error) noexcept;

/// Runs the body and returns what became of it.
template <class Body>
alcap_status guarded(alcap_error* error, Body&& body) noexcept {
  try {
    body();
    return ALCAP_OK;
  } catch (...) {
    return caught(error);
  }
}

/// Throws OptionError for NULL.
void require(const void* pointer, const char* name);

/// A versioned struct as this library knows it: `given` where it was compiled with another header, the rest as in
/// `defaults`. NULL: the defaults. Throws OptionError for a size that cannot be.
template <class Struct>
Struct versioned(const Struct* given, const Struct& defaults, const char* name) {
  static_assert(std::is_trivially_copyable_v<Struct>);
  if (given == nullptr) return defaults;
  if (given->size < 2 * sizeof(std::uint32_t)) throw OptionError(name, given->size, "has a size that was not set");
  Struct out = defaults;
  std::memcpy(&out, given, std::min<std::size_t>(given->size, sizeof(Struct)));
  return out;
}

/// Fills a versioned struct of the caller.
template <class Struct>
void fill(Struct* out, Struct value, const char* name) {
  require(out, name);
  if (out->size < 2 * sizeof(std::uint32_t)) throw OptionError(name, out->size, "has a size that was not set");
  value.size = out->size;
  std::memcpy(out, &value, std::min<std::size_t>(out->size, sizeof(Struct)));
}

[[nodiscard]] alcap_field_options options_of(const alcap_field_options* options);
[[nodiscard]] ConnectionOptions connection_of(const alcap_field_options& options);
[[nodiscard]] RunControl watch_of(const alcap_field_options& options);
[[nodiscard]] std::string solver_of(const alcap_field_options& options);

}  // namespace alcap::c
