// SPDX-License-Identifier: MIT
//
// connected_surface.cpp: a surface with its connection, and the functions of connection.h, cones.h and frames.h on
// surfaces.
#include "alcap/connected_surface.h"

#include <string>
#include <utility>

#include "alcap/cones.h"
#include "src/base/parallel.h"

namespace alcap {

ConnectedSurface::ConnectedSurface(Surface surface, Connection connection) : Surface(std::move(surface)) {
  const auto require = [](const char* array, std::int64_t size, std::int64_t needed) {
    if (size != needed)
      throw OptionError(std::string("connection.") + array, std::to_string(size) + " entries",
                        "is not of this mesh, which has " + std::to_string(needed));
  };
  require("rho", connection.rho.size(), mesh().edges());
  require("rho_t", connection.rho_t.size(), mesh().halfedges());
  require("K", connection.K.size(), mesh().faces());
  connected_ = std::make_shared<Connected>();
  connected_->connection = std::move(connection);
}

std::shared_ptr<const Frames> ConnectedSurface::frames() const {
  const Positions<double>& points = positions();
  std::call_once(connected_->frames_once, [&] {
    run_isolated([&] {
      connected_->frames = std::make_shared<const Frames>(vertex_frames(mesh(), points, geometry(), connection()));
    });
  });
  return connected_->frames;
}

namespace {

Connection make_metric(const Surface& surface, const ConnectionOptions& options) {
  if (options.balance_cones)
    throw OptionError("balance_cones", "true", "cones that need not be multiples of 1/n cannot be balanced by them");
  if (options.target.levi_civita())
    return metric_connection(
        surface, options.cones,
        {.generator_holonomy = options.generator_holonomy, .loop_index = options.loop_index, .global = options.global});
  if (!options.cones.empty() || !options.generator_holonomy.empty() || !options.loop_index.empty())
    throw OptionError("target", "with cones or holonomies", "a target says everything; give one or the other");
  return nearest_connection(surface, options.target, {.spread = options.spread, .global = options.global});
}

Connection make_connection(const Surface& surface, const ConnectionOptions& options) {
  switch (options.kind) {
    case ConnectionKind::global:
      return globally_optimal(surface, options.global);
    case ConnectionKind::local:
      return locally_optimal(surface);
    case ConnectionKind::polar:
      return polar(surface, options.polar);
    case ConnectionKind::metric:
      return make_metric(surface, options);
    case ConnectionKind::trivial:
      break;
  }
  return trivial(surface,
                 options.balance_cones ? balance_cones(surface, options.cones, {.n = options.n}) : options.cones,
                 {.n = options.n,
                  .generator_holonomy = options.generator_holonomy,
                  .loop_index = options.loop_index,
                  .global = options.global});
}

}  // namespace

ConnectedSurface connect(const Surface& surface, const ConnectionOptions& options) {
  Connection connection = make_connection(surface, options);
  // Those two have measured themselves with the default weights, the others with these.
  if (options.kind == ConnectionKind::local || options.kind == ConnectionKind::polar)
    measure_deviation(surface.mesh(), surface.geometry(), options.global, connection);
  return {surface, std::move(connection)};
}

Connection polar(const Surface& surface, const PolarOptions& options) {
  return polar(surface.mesh(), surface.geometry(), options);
}

Connection locally_optimal(const Surface& surface) { return locally_optimal(surface.mesh(), surface.geometry()); }

Connection globally_optimal(const Surface& surface, const GlobalOptions& options) {
  return globally_optimal(surface.mesh(), surface.geometry(), options);
}

Connection trivial(const Surface& surface, const std::vector<Cone>& cones, const TrivialOptions& options) {
  return trivial(surface.mesh(), surface.geometry(), cones, options);
}

Connection metric_connection(const Surface& surface, const std::vector<Cone>& cones, const MetricOptions& options) {
  return metric_connection(surface.mesh(), surface.geometry(), cones, options);
}

Connection nearest_connection(const Surface& surface, const ConnectionTarget& target, const NearestOptions& options) {
  return nearest_connection(surface.mesh(), surface.geometry(), target, options);
}

double holonomy(const ConnectedSurface& surface, const Loop& strip) {
  return holonomy(surface.mesh(), surface.geometry(), surface.connection(), strip);
}

std::vector<Cone> balance_cones(const Surface& surface, const std::vector<Cone>& cones, const BalanceOptions& options) {
  return balance_cones(surface.mesh(), surface.geometry(), cones, options);
}

Frames face_frames(const Surface& surface) { return face_frames(surface.mesh(), surface.positions()); }

}  // namespace alcap
