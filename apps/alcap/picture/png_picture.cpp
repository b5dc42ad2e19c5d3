// SPDX-License-Identifier: MIT
//
// png_picture.cpp: a picture that looks like the page of the same field (apps/viewer): its colours, its light, its
// marks.
#include "apps/alcap/picture/png_picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "apps/alcap/commands/command.h"
#include "apps/alcap/report/outputs.h"

#ifdef ALCAP_WITH_PICTURES
#include <png.h>

#include "apps/alcap/picture/png_gl.h"
#include "apps/alcap/picture/png_scene.h"
#include "apps/alcap/picture/png_shaders.h"
#endif

namespace alcap::app {

#ifndef ALCAP_WITH_PICTURES

void check_picture(const PictureOptions& options) {
  if (!options.curves.empty()) check_writable(options.curves);
  if (options.file.empty()) return;
  throw Failure(Exit::output,
                "this alcap was built without pictures. On Debian: apt-get install libegl-dev libgles-dev libpng-dev "
                "libgl1-mesa-dri, then build again",
                {{"path", options.file.string()}});
}
void write_picture(const PictureScene&, const PictureOptions& options) { check_picture(options); }

#else

namespace {

using gl::Program, gl::Target, gl::Triangles;

// Of the page's style sheet, as 0xrrggbb; the build reads them from there.
constexpr int canvas = ALCAP_PAGE_CANVAS, dark_ink = ALCAP_PAGE_INK, clay = ALCAP_PAGE_CLAY,
              clay_back = ALCAP_PAGE_CLAY_BACK, positive = ALCAP_PAGE_POSITIVE, negative = ALCAP_PAGE_NEGATIVE;

std::array<float, 3> encoded(int rgb) {
  return {static_cast<float>(rgb >> 16 & 255) / 255, static_cast<float>(rgb >> 8 & 255) / 255,
          static_cast<float>(rgb & 255) / 255};
}

/// As the shaders want them: linear (IEC 61966-2-1).
std::array<float, 3> linear(int rgb) {
  std::array<float, 3> out = encoded(rgb);
  for (float& c : out) c = c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F);
  return out;
}

class Painter {
 public:
  Painter(const PictureScene& scene, const PictureOptions& options)
      : options_(options),
        camera_(make_camera(scene, options)),
        to_eye_(camera_.to_eye.cast<float>()),
        vectors_(scene.n == 1),
        surface_(surface_vertices(scene), {3, 3}) {
    // A pixel of a page as high as most screens leave it, or of a smaller one.
    page_pixel_ = std::max(1.0, options.size[1] / 700.0);
    const double pixel = page_pixel_ * 2 * camera_.extent[1] / options.size[1];  // world units
    const MarkSizes sizes{.radius = std::clamp(0.0062 * camera_.diagonal, 3.2 * pixel, 9 * pixel),
                          .rim = 1.5 * pixel,
                          .arm = 0.022 * camera_.diagonal};
    for (std::size_t k = 0; k < 2; ++k) {
      const int sign = k == 0 ? 1 : -1;
      marks_[k] = std::make_unique<Triangles>(mark_vertices(scene, sign, sizes, false), std::vector<int>{3, 3});
      rims_[k] = std::make_unique<Triangles>(mark_vertices(scene, sign, sizes, true), std::vector<int>{3, 3});
      arms_[k] = bands(arm_bands(scene, sign, sizes));
    }
    curves_ = bands(curve_bands(scene, 2 * options.spacing * camera_.diagonal));
    GLint most = 0;
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &most);
    if (oversampling * std::max(options.size[0], options.size[1]) > most) factor_ = 1;
    glGetIntegerv(GL_MAX_SAMPLES, &samples_);
    samples_ = std::min(samples_, 4);
  }

