// SPDX-License-Identifier: MIT
//
// surface.cpp: surfaces of the C interface.
#include <span>

#include "alcap/mesh_io.h"
#include "c/handles.h"

namespace alcap::c {
namespace {

/// 3 numbers a row, checked before the product can overflow.
template <class T>
std::span<const T> rows(const T* data, std::int64_t count, const char* name) {
  if (count < 0 || count > (std::int64_t{1} << 31))
    throw OptionError(name, count, "must be a number of rows, in [0, 2^31]");
  if (count > 0) require(data, name);
  return {data, static_cast<std::size_t>(3 * count)};
}

}  // namespace
}  // namespace alcap::c

using alcap::c::guarded;
using alcap::c::require;

extern "C" {

alcap_status alcap_surface_create(const double* V, std::int64_t vertices, const std::int32_t* F, std::int64_t faces,
                                  alcap_surface** surface, alcap_error* error) {
  return guarded(error, [&] {
    require(surface, "surface");
    *surface = nullptr;
    const auto points = alcap::c::rows(V, vertices, "vertices");
    const auto triangles = alcap::c::rows(F, faces, "faces");
    *surface = new alcap_surface{alcap::Surface(points, triangles)};
  });
}

alcap_status alcap_surface_read(const char* path, alcap_surface** surface, alcap_error* error) {
  return guarded(error, [&] {
    require(surface, "surface");
    *surface = nullptr;
    require(path, "path");
    alcap::MeshFile file = alcap::read_mesh(path);
    *surface = new alcap_surface{alcap::Surface(std::move(file.V), std::move(file.F))};
  });
}

void alcap_surface_free(alcap_surface* surface) { delete surface; }

std::int64_t alcap_surface_vertices(const alcap_surface* s) { return s != nullptr ? s->surface.mesh().vertices() : 0; }
std::int64_t alcap_surface_faces(const alcap_surface* s) { return s != nullptr ? s->surface.mesh().faces() : 0; }
std::int64_t alcap_surface_euler(const alcap_surface* s) { return s != nullptr ? s->surface.topology().euler() : 0; }
const double* alcap_surface_V(const alcap_surface* s) { return s != nullptr ? s->surface.V().data() : nullptr; }
const std::int32_t* alcap_surface_F(const alcap_surface* s) { return s != nullptr ? s->surface.F().data() : nullptr; }
}
