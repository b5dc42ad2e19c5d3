// SPDX-License-Identifier: MIT
//
// connected_surface.h: a surface with a connection and the frames of its vertices: what fields, operators, energies and
// designs are computed on.
//
//   alcap::ConnectedSurface connected(surface, alcap::globally_optimal(surface));
//   auto result = alcap::smoothest_field(connected, {.n = 4});
//
// As Surface, a handle on immutable parts: cheap to copy, and safe for several threads at once.
#pragma once

#include <memory>
#include <mutex>
#include <utility>

#include "alcap/connection.h"
#include "alcap/frames.h"
#include "alcap/surface.h"

namespace alcap {

class ConnectedSurface {
 public:
  /// No surface; only good for being assigned to.
  ConnectedSurface() = default;

  /// Throws OptionError when the connection is not one of this surface's mesh (its arrays have other sizes).
  ConnectedSurface(Surface surface, Connection connection);

  [[nodiscard]] const Surface& surface() const { return parts_->surface; }
  [[nodiscard]] const Connection& connection() const { return parts_->connection; }

  /// Frames of the vertices, computed when they are first asked for (vertex_frames, O(V)). Throws OptionError on a
  /// surface that lies in no space.
  [[nodiscard]] std::shared_ptr<const Frames> frames() const;

  [[nodiscard]] bool in_space() const { return surface().in_space(); }
  [[nodiscard]] const Positions<double>& V() const { return surface().V(); }
  [[nodiscard]] const Faces& F() const { return surface().F(); }
  [[nodiscard]] const Mesh& mesh() const { return surface().mesh(); }
  [[nodiscard]] const Geometry& geometry() const { return surface().geometry(); }
  [[nodiscard]] const Topology& topology() const { return surface().topology(); }

 private:
  struct Parts {
    Surface surface;
    Connection connection;
    std::once_flag frames_once;
    std::shared_ptr<const Frames> frames;
  };
  std::shared_ptr<Parts> parts_;
};

}  // namespace alcap
