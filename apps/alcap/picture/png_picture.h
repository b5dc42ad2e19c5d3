// SPDX-License-Identifier: MIT
//
// png_picture.h: a picture of a field without a display, as the page shows it: the shaded mesh, curves on it, marks at
// singularities, balls where the index is positive and octahedra where it is negative, with their straight branches.
// Drawn by OpenGL ES 3 into memory (EGL without a surface; Mesa's software renderer where there is no graphics card).
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "alcap/mesh.h"
#include "alcap/output.h"
#include "alcap/singularities.h"
#include "alcap/streamlines.h"

namespace alcap::app::cli {
class App;
}

namespace alcap::app {

struct PictureOptions {
  std::filesystem::path file = {};    // none: no picture
  std::filesystem::path curves = {};  // polylines in the format of the extension; none: not written
  /// Where the eye is: azimuth and elevation in degrees. 0,0 looks from +z at a model whose up is +y. The default is a
  /// three-quarter view from slightly above.
  std::array<double, 2> view{30, 20};
  char up = 'y';                        // most models stand along y; scanned and CAD parts often along z
  std::array<int, 2> size{1600, 1200};  // wide enough for a slide
  /// In box diagonals: some ninety curves across a compact shape, apart from each other in a picture of this size.
  double spacing = 0.012;
};

/// What is in the picture; all of it must stay alive while it is drawn.
struct PictureScene {
  const Mesh& mesh;
  const Positions<double>& V;
  const CurveSet& curves;
  std::span<const Singularity> singularities = {};
  int n = 0;  // of the field; 0: no branches at singularities
};

/// --png, --curves, --curve-spacing, --view, --up, --png-size.
void add_picture_options(cli::App& app, PictureOptions& options);

/// Throws Failure when a picture was asked for and cannot be made here (built without, or no OpenGL at run time), or a
/// file cannot be written. Quick: meant to be called before long work.
void check_picture(const PictureOptions& options);

/// The evenly spaced curves of the picture and the file of curves; nothing when neither was asked for.
[[nodiscard]] std::optional<CurveSet> picture_curves(const FieldOutput& output, const PictureOptions& options);

/// Writes what was asked for, --curves and --png; returns the files. Throws Failure.
std::vector<std::string> write_pictures(const FieldOutput& output, const std::optional<CurveSet>& curves,
                                        const PictureOptions& options);

/// Draws and writes one picture; the file appears complete or not at all. Throws Failure.
void write_picture(const PictureScene& scene, const PictureOptions& options);

}  // namespace alcap::app
