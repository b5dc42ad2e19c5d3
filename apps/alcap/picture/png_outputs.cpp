// SPDX-License-Identifier: MIT
//
// png_outputs.cpp: the options of pictures, and the curves that a picture and a file of curves share.
#include <algorithm>

#include "apps/alcap/options/cli.h"
#include "apps/alcap/picture/png_picture.h"
#include "apps/alcap/report/outputs.h"

namespace alcap::app {
namespace {

// A higher separation than is usual: shorter curves, more even, which is what one looks at.
constexpr double evenness = 0.7;

/// Nothing for the name of a file of curves that can be written, else what is wrong.
std::string check_curve_file(const std::string& name) {
  const std::string extension = std::filesystem::path(name).extension().string();
  std::string known;
  for (const std::string& f : curve_formats()) {
    if (extension == "." + f) return {};
    known += (known.empty() ? "." : ", .") + f;
  }
  return name + ": curves are written as " + known;
}

std::string check_picture_file(const std::string& name) {
  if (std::filesystem::path(name).extension() == ".png") return {};
  return name + ": pictures are written as .png";
}

}  // namespace

void add_picture_options(cli::App& app, PictureOptions& options) {
  app.add_option("--png", options.file, "A picture of the mesh, evenly spaced curves and the singularities")
      ->type_name("FILE")
      ->check(check_picture_file)
      ->group("Picture");
  app.add_option("--curves", options.curves, "The evenly spaced curves as polylines: .vtp, .obj or .json")
      ->type_name("FILE")
      ->check(check_curve_file)
      ->group("Picture");
  app.add_option("--view", options.view, "Where the eye is: azimuth,elevation in degrees")
      ->type_name("AZ,EL")
      ->delimiter(',')
      ->capture_default_str()
      ->check(cli::Range(-360.0, 360.0))
      ->group("Picture");
  app.add_option_function<std::string>(
         "--up", [&options](const std::string& axis) { options.up = axis[0]; },
         "The axis of the mesh that points up in the picture: y (default) or z")
      ->type_name("AXIS")
      ->check(cli::IsMember({"y", "z"}))
      ->group("Picture");
  app.add_option("--png-size", options.size, "Pixels of the picture, 1600,1200 unless told")
      ->type_name("W,H")
      ->delimiter(',')
      ->check(cli::Range(16, 8192))
      ->group("Picture");
  app.add_option("--curve-spacing", options.spacing, "Distance of the curves, in diagonals of the mesh's box")
      ->type_name("D")
      ->capture_default_str()
      ->check(cli::Range(1e-4, 1.0))
      ->group("Picture");
}

std::optional<CurveSet> picture_curves(const FieldOutput& output, const PictureOptions& options) {
  if (options.file.empty() && options.curves.empty()) return std::nullopt;
  return streamlines(output.surface, output.field,
                     {.spacing = options.spacing, .separation = evenness, .min_length = 3 * options.spacing});
}

std::vector<std::string> write_pictures(const FieldOutput& output, const std::optional<CurveSet>& curves,
                                        const PictureOptions& options) {
  std::vector<std::string> files;
  if (!curves) return files;
  if (!options.curves.empty()) {
    write_guarded([&] { write_curves(*curves, output.field.n, options.curves); });
    files.push_back(options.curves.string());
  }
  if (!options.file.empty()) {
    write_picture({output.surface.mesh(), output.surface.V(), *curves, output.singularities, output.field.n}, options);
    files.push_back(options.file.string());
  }
  return files;
}

}  // namespace alcap::app
