// SPDX-License-Identifier: MIT
//
// connected_surface.h: a surface with a connection and the frames of its vertices: what fields, operators, energies and
// designs are computed on.
//
//   alcap::ConnectedSurface connected = alcap::connect(surface);     // globally optimal, what most want
//   alcap::ConnectedSurface flat = alcap::connect(
//       surface, {.kind = alcap::ConnectionKind::trivial, .balance_cones = true, .n = 4});
//   alcap::ConnectedSurface own(surface, alcap::polar(surface));     // from any connection
//   auto result = alcap::smoothest_field(connected, {.n = 4});
//
// As Surface, a handle on immutable parts: cheap to copy, and safe for several threads at once. It is a Surface, and
// may be given wherever one is asked for.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "alcap/connection.h"
#include "alcap/frames.h"
#include "alcap/surface.h"

namespace alcap {

/// A surface, a connection on it and, when asked for, the frames of its vertices.
class ConnectedSurface : public Surface {
 public:
  /// No surface; only good for being assigned to.
  ConnectedSurface() = default;

  /// Throws OptionError when the connection is not one of this surface's mesh (its arrays have other sizes).
  ConnectedSurface(Surface surface, Connection connection);

  /// The surface without its connection.
  [[nodiscard]] const Surface& surface() const { return *this; }
  /// The connection.
  [[nodiscard]] const Connection& connection() const { return connected_->connection; }

  /// Frames of the vertices, computed when they are first asked for (vertex_frames, O(V)); always the same object.
  /// Throws OptionError on a surface that lies in no space.
  [[nodiscard]] std::shared_ptr<const Frames> frames() const;

 private:
  struct Connected {
    Connection connection;
    std::once_flag frames_once;
    std::shared_ptr<const Frames> frames;
  };
  std::shared_ptr<Connected> connected_;
};

/// Which connection, with what it is made from.
struct ConnectionOptions {
  ConnectionKind kind = ConnectionKind::global;  // the most accurate one, at O(V) cost
  PolarOptions polar = {};                       // read when kind is polar
  GlobalOptions global = {};     // of global, trivial and metric; its weights also measure D_T and D_E of all kinds
  std::vector<Cone> cones = {};  // of trivial and metric: they must sum to the Euler characteristic
  bool balance_cones = false;    // of trivial: they are added until they do, see cones.h
  std::vector<double> generator_holonomy = {};  // of trivial and metric, see TrivialOptions and MetricOptions
  std::vector<double> loop_index = {};          // of trivial and metric, see TrivialOptions and MetricOptions
  int n = 1;  // of trivial: cones and holonomies are multiples of 1/n turn, the degree of the fields it is for
  /// Of metric: nearest_connection() to this target instead of cones and holonomies.
  ConnectionTarget target = {};
  bool spread = true;  // of metric with a target, see NearestOptions
};

/// The connection that the options describe, on the surface. The cones of a trivial one, those that were added
/// included, are in its connection().cones. Throws OptionError as the function of connection.h for this kind does.
[[nodiscard]] ConnectedSurface connect(const Surface& surface, const ConnectionOptions& options = {});

}  // namespace alcap
