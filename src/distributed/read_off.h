// SPDX-License-Identifier: MIT
//
// read_off.h: slices of OFF files with one vertex or face a line. Internal to src/distributed.
#pragma once

#include <string>
#include <string_view>

#include "src/distributed/exchange.h"
#include "src/distributed/parallel_file.h"

namespace alcap::detail::distributed {

/// What the header of an OFF file says, and where the lines behind it begin.
struct OffHeader {
  std::int64_t vertices = 0, faces = 0, body = 0;
};

/// Throws FileError. `bytes`: the beginning of the file, which starts with the word OFF.
[[nodiscard]] OffHeader read_off_header(const std::string& path, std::string_view bytes);

/// This rank's slice: every rank reads as many bytes, counts its lines, and sends what it reads to whose slice it is
/// in.
[[nodiscard]] MeshSlice read_off_slice(const std::string& path, const ParallelInput& file, const OffHeader& header);

}  // namespace alcap::detail::distributed
