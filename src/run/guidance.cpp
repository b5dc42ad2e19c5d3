// SPDX-License-Identifier: MIT
//
// guidance.cpp: the field that a design is to stay close to.
#include <algorithm>
#include <cmath>

#include "alcap/alignment.h"
#include "alcap/output.h"
#include "alcap/smoothest.h"
#include "src/run/design_stages.h"

namespace alcap::detail {
namespace {

using Source = DesignGuidance::Source;

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
  throw FileError("guidance " + path.string() + ": " + why, path.string());
}

ComplexVectorX<double> from_file(const ConnectedSurface& surface, const DesignFile& placed) {
  const std::filesystem::path& path = placed.guidance.file;
  const FieldFile file = read_field(path);
  if (file.field.n != placed.n) throw_other_degree(path, file.field.n, placed.n);
  const Positions<double>& V = surface.V();
  if (V.rows() != file.V.rows() || file.F.rows() != surface.F().rows() ||
      !((V - file.V).cwiseAbs().maxCoeff() <= same_place * V.cwiseAbs().maxCoeff()))
    throw_other_mesh(path);
  return on_frames(file.field, surface.frames()).u;
}

}  // namespace

void throw_other_degree(const std::filesystem::path& path, int found, int wanted) {
  refuse(path, "holds a field of n = " + std::to_string(found) + ", and the design has n = " + std::to_string(wanted));
}

void throw_other_mesh(const std::filesystem::path& path) {
  refuse(path, "holds a field on another mesh; give one that was computed on this mesh");
}

void throw_no_directions(const DesignGuidance& guidance, Source source) {
  if (source == Source::file) refuse(guidance.file, "the field is zero or not finite everywhere");
  throw OptionError("/guidance/field", std::string(name(source)), "this surface has no such directions");
}

ScaledGuidance find_guidance(const ConnectedSurface& surface, const DesignFile& placed, Source source,
                             const std::string& solver) {
  ScaledGuidance out;
  ComplexVectorX<double> u;
  switch (source) {
    case Source::nothing:
    case Source::zero:
      return out;
    case Source::smoothest: {
      SmoothestResult smooth = smoothest_field(surface, {.n = placed.n, .s = placed.s, .eigen = {.solver = solver}});
      out.converged = std::all_of(smooth.components.begin(), smooth.components.end(),
                                  [](const EigenReport& e) { return e.converged; });
      u = std::move(smooth.field.u);
      break;
    }
    case Source::curvature:
    case Source::least_curvature:
    case Source::strongest_curvature:
      u = curvature_field(surface, {.n = placed.n,
                                    .smallest = source == Source::least_curvature,
                                    .by_magnitude = source == Source::strongest_curvature})
              .u;
      break;
    case Source::file:
      u = from_file(surface, placed);
      break;
  }
  const double size = root_mean_square(surface, u);
  if (!(size > 0) || !std::isfinite(size)) throw_no_directions(placed.guidance, source);
  u /= size;
  out.scale = 1 / size;
  out.u = std::make_shared<const ComplexVectorX<double>>(std::move(u));
  return out;
}

}  // namespace alcap::detail
