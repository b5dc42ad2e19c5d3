// SPDX-License-Identifier: MIT
//
// png_gl.h: OpenGL ES 3 without a window, and its objects as C++ objects. Only in builds that have EGL.
#pragma once

#include <GLES3/gl3.h>

#include <string>
#include <vector>

namespace alcap::app::gl {

/// A context that belongs to no window, current on this thread while it lives. Throws Failure that says what is
/// missing.
class Context {
 public:
  Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  ~Context();

 private:
  void* display_ = nullptr;
  void* context_ = nullptr;
};

class Program {
 public:
  Program(const char* vertex, const char* fragment);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program() { glDeleteProgram(id_); }
  void use() const { glUseProgram(id_); }
  [[nodiscard]] GLint at(const char* uniform) const { return glGetUniformLocation(id_, uniform); }

 private:
  GLuint id_ = 0;
};

/// What is drawn into: buffers with several samples a pixel and depths, or, with 0 samples, colours alone, to be read.
class Target {
 public:
  Target(int width, int height, int samples);
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;
  ~Target();
  [[nodiscard]] GLuint id() const { return id_; }
  void bind() const { glBindFramebuffer(GL_FRAMEBUFFER, id_); }

 private:
  GLuint id_ = 0;
  GLuint buffers_[2] = {0, 0};
};

/// Triangles of vertices that are made of several vectors of floats.
class Triangles {
 public:
  /// `parts`: floats per attribute 0, 1, ... `indices` empty: every three vertices in order.
  Triangles(const std::vector<float>& vertices, const std::vector<int>& parts, const std::vector<GLuint>& indices = {});
  Triangles(const Triangles&) = delete;
  Triangles& operator=(const Triangles&) = delete;
  ~Triangles();
  void draw() const;

 private:
  GLuint array_ = 0, vertices_ = 0, indices_ = 0;
  GLsizei count_ = 0;
  bool indexed_ = false;
};

}  // namespace alcap::app::gl
