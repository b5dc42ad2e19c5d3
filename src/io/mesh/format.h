// SPDX-License-Identifier: MIT
//
// format.h: what a mesh format has to offer. One file per format defines one of these; registry.cpp lists them.
#pragma once

#include <string_view>

#include "alcap/mesh_io.h"
#include "src/base/atomic_file.h"
#include "src/io/mesh/source.h"

namespace alcap::detail {

struct Format {
  std::string_view name;  ///< also its file extension

  /// Do these bytes look like this format? Asked in the order of the registry; cheap.
  bool (*recognise)(std::string_view bytes);

  MeshFile (*read)(const Source& source, const ReadOptions& options);

  /// Null when the format is only read. V and F have been checked.
  void (*write)(AtomicFile& file, const Positions<double>& V, const Faces& F);
};

extern const Format obj_format;
extern const Format off_format;
extern const Format ply_format;
extern const Format stl_format;

/// Appends shortest decimal numbers that read back as the same value.
void write_number(AtomicFile& file, double value);
void write_number(AtomicFile& file, std::int64_t value);

}  // namespace alcap::detail
