// SPDX-License-Identifier: MIT
//
// surface.js: the mesh in soft light, plain or with a colour per face.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, Mesh, ShaderMaterial } from 'three';

import { texture } from './colors.js';

const vertexShader = /* glsl */ `
attribute float value;
varying vec3 vNormal, vView;
flat varying float vValue;
void main() {
  vec4 view = modelViewMatrix * vec4(position, 1.0);
  vNormal = normalMatrix * normal;
  vView = -view.xyz;
  vValue = value;
  gl_Position = projectionMatrix * view;
}`;

const fragmentShader = /* glsl */ `
uniform vec3 clay, back;
uniform sampler2D map;
uniform vec2 range;
uniform float colored;
varying vec3 vNormal, vView;
flat varying float vValue;
void main() {
  vec3 n = normalize(vNormal), v = normalize(vView);
  bool front = gl_FrontFacing;
  if (!front) n = -n;
  vec3 base = front ? clay : back;
  if (colored > 0.5) {
    float t = clamp((vValue - range.x) / max(range.y - range.x, 1e-30), 0.0, 1.0);
    base = texture2D(map, vec2((t * 255.0 + 0.5) / 256.0, 0.5)).rgb * (front ? 1.0 : 0.6);
  }
  // A key light over the viewer's left shoulder, a weak one from below right, and sky.
  float key = max(dot(n, normalize(vec3(-0.45, 0.65, 0.62))), 0.0);
  float fill = max(dot(n, normalize(vec3(0.7, -0.25, 0.45))), 0.0);
  float sky = 0.5 + 0.5 * n.y;
  float rim = pow(1.0 - max(dot(n, v), 0.0), 3.0);
  float light = 0.34 + 0.22 * sky + 0.5 * key + 0.14 * fill;
  vec3 shine = vec3(pow(max(dot(n, normalize(normalize(vec3(-0.45, 0.65, 0.62)) + v)), 0.0), 40.0)) * 0.06;
  gl_FragColor = vec4(base * light * (1.0 - 0.35 * rim) + shine, 1.0);
  #include <colorspace_fragment>
}`;

export class Surface {
  constructor(positions, faces) {
    this.positions = positions;
    this.faces = faces;
    this.normals = vertexNormals(positions, faces);
    this.smooth = new BufferGeometry();
    this.smooth.setAttribute('position', new BufferAttribute(positions, 3));
    this.smooth.setAttribute('normal', new BufferAttribute(this.normals, 3, true));
    this.smooth.setIndex(new BufferAttribute(faces, 1));
    this.smooth.computeBoundingSphere();
    this.maps = { sequential: texture('sequential'), diverging: texture('diverging') };
    this.material = new ShaderMaterial({
      vertexShader,
      fragmentShader,
      side: DoubleSide,
      uniforms: { clay: { value: new Color() }, back: { value: new Color() }, map: { value: this.maps.sequential }, range: { value: [0, 1] }, colored: { value: 0 } },
    });
    this.object = new Mesh(this.smooth, this.material);
    this.object.frustumCulled = false;
  }

  theme(style) {
    this.material.uniforms.clay.value.set(style.getPropertyValue('--clay').trim());
    this.material.uniforms.back.value.set(style.getPropertyValue('--clay-back').trim());
  }

  /** A value per face, or null for none. */
  color(values, { low, high, diverging } = {}) {
    this.material.uniforms.colored.value = values ? 1 : 0;
    this.object.geometry = this.smooth;
    if (!values) return;
    // Every face needs corners of its own to have one colour.
    this.split ??= splitFaces(this.positions, this.normals, this.faces);
    const all = new Float32Array(3 * values.length);
    for (let t = 0, k = 0; t < values.length; ++t, k += 3) all[k] = all[k + 1] = all[k + 2] = values[t];
    this.split.setAttribute('value', new BufferAttribute(all, 1));
    this.object.geometry = this.split;
    this.material.uniforms.map.value = diverging ? this.maps.diverging : this.maps.sequential;
    this.material.uniforms.range.value = [low, high];
  }

  /** The first hit of a ray: {face, point, barycentric}, or null. Every triangle is tried: 20 ms for a million. */
  hit(origin, direction) {
    const { positions: P, faces: F } = this;
    const { x: ox, y: oy, z: oz } = origin, { x: dx, y: dy, z: dz } = direction;
    let best = Infinity, found = null;
    for (let t = 0, k = 0; k < F.length; ++t, k += 3) {
      const a = 3 * F[k], b = 3 * F[k + 1], c = 3 * F[k + 2];
      const ax = P[a], ay = P[a + 1], az = P[a + 2];
      const ux = P[b] - ax, uy = P[b + 1] - ay, uz = P[b + 2] - az;
      const vx = P[c] - ax, vy = P[c + 1] - ay, vz = P[c + 2] - az;
      const px = dy * vz - dz * vy, py = dz * vx - dx * vz, pz = dx * vy - dy * vx;
      const det = ux * px + uy * py + uz * pz;
      if (det === 0) continue;
      const sx = ox - ax, sy = oy - ay, sz = oz - az;
      const u = (sx * px + sy * py + sz * pz) / det;
      if (u < 0 || u > 1) continue;
      const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
      const v = (dx * qx + dy * qy + dz * qz) / det;
      if (v < 0 || u + v > 1) continue;
      const s = (vx * qx + vy * qy + vz * qz) / det;
      if (s > 0 && s < best) {
        best = s;
        found = { face: t, barycentric: [1 - u - v, u, v] };
      }
    }
    if (found) found.point = [ox + best * dx, oy + best * dy, oz + best * dz];
    return found;
  }

  /** Corners of a face as arrays of three numbers. */
  corners(face) {
    return [0, 1, 2].map((c) => {
      const v = 3 * this.faces[3 * face + c];
      return [this.positions[v], this.positions[v + 1], this.positions[v + 2]];
    });
  }
}

function vertexNormals(P, F) {
  const sum = new Float32Array(P.length);
  for (let k = 0; k < F.length; k += 3) {
    const a = 3 * F[k], b = 3 * F[k + 1], c = 3 * F[k + 2];
    const ux = P[b] - P[a], uy = P[b + 1] - P[a + 1], uz = P[b + 2] - P[a + 2];
    const vx = P[c] - P[a], vy = P[c + 1] - P[a + 1], vz = P[c + 2] - P[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (const v of [a, b, c]) {
      sum[v] += x;
      sum[v + 1] += y;
      sum[v + 2] += z;
    }
  }
  const normals = new Int16Array(P.length);
  for (let v = 0; v < sum.length; v += 3) {
    const scale = 32767 / (Math.hypot(sum[v], sum[v + 1], sum[v + 2]) || 1);
    for (let c = 0; c < 3; ++c) normals[v + c] = sum[v + c] * scale;
  }
  return normals;
}

function splitFaces(P, N, F) {
  const positions = new Float32Array(3 * F.length), normals = new Int16Array(3 * F.length);
  for (let k = 0; k < F.length; ++k) {
    const v = 3 * F[k];
    for (let c = 0; c < 3; ++c) {
      positions[3 * k + c] = P[v + c];
      normals[3 * k + c] = N[v + c];
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new BufferAttribute(normals, 3, true));
  return geometry;
}
