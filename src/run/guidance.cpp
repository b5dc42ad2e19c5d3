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

// Points of a guidance file may differ from those of the surface by this much, relative to the largest coordinate:
// what writing and reading single precision does to them.
constexpr double same_place = 1e-6;

ComplexVectorX<double> from_file(const ConnectedSurface& surface, const DesignFile& placed) {
  const std::filesystem::path& path = placed.guidance.file;
  const FieldFile file = read_field(path);
  const auto refuse = [&](const std::string& why) {
    throw FileError("guidance " + path.string() + ": " + why, path.string());
  };
  if (file.field.n != placed.n)
    refuse("holds a field of n = " + std::to_string(file.field.n) +
           ", and the design has n = " + std::to_string(placed.n));
  const Positions<double>& V = surface.V();
  if (V.rows() != file.V.rows() || file.F.rows() != surface.F().rows() ||
      !((V - file.V).cwiseAbs().maxCoeff() <= same_place * V.cwiseAbs().maxCoeff()))
    refuse("holds a field on another mesh; give one that was computed on this mesh");
  return on_frames(file.field, surface.frames()).u;
}

}  // namespace

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
  if (!(size > 0) || !std::isfinite(size)) {
    if (source == Source::file)
      throw FileError("guidance " + placed.guidance.file.string() + ": the field is zero or not finite everywhere",
                      placed.guidance.file.string());
    throw OptionError("/guidance/field", std::string(name(source)), "this surface has no such directions");
  }
  u /= size;
  out.scale = 1 / size;
  out.u = std::make_shared<const ComplexVectorX<double>>(std::move(u));
  return out;
}

}  // namespace alcap::detail