  /// Rows from the top, three bytes a pixel.
  std::vector<unsigned char> paint() {
    const int w = factor_ * options_.size[0], h = factor_ * options_.size[1];
    const Target many(w, h, samples_);
    glViewport(0, 0, w, h);
    draw_all();
    const Target one(w, h, 0);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, many.id());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, one.id());
    glBlitFramebuffer(0, 0, w, h, 0, 0, w, h, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    one.bind();
    std::vector<unsigned char> pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * 4);
    glReadPixels(0, 0, w, h, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    return reduced(pixels);
  }

 private:
  static constexpr int oversampling = 2;  // in each direction, on top of the samples of a pixel

  static std::unique_ptr<Triangles> bands(const Bands& all) {
    return std::make_unique<Triangles>(all.vertices, std::vector<int>{3, 3, 3, 3}, all.indices);
  }

  void set_camera(const Program& program) const {
    program.use();
    glUniformMatrix4fv(program.at("camera"), 1, GL_FALSE, camera_.matrix.data());
    glUniformMatrix3fv(program.at("to_eye"), 1, GL_FALSE, to_eye_.data());
    glUniform2f(program.at("pixels"), static_cast<float>(factor_ * options_.size[0]),
                static_cast<float>(factor_ * options_.size[1]));
  }

  /// World units towards the eye as a difference of depths.
  [[nodiscard]] float lifted(double distance) const { return static_cast<float>(2 * distance / camera_.extent[2]); }

  void draw_all() const {
    const std::array<float, 3> ground = encoded(canvas);
    glClearColor(ground[0], ground[1], ground[2], 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    const Program matte(shaders::surface_vertex, shaders::surface_fragment);
    set_camera(matte);
    glUniform1f(matte.at("lift"), 0);
    glUniform3fv(matte.at("front"), 1, linear(clay).data());
    glUniform3fv(matte.at("back"), 1, linear(clay_back).data());
    surface_.draw();
    const Program lines(shaders::curve_vertex, shaders::curve_fragment);
    draw_bands(lines, *curves_, dark_ink, line_width(), 0.0016 * camera_.diagonal,
               vectors_ ? 6 * options_.spacing * camera_.diagonal : 0);
    draw_marks(lines);
  }

  /// Lines darken what they lie on, and hide nothing. `width`: pixels of the finished picture.
  void draw_bands(const Program& program, const Triangles& lines, int color, double width, double lift,
                  double period) const {
    set_camera(program);
    glUniform1f(program.at("half_width"), static_cast<float>(0.5 * width * factor_));
    glUniform1f(program.at("lift"), lifted(lift));
    glUniform1f(program.at("period"), static_cast<float>(period));
    glUniform3fv(program.at("ink"), 1, encoded(color).data());
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glDepthMask(GL_FALSE);
    lines.draw();
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
  }

  /// Straight branches, rims (the back of larger marks), marks.
  void draw_marks(const Program& lines) const {
    constexpr int colors[] = {positive, negative};
    const Program solid(shaders::surface_vertex, shaders::mark_fragment);
    const double near = 0.004 * camera_.diagonal, wide = near * options_.size[1] / (2 * camera_.extent[1]);
    for (std::size_t k = 0; k < 2; ++k)
      draw_bands(lines, *arms_[k], colors[k], std::clamp(wide, 1.6 * page_pixel_, 4 * page_pixel_), near, 0);
    glEnable(GL_CULL_FACE);
    for (const bool rim : {true, false}) {
      set_camera(solid);
      glUniform1f(solid.at("lift"), lifted(near));
      glUniform1f(solid.at("flatness"), rim ? 1 : 0);
      glCullFace(rim ? GL_FRONT : GL_BACK);
      for (std::size_t k = 0; k < 2; ++k) {
        glUniform3fv(solid.at("base"), 1, linear(rim ? 0xffffff : colors[k]).data());
        (rim ? rims_ : marks_)[k]->draw();
      }
    }
    glDisable(GL_CULL_FACE);
  }

  /// Pixels of the finished picture: a tenth of the distance of the curves, but visible and not clumsy.
  [[nodiscard]] double line_width() const {
    const double spacing = options_.spacing * camera_.diagonal * options_.size[1] / (2 * camera_.extent[1]);
    return std::clamp(0.1 * spacing, 0.8 * page_pixel_, 2.4 * page_pixel_);
  }

  [[nodiscard]] std::vector<unsigned char> reduced(const std::vector<unsigned char>& big) const {
    const int w = options_.size[0], h = options_.size[1];
    std::vector<unsigned char> out(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * 3);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        for (int c = 0; c < 3; ++c) {
          int sum = 0;
          for (int j = 0; j < factor_; ++j)
            for (int i = 0; i < factor_; ++i)
              sum += big[(static_cast<std::size_t>((h - 1 - y) * factor_ + j) * static_cast<std::size_t>(factor_ * w) +
                          static_cast<std::size_t>(x * factor_ + i)) *
                             4 +
                         static_cast<std::size_t>(c)];
          const int count = factor_ * factor_;
          out[(static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x)) * 3 +
              static_cast<std::size_t>(c)] = static_cast<unsigned char>((sum + count / 2) / count);
        }
    return out;
  }

  const PictureOptions& options_;
  Camera camera_;
  Eigen::Matrix3f to_eye_;
  bool vectors_;
  Triangles surface_;
  std::array<std::unique_ptr<Triangles>, 2> marks_, rims_, arms_;  // positive, negative
  std::unique_ptr<Triangles> curves_;
  double page_pixel_ = 1;  // in pixels of the picture
  int factor_ = oversampling;
  GLint samples_ = 0;
};

std::string encoded(const std::vector<unsigned char>& pixels, int width, int height) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  std::string bytes;
  bool good = png_image_write_get_memory_size(image, size, 0, pixels.data(), 0, nullptr) != 0;
  if (good) {
    bytes.resize(size);
    good = png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr) != 0;
    bytes.resize(size);
  }
  if (!good) throw Failure(Exit::output, fmt::format("the picture cannot be encoded: {}", image.message));
  return bytes;
}

}  // namespace

void check_picture(const PictureOptions& options) {
  if (!options.curves.empty()) check_writable(options.curves);
  if (options.file.empty()) return;
  check_writable(options.file);
  const gl::Context context;
}

void write_picture(const PictureScene& scene, const PictureOptions& options) {
  std::vector<unsigned char> pixels;
  {
    const gl::Context context;
    pixels = Painter(scene, options).paint();
    if (const GLenum error = glGetError(); error != GL_NO_ERROR)
      throw Failure(Exit::output, fmt::format("the picture cannot be drawn (OpenGL error {})", error));
  }
  write_text(options.file, encoded(pixels, options.size[0], options.size[1]));
}

#endif

}  // namespace alcap::app
