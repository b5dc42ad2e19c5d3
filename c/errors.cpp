// SPDX-License-Identifier: MIT
//
// errors.cpp: exceptions as codes and messages; options as the library's.
#include "alcap/version.h"
#include "c/handles.h"

namespace alcap::c {
namespace {

template <std::size_t room>
void copy(char (&to)[room], std::string_view from) {  // NOLINT(modernize-avoid-c-arrays): a member of a C struct
  std::size_t length = std::min(from.size(), room - 1);
  // Not in the middle of a character of UTF-8.
  while (length > 0 && length < from.size() && (static_cast<unsigned char>(from[length]) & 0xc0U) == 0x80U) --length;
  std::memcpy(to, from.data(), length);
  to[length] = '\0';
}

void describe(alcap_error& out) {
  try {
    throw;
  } catch (const MeshError& e) {
    out.status = ALCAP_BAD_MESH;
    out.count = e.count();
    copy(out.defect, name(e.defect()));
    copy(out.element, name(e.element()));
    out.first_count = static_cast<std::int32_t>(std::min(e.first().size(), std::size(out.first)));
    std::copy_n(e.first().begin(), out.first_count, out.first);
    copy(out.message, e.what());
  } catch (const OptionError& e) {
    out.status = ALCAP_BAD_OPTION;
    copy(out.field, e.field());
    copy(out.message, e.what());
  } catch (const FileError& e) {
    out.status = ALCAP_BAD_FILE;
    copy(out.message, e.what());
  } catch (const SolveError& e) {
    out.status = ALCAP_SOLVE_ERROR;
    copy(out.message, e.what());
  } catch (const Cancelled& e) {
    out.status = ALCAP_CANCELLED;
    copy(out.message, e.what());
  } catch (const std::bad_alloc&) {
    out.status = ALCAP_NO_MEMORY;
    copy(out.message, "memory ran out");
  } catch (const std::exception& e) {
    out.status = ALCAP_INTERNAL;
    copy(out.message, e.what());
  } catch (...) {
    out.status = ALCAP_INTERNAL;
    copy(out.message, "an exception that is not a std::exception was thrown");
  }
}

}  // namespace

alcap_status caught(alcap_error* error) noexcept {
  alcap_error out = ALCAP_ERROR_INIT;
  describe(out);
  if (error != nullptr && error->size >= 2 * sizeof(std::uint32_t)) {
    out.size = error->size;
    std::memcpy(error, &out, std::min<std::size_t>(error->size, sizeof(out)));
  }
  return static_cast<alcap_status>(out.status);
}

void require(const void* pointer, const char* name) {
  if (pointer == nullptr) throw OptionError(name, "NULL", "must be given");
}

alcap_field_options options_of(const alcap_field_options* options) {
  return versioned(options, alcap_field_options(ALCAP_FIELD_OPTIONS_INIT), "options");
}

ConnectionOptions connection_of(const alcap_field_options& options) {
  ConnectionOptions out;
  switch (options.connection) {
    case ALCAP_CONNECTION_GLOBAL:
      out.kind = ConnectionKind::global;
      break;
    case ALCAP_CONNECTION_LOCAL:
      out.kind = ConnectionKind::local;
      break;
    case ALCAP_CONNECTION_POLAR:
      out.kind = ConnectionKind::polar;
      break;
    default:
      throw OptionError("connection", options.connection, "is not a value of alcap_connection_kind");
  }
  if (options.detail != 0) out.global.detail = options.detail;
  out.n = options.n;
  return out;
}

RunControl watch_of(const alcap_field_options& options) {
  RunControl control;
  if (options.cancel != nullptr)
    control.cancel = [ask = options.cancel, user = options.user] { return ask(user) != 0; };
  if (options.progress != nullptr)
    control.progress = [tell = options.progress, user = options.user](std::string_view phase, double fraction) {
      tell(std::string(phase).c_str(), fraction, user);
    };
  control.threads = options.threads;
  return control;
}

std::string solver_of(const alcap_field_options& options) {
  return options.solver != nullptr ? options.solver : "auto";
}

}  // namespace alcap::c

extern "C" {

const char* alcap_version_string(void) { return alcap::version(); }
std::uint32_t alcap_c_version(void) { return ALCAP_C_VERSION; }
}
