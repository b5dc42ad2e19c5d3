// SPDX-License-Identifier: MIT
//
// png_gl.cpp: an OpenGL ES context without a window, and its objects.
#ifdef ALCAP_WITH_PICTURES
#include "apps/alcap/picture/png_gl.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/core.h>

#include "apps/alcap/commands/command.h"

namespace alcap::app::gl {
namespace {

[[noreturn]] void unavailable(const std::string& what) {
  throw Failure(Exit::output, fmt::format("pictures need OpenGL ES 3: {}. On Debian: apt-get install libegl1 libgles2 "
                                          "libgl1-mesa-dri (a graphics card is not needed)",
                                          what));
}

EGLDisplay open_display() {
  // Mesa without any window system; what other drivers call the default display comes second.
  const auto platform_display =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  EGLDisplay candidates[2] = {EGL_NO_DISPLAY, EGL_NO_DISPLAY};
  if (platform_display) candidates[0] = platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  for (int k = 0; k < 2; ++k) {
    if (k == 1) candidates[1] = eglGetDisplay(EGL_DEFAULT_DISPLAY);
    if (candidates[k] != EGL_NO_DISPLAY && eglInitialize(candidates[k], nullptr, nullptr)) return candidates[k];
  }
  unavailable("EGL finds nothing to draw with");
}

GLuint compile(GLenum kind, const char* text) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good) return shader;
  std::string log(2000, '\0');
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  unavailable(fmt::format("the driver rejects a shader ({})", log.c_str()));
}

void check_complete() {
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    unavailable("the driver cannot make a picture of this size");
}

}  // namespace

Context::Context() {
  display_ = open_display();
  eglBindAPI(EGL_OPENGL_ES_API);
  const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  eglChooseConfig(display_, wanted, &config, 1, &count);
  const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_NONE};
  context_ = eglCreateContext(display_, count > 0 ? config : nullptr, EGL_NO_CONTEXT, version);
  if (context_ == EGL_NO_CONTEXT || !eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
    eglTerminate(display_);
    unavailable("no context without a window");
  }
}

Context::~Context() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  eglTerminate(display_);
}

Program::Program(const char* vertex, const char* fragment) {
  id_ = glCreateProgram();
  for (const GLuint shader : {compile(GL_VERTEX_SHADER, vertex), compile(GL_FRAGMENT_SHADER, fragment)}) {
    glAttachShader(id_, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(id_);
  GLint good = 0;
  glGetProgramiv(id_, GL_LINK_STATUS, &good);
  if (!good) unavailable("the driver cannot link a program");
}

Target::Target(int width, int height, int samples) {
  glGenFramebuffers(1, &id_);
  bind();
  glGenRenderbuffers(2, buffers_);
  const GLenum formats[] = {GL_RGBA8, GL_DEPTH_COMPONENT24}, places[] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
  for (int k = 0; k < (samples > 0 ? 2 : 1); ++k) {
    glBindRenderbuffer(GL_RENDERBUFFER, buffers_[k]);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, formats[k], width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, places[k], GL_RENDERBUFFER, buffers_[k]);
  }
  check_complete();
}

Target::~Target() {
  glDeleteFramebuffers(1, &id_);
  glDeleteRenderbuffers(2, buffers_);
}

Triangles::Triangles(const std::vector<float>& vertices, const std::vector<int>& parts,
                     const std::vector<GLuint>& indices) {
  glGenVertexArrays(1, &array_);
  glBindVertexArray(array_);
  glGenBuffers(1, &vertices_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(float)), vertices.data(),
               GL_STATIC_DRAW);
  int floats = 0, offset = 0;
  for (const int p : parts) floats += p;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    glEnableVertexAttribArray(static_cast<GLuint>(k));
    glVertexAttribPointer(static_cast<GLuint>(k), parts[k], GL_FLOAT, GL_FALSE,
                          static_cast<GLsizei>(static_cast<std::size_t>(floats) * sizeof(float)),
                          reinterpret_cast<const void*>(static_cast<std::size_t>(offset) * sizeof(float)));
    offset += parts[k];
  }
  indexed_ = !indices.empty();
  count_ = static_cast<GLsizei>(indexed_ ? indices.size() : vertices.size() / static_cast<std::size_t>(floats));
  if (!indexed_) return;
  glGenBuffers(1, &indices_);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(GLuint)), indices.data(),
               GL_STATIC_DRAW);
}

Triangles::~Triangles() {
  glDeleteVertexArrays(1, &array_);
  glDeleteBuffers(1, &vertices_);
  if (indexed_) glDeleteBuffers(1, &indices_);
}

void Triangles::draw() const {
  if (count_ == 0) return;
  glBindVertexArray(array_);
  if (indexed_)
    glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
  else
    glDrawArrays(GL_TRIANGLES, 0, count_);
}

}  // namespace alcap::app::gl
#endif
