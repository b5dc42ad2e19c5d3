// SPDX-License-Identifier: MIT
//
// lines.js: many segments on the surface as ribbons that face the viewer: curves, separatrices, glyphs, strokes.
import { Color, InstancedBufferGeometry, InstancedInterleavedBuffer, InterleavedBufferAttribute, Float32BufferAttribute, Mesh, ShaderMaterial, Vector2 } from 'three';

const vertexShader = /* glsl */ `
attribute vec3 start, end;
attribute vec2 arc;      // length along the curve at both ends
uniform vec2 size;       // of the canvas, pixels
uniform float width;     // world
uniform vec2 widths;     // least and most, pixels
uniform float lift, period, taper;
varying float vSide, vHalf;
varying float vAlong;
void main() {
  vec4 a = modelViewMatrix * vec4(start, 1.0), b = modelViewMatrix * vec4(end, 1.0);
  a.xyz *= 1.0 - lift;   // towards the eye: the same place on screen, in front of the surface
  b.xyz *= 1.0 - lift;
  vec4 pa = projectionMatrix * a, pb = projectionMatrix * b;
  vec2 sa = pa.xy / pa.w * size, sb = pb.xy / pb.w * size;
  vec2 along = sb - sa;
  along = length(along) > 1e-6 ? normalize(along) : vec2(1.0, 0.0);
  vec4 here = position.x < 0.5 ? pa : pb;
  float s = mix(arc.x, arc.y, position.x);
  float pixels = clamp(width * projectionMatrix[1][1] * size.y / here.w * 0.5, widths.x, widths.y);
  if (taper > 0.5) pixels *= mix(1.5, 0.12, position.x);
  vAlong = period > 0.0 ? s / period : 0.0;
  vHalf = pixels * 0.5 + 0.7;   // room for a soft edge
  vSide = position.y * vHalf;
  vec2 offset = vec2(-along.y, along.x) * vSide + along * (position.x - 0.5) * min(pixels, 1.0);
  here.xy += offset * 2.0 / size * here.w;
  gl_Position = here;
}`;

const fragmentShader = /* glsl */ `
uniform vec3 color;
uniform float opacity, period;
varying float vSide, vHalf;
varying float vAlong;
void main() {
  float core = vHalf - 0.7;
  // Curves of vector fields swell towards where they point.
  if (period > 0.0) core *= mix(0.35, 1.25, fract(vAlong));
  float cover = clamp(core + 0.5 - abs(vSide), 0.0, 1.0) * min(1.0, 2.0 * core + 0.2);
  if (cover < 0.02) discard;
  gl_FragColor = vec4(color, opacity * cover);
  #include <colorspace_fragment>
}`;

export class Lines {
  /** width: world units; widths: least and most in pixels; period: of the swelling, 0 for none. */
  constructor({ color, variable, width, widths = [0.8, 3], lift = 0.0015, opacity = 1, period = 0, taper = false, order = 1 }) {
    this.variable = variable;
    this.material = new ShaderMaterial({
      vertexShader,
      fragmentShader,
      transparent: true,
      depthWrite: false,
      uniforms: {
        color: { value: new Color(color || '#000') }, size: { value: new Vector2(1, 1) }, width: { value: width },
        widths: { value: new Vector2(...widths) }, lift: { value: lift }, opacity: { value: opacity },
        period: { value: period }, taper: { value: taper ? 1 : 0 },
      },
    });
    this.object = new Mesh(ribbon(), this.material);
    this.object.frustumCulled = false;
    this.object.renderOrder = order;
    this.total = 0;
    this.pixels = widths;
  }

  theme(style) {
    if (this.variable) this.material.uniforms.color.value.set(style.getPropertyValue(this.variable).trim());
  }

  resize(width, height, ratio) {
    this.material.uniforms.size.value.set(width * ratio, height * ratio);
    this.material.uniforms.widths.value.set(this.pixels[0] * ratio, this.pixels[1] * ratio);
  }

  /** While the picture moves on a slow machine: only the first curves, which are spread over everything. */
  detail(fraction) {
    this.object.geometry.instanceCount = Math.ceil(this.total * fraction);
  }

  /** 8 floats a segment: start, end, arc length at both. */
  segments(data) {
    const buffer = new InstancedInterleavedBuffer(data, 8, 1);
    // Three.js never draws more instances of a geometry than it had when it was first drawn.
    this.object.geometry.dispose();
    const geometry = ribbon();
    geometry.setAttribute('start', new InterleavedBufferAttribute(buffer, 3, 0));
    geometry.setAttribute('end', new InterleavedBufferAttribute(buffer, 3, 3));
    geometry.setAttribute('arc', new InterleavedBufferAttribute(buffer, 2, 6));
    this.total = geometry.instanceCount = data.length / 8;
    this.object.geometry = geometry;
    this.object.visible = this.total > 0 && this.shown !== false;
  }

  show(visible) {
    this.shown = visible;
    this.object.visible = visible && this.total > 0;
  }

  /** Polylines: points (3 each) and offsets. */
  curves(points, offsets) {
    const number = Math.max(offsets.length - 1, 0);
    let total = 0;
    for (let k = 0; k < number; ++k) total += Math.max(offsets[k + 1] - offsets[k] - 1, 0);
    const data = new Float32Array(8 * total);
    // A stride that shares no factor with the number of curves: any first part is spread evenly.
    let stride = Math.max(1, Math.round(number * 0.618));
    while (gcd(stride, number) > 1) ++stride;
    for (let j = 0, k = 0, to = 0; j < number; ++j, k = (k + stride) % number) {
      let arc = 0;
      for (let i = offsets[k]; i + 1 < offsets[k + 1]; ++i, to += 8) {
        const a = 3 * i;
        for (let c = 0; c < 6; ++c) data[to + c] = points[a + c];
        data[to + 6] = arc;
        arc += Math.hypot(points[a + 3] - points[a], points[a + 4] - points[a + 1], points[a + 5] - points[a + 2]);
        data[to + 7] = arc;
      }
    }
    this.segments(data);
  }
}

/** One segment, to be drawn many times. */
function ribbon() {
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute([0, -1, 0, 1, -1, 0, 0, 1, 0, 1, 1, 0], 3));
  geometry.setIndex([0, 1, 2, 2, 1, 3]);
  geometry.instanceCount = 0;
  return geometry;
}

function gcd(a, b) {
  while (b) [a, b] = [b, a % b];
  return a;
}
