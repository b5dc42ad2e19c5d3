// SPDX-License-Identifier: MIT
//
// png_shaders.h: the programs that run on the graphics card (OpenGL ES 3.0).
#pragma once

namespace alcap::app::shaders {

/// Everything that has a surface: positions and normals in world coordinates.
inline constexpr const char* surface_vertex = R"(#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 camera;
out vec3 n;
void main() {
  n = normal;
  gl_Position = camera * vec4(position, 1.0);
}
)";

/// Normals towards the eye, packed into colours; depth goes into the depth texture.
inline constexpr const char* normals_fragment = R"(#version 300 es
precision highp float;
in vec3 n;
uniform mat3 to_eye;
out vec4 color;
void main() {
  vec3 e = normalize(to_eye * n);
  color = vec4(0.5 * (e.z < 0.0 ? -e : e) + 0.5, 1.0);
}
)";

/// A triangle over the whole picture.
inline constexpr const char* whole_vertex = R"(#version 300 es
out vec2 uv;
void main() {
  uv = vec2(float((gl_VertexID << 1) & 2), float(gl_VertexID & 2));
  gl_Position = vec4(2.0 * uv - 1.0, 0.0, 1.0);
}
)";

/// Ambient occlusion in screen space: how much of the hemisphere over a point is open, from the depths around it. The
/// camera is orthographic, so that depth and place are linear.
inline constexpr const char* occlusion_fragment = R"(#version 300 es
precision highp float;
uniform sampler2D depths;
uniform sampler2D normals;
uniform vec3 extent;   // half width, half height and depth of the view, world units
uniform float radius;  // world units
in vec2 uv;
out vec4 color;
vec3 place(vec2 t) {
  return vec3((2.0 * t - 1.0) * extent.xy, -texture(depths, t).r * extent.z);
}
void main() {
  if (texture(depths, uv).r >= 1.0) { color = vec4(1.0); return; }
  vec3 here = place(uv);
  vec3 n = normalize(2.0 * texture(normals, uv).rgb - 1.0);
  float spin = 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  const int count = 28;
  float closed = 0.0;
  for (int i = 0; i < count; ++i) {
    float t = (float(i) + 0.5) / float(count);
    float a = spin + 2.3999632 * float(i);
    vec2 o = radius * t * vec2(cos(a), sin(a)) / (2.0 * extent.xy);
    vec3 d = place(uv + o) - here;
    float l = length(d);
    float rise = max(dot(n, d) / max(l, 1e-9) - 0.08, 0.0);
    closed += rise * smoothstep(1.6 * radius, 0.3 * radius, l);
  }
  color = vec4(vec3(clamp(1.0 - 2.6 * closed / float(count), 0.0, 1.0)), 1.0);
}
)";

/// Smooths occlusion along one axis, not across steps of depth.
inline constexpr const char* blur_fragment = R"(#version 300 es
precision highp float;
uniform sampler2D values;
uniform sampler2D depths;
uniform vec2 along;
uniform float depth_step;
in vec2 uv;
out vec4 color;
void main() {
  float z = texture(depths, uv).r;
  float sum = 0.0, weight = 0.0;
  for (int i = -4; i <= 4; ++i) {
    vec2 t = uv + float(i) * along;
    float w = exp(-0.1 * float(i * i)) * exp(-abs(texture(depths, t).r - z) / depth_step);
    sum += w * texture(values, t).r;
    weight += w;
  }
  color = vec4(vec3(sum / weight), 1.0);
}
)";

/// Matte clay under a soft key light from the upper left, sky and ground light, and a faint rim.
inline constexpr const char* surface_fragment = R"(#version 300 es
precision highp float;
in vec3 n;
uniform mat3 to_eye;
uniform vec3 base;       // linear colour
uniform float gloss;
uniform vec2 pixels;     // of this picture
uniform sampler2D open;  // ambient occlusion
out vec4 color;
void main() {
  vec3 e = normalize(to_eye * n);
  bool back = !gl_FrontFacing;
  if (back) e = -e;
  float ao = texture(open, gl_FragCoord.xy / pixels).r;
  vec3 key = normalize(vec3(-0.5, 0.75, 0.75));
  float lambert = dot(e, key);
  float soft = pow(0.5 + 0.5 * lambert, 2.0);
  vec3 sky = mix(vec3(0.40, 0.37, 0.36), vec3(0.62, 0.66, 0.72), 0.5 + 0.5 * e.y);
  vec3 light = ao * sky * 0.56 + mix(1.0, ao, 0.7) * soft * vec3(1.02, 0.98, 0.92);
  light += 0.10 * pow(1.0 - clamp(e.z, 0.0, 1.0), 3.0);
  vec3 c = (back ? 0.55 * base : base) * light;
  vec3 halfway = normalize(key + vec3(0.0, 0.0, 1.0));
  c += gloss * pow(max(dot(e, halfway), 0.0), 48.0);
  color = vec4(pow(clamp(c, 0.0, 1.0), vec3(1.0 / 2.2)), 1.0);
}
)";

/// Curves as bands of constant width on the screen, lifted a little towards the eye. `side` is -1 or 1, `width` a
/// fraction of the full width.
inline constexpr const char* curve_vertex = R"(#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 tangent;
layout(location = 3) in vec2 band;  // side, width
uniform mat4 camera;
uniform mat3 to_eye;
uniform vec2 pixels;
uniform float half_width;  // pixels
uniform float lift;        // towards the eye, clip units
out float side;
out float reach;
out float facing;
void main() {
  vec3 n = to_eye * normal;
  vec3 t = to_eye * tangent;
  float flat_length = length(t.xy);
  vec2 along = flat_length > 1e-4 ? t.xy / flat_length : vec2(1.0, 0.0);
  reach = half_width * band.y + 1.0;  // a pixel more to fade out
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
in float reach;
in float facing;
uniform vec4 ink;
out vec4 color;
void main() {
  float edge = clamp(reach - abs(side), 0.0, 1.0);
  float a = ink.a * edge * smoothstep(0.10, 0.42, facing);
  if (a <= 0.0) discard;
  color = vec4(ink.rgb, a);
}
)";

/// A quiet backdrop.
inline constexpr const char* backdrop_fragment = R"(#version 300 es
precision highp float;
in vec2 uv;
out vec4 color;
void main() {
  float r = length((uv - vec2(0.5, 0.55)) * vec2(1.0, 0.8));
  color = vec4(mix(vec3(1.0), vec3(0.925, 0.935, 0.95), smoothstep(0.1, 0.75, r)), 1.0);
}
)";

}  // namespace alcap::app::shaders
