// SPDX-License-Identifier: MIT
//
// png_picture.cpp: the passes of a picture, from depths and normals to occlusion, colours and the file.
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

using gl::Program, gl::Target, gl::Texture, gl::Triangles;

/// Red, green, blue (as in #rrggbb) as the shaders want them: linear.
std::array<float, 3> linear(int rgb) {
  std::array<float, 3> out{};
  for (std::size_t c = 0; c < 3; ++c)
    out[c] = static_cast<float>(std::pow(((rgb >> (16 - 8 * static_cast<int>(c))) & 255) / 255.0, 2.2));
  return out;
}

// Colours that people who do not see red and green apart can tell (Okabe and Ito 2008).
constexpr int clay = 0xd8d4cc, positive = 0xd55e00, negative = 0x0072b2;

class Painter {
 public:
  Painter(const PictureScene& scene, const PictureOptions& options)
      : options_(options),
        camera_(make_camera(scene, options)),
        to_eye_(camera_.to_eye.cast<float>()),
        surface_(surface_vertices(scene), {3, 3}),
        plus_(ball_vertices(scene, 1, ball_radius()), {3, 3}),
        minus_(ball_vertices(scene, -1, ball_radius()), {3, 3}) {
    const Bands bands = curve_bands(scene, 2 * options.spacing * camera_.diagonal);
    curves_ = std::make_unique<Triangles>(bands.vertices, std::vector<int>{3, 3, 3, 2}, bands.indices);
    GLint most = 0;
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &most);
    if (oversampling * std::max(options.size[0], options.size[1]) > most) factor_ = 1;
    glGetIntegerv(GL_MAX_SAMPLES, &samples_);
    samples_ = std::min(samples_, 4);
  }

  /// Rows from the top, three bytes a pixel.
  std::vector<unsigned char> paint() {
    const int w = options_.size[0], h = options_.size[1];
    const Texture depth(w, h, true), normals(w, h, false), open(w, h, false), half_blurred(w, h, false);
    glViewport(0, 0, w, h);
    glEnable(GL_DEPTH_TEST);
    {
      const Program program(shaders::surface_vertex, shaders::normals_fragment);
      const Target target(normals, &depth);
      clear();
      set_camera(program);
      for (const Triangles* t : {&surface_, &plus_, &minus_}) t->draw();
    }
    occlude(depth, normals, open, half_blurred);
    const int big_w = factor_ * w, big_h = factor_ * h;
    const Target many(big_w, big_h, samples_);
    glViewport(0, 0, big_w, big_h);
    draw_all(open);
    const Texture resolved(big_w, big_h, false);
    const Target one(resolved, nullptr);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, many.id());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, one.id());
    glBlitFramebuffer(0, 0, big_w, big_h, 0, 0, big_w, big_h, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    one.bind();
    std::vector<unsigned char> pixels(static_cast<std::size_t>(big_w) * static_cast<std::size_t>(big_h) * 4);
    glReadPixels(0, 0, big_w, big_h, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    return reduced(pixels);
  }

 private:
  static constexpr int oversampling = 2;  // in each direction, on top of the samples of a pixel

  [[nodiscard]] double ball_radius() const { return 0.0105 * camera_.diagonal; }

  static void clear() {
    glClearColor(1, 1, 1, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  }
  void set_camera(const Program& program) const {
    program.use();
    glUniformMatrix4fv(program.at("camera"), 1, GL_FALSE, camera_.matrix.data());
    glUniformMatrix3fv(program.at("to_eye"), 1, GL_FALSE, to_eye_.data());
    glUniform2f(program.at("pixels"), static_cast<float>(factor_ * options_.size[0]),
                static_cast<float>(factor_ * options_.size[1]));
  }

  void occlude(const Texture& depth, const Texture& normals, const Texture& open, const Texture& half_blurred) const {
    glDisable(GL_DEPTH_TEST);
    const Triangles whole({0, 0, 0}, {1});  // three vertices; places come from their numbers
    depth.bind(0);
    normals.bind(1);
    {
      const Program program(shaders::whole_vertex, shaders::occlusion_fragment);
      const Target target(open, nullptr);
      program.use();
      glUniform1i(program.at("depths"), 0);
      glUniform1i(program.at("normals"), 1);
      glUniform3f(program.at("extent"), static_cast<float>(camera_.extent[0]), static_cast<float>(camera_.extent[1]),
                  static_cast<float>(camera_.extent[2]));
      glUniform1f(program.at("radius"), static_cast<float>(0.07 * camera_.diagonal));
      whole.draw();
    }
    const Program blur(shaders::whole_vertex, shaders::blur_fragment);
    for (const bool across : {true, false}) {
      const Target target(across ? half_blurred : open, nullptr);
      (across ? open : half_blurred).bind(1);
      blur.use();
      glUniform1i(blur.at("depths"), 0);
      glUniform1i(blur.at("values"), 1);
      glUniform2f(blur.at("along"), across ? 1.0F / static_cast<float>(options_.size[0]) : 0,
                  across ? 0 : 1.0F / static_cast<float>(options_.size[1]));
      glUniform1f(blur.at("depth_step"), static_cast<float>(0.02 * camera_.diagonal / camera_.extent[2]));
      whole.draw();
    }
  }

  void draw_all(const Texture& open) const {
    clear();
    glDisable(GL_DEPTH_TEST);
    {
      const Triangles whole({0, 0, 0}, {1});
      const Program backdrop(shaders::whole_vertex, shaders::backdrop_fragment);
      backdrop.use();
      whole.draw();
    }
    glEnable(GL_DEPTH_TEST);
    const Program matte(shaders::surface_vertex, shaders::surface_fragment);
    set_camera(matte);
    open.bind(0);
    glUniform1i(matte.at("open"), 0);
    const auto draw = [&](const Triangles& triangles, int color, float gloss) {
      glUniform3fv(matte.at("base"), 1, linear(color).data());
      glUniform1f(matte.at("gloss"), gloss);
      triangles.draw();
    };
    draw(surface_, clay, 0.02F);
    draw(plus_, positive, 0.25F);
    draw(minus_, negative, 0.25F);
    // Curves darken what they lie on, and hide nothing.
    const Program ink(shaders::curve_vertex, shaders::curve_fragment);
    set_camera(ink);
    glUniform1f(ink.at("half_width"), static_cast<float>(0.5 * line_width() * factor_));
    glUniform1f(ink.at("lift"), static_cast<float>(0.0016 * camera_.diagonal / camera_.extent[2] * 2));
    glUniform4f(ink.at("ink"), 0.09F, 0.16F, 0.27F, 0.85F);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glDepthMask(GL_FALSE);
    curves_->draw();
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
  }
  /// Pixels of the finished picture: a fifth of the distance of the curves, but visible and not clumsy.
  [[nodiscard]] double line_width() const {
    const double spacing = options_.spacing * camera_.diagonal * options_.size[1] / (2 * camera_.extent[1]);
    return std::clamp(0.115 * spacing, 0.9, options_.size[1] / 300.0);
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
  Triangles surface_, plus_, minus_;
  std::unique_ptr<Triangles> curves_;
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
