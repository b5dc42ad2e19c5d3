// SPDX-License-Identifier: MIT
//
// png_shaders.h: the programs that run on the graphics card (OpenGL ES 3.0).
#pragma once

namespace alcap::app::shaders {

/// Everything that has a surface: positions and normals in world coordinates. `lift`: towards the eye, clip units.
inline constexpr const char* surface_vertex = R"(#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 camera;
uniform mat3 to_eye;
uniform float lift;
out vec3 n;
void main() {
  n = to_eye * normal;
  gl_Position = camera * vec4(position, 1.0);
  gl_Position.z -= lift;
}
)";

/// Clay as on the page (apps/viewer/src/surface.js): a key light over the viewer's left shoulder, a weak one from below
/// right, and sky. The eye is far away.
inline constexpr const char* surface_fragment = R"(#version 300 es
precision highp float;
in vec3 n;
uniform vec3 front, back;  // linear colours
out vec4 color;
vec3 encoded(vec3 c) {
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}
void main() {
  vec3 e = normalize(n);
  if (!gl_FrontFacing) e = -e;
  vec3 left = normalize(vec3(-0.45, 0.65, 0.62));
  float key = max(dot(e, left), 0.0);
  float fill = max(dot(e, normalize(vec3(0.7, -0.25, 0.45))), 0.0);
  float sky = 0.5 + 0.5 * e.y;
  float rim = pow(1.0 - max(e.z, 0.0), 3.0);
  float light = 0.34 + 0.22 * sky + 0.5 * key + 0.14 * fill;
  float shine = 0.06 * pow(max(dot(e, normalize(left + vec3(0.0, 0.0, 1.0))), 0.0), 40.0);
  color = vec4(encoded(clamp((gl_FrontFacing ? front : back) * light * (1.0 - 0.35 * rim) + shine, 0.0, 1.0)), 1.0);
}
)";

/// Marks as on the page (apps/viewer/src/marks.js), and their light rims, which are flat.
inline constexpr const char* mark_fragment = R"(#version 300 es
precision highp float;
in vec3 n;
uniform vec3 base;  // linear colour
uniform float flatness;
out vec4 color;
vec3 encoded(vec3 c) {
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}
void main() {
  float light = 0.62 + 0.45 * max(dot(normalize(n), normalize(vec3(-0.45, 0.65, 0.62))), 0.0);
  color = vec4(encoded(clamp(base * mix(light, 1.0, flatness), 0.0, 1.0)), 1.0);
}
)";

/// Curves as bands of constant width on the screen, lifted a little towards the eye. `side` is -1 or 1, `width` a
/// fraction of the full width, `arc` the length along the curve. With a period they swell towards where they point.
inline constexpr const char* curve_vertex = R"(#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 tangent;
layout(location = 3) in vec3 band;  // side, width, arc
uniform mat4 camera;
uniform mat3 to_eye;
uniform vec2 pixels;
uniform float half_width;  // pixels
uniform float lift;        // towards the eye, clip units
uniform float period;      // world units; 0: none
out float side;
out float half_here;
out float facing;
out float along_curve;
void main() {
  vec3 n = to_eye * normal;
  vec3 t = to_eye * tangent;
  float flat_length = length(t.xy);
  vec2 along = flat_length > 1e-4 ? t.xy / flat_length : vec2(1.0, 0.0);
  half_here = half_width * band.y;
  along_curve = period > 0.0 ? band.z / period : 0.0;
  float reach = 1.25 * half_here + 1.0;  // a pixel more to fade out
  side = band.x * reach;
  facing = n.z;
  vec4 p = camera * vec4(position, 1.0);
  p.z -= lift / max(facing, 0.2);
  p.xy += band.x * reach * vec2(-along.y, along.x) * 2.0 / pixels;
  gl_Position = p;
}
)";

inline constexpr const char* curve_fragment = R"(#version 300 es
precision highp float;
in float side;
in float half_here;
in float facing;
in float along_curve;
uniform float period;
uniform vec3 ink;
out vec4 color;
void main() {
  float core = half_here * (period > 0.0 ? mix(0.35, 1.25, fract(along_curve)) : 1.0);
  float a = clamp(core + 0.5 - abs(side), 0.0, 1.0) * smoothstep(0.10, 0.42, facing);
  if (a <= 0.0) discard;
  color = vec4(ink, a);
}
)";

}  // namespace alcap::app::shaders
