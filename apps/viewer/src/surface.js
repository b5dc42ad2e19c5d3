// SPDX-License-Identifier: MIT
//
// surface.js: the mesh in soft light, plain or with a colour per face.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, Mesh, ShaderMaterial } from 'three';

import { coarsen, makeBlocks, visitBlocks } from './blocks.js';
import { texture } from './colors.js';

const many = 150000;  // faces: fewer are drawn in full while they turn, however slowly

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
  /** reach: from the origin to the farthest vertex. */
  constructor(positions, faces, reach) {
    this.positions = positions;
    this.faces = faces;
    this.normals = vertexNormals(positions, faces);
    this.smooth = new BufferGeometry();
    this.smooth.setAttribute('position', new BufferAttribute(positions, 3));
    this.smooth.setAttribute('normal', new BufferAttribute(this.normals, 3, true));
    this.smooth.setIndex(new BufferAttribute(faces, 1));
    this.reach = reach;
    this.maps = { sequential: texture('sequential'), diverging: texture('diverging') };
    this.material = new ShaderMaterial({
      vertexShader,
      fragmentShader,
      side: DoubleSide,
      uniforms: { clay: { value: new Color() }, back: { value: new Color() }, map: { value: this.maps.sequential }, range: { value: [0, 1] }, colored: { value: 0 } },
    });
    this.full = this.smooth;
    this.values = null;
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
    this.values = values;
    this.full = this.smooth;
    if (values) {
      // Every face needs corners of its own to have one colour.
      this.split ??= geometryOf(splitFaces(this.positions, this.normals, this.faces));
      this.split.setAttribute('value', new BufferAttribute(spreadOver(values, values.length, (t) => t), 1));
      this.full = this.split;
      this.material.uniforms.map.value = diverging ? this.maps.diverging : this.maps.sequential;
      this.material.uniforms.range.value = [low, high];
    }
    this.object.geometry = this.full;
  }

  /** Less than 1: while the picture moves and takes too long; large surfaces are drawn coarsely then. */
  detail(fraction) {
    const coarse = fraction < 1 && this.faces.length / 3 > many;
    this.object.geometry = coarse ? this.makeCoarse() : this.full;
  }

  makeCoarse() {
    if (!this.coarse) {
      const made = coarsen(this.positions, this.normals, this.faces, this.reach / 45);
      this.coarse = geometryOf(made);
      this.originals = made.faces;
    }
    if (this.coarseValues !== this.values) {
      this.coarseValues = this.values;
      const { values, originals } = this;
      this.coarse.setAttribute('value', new BufferAttribute(values ? spreadOver(values, originals.length, (k) => originals[k]) : new Float32Array(3 * originals.length), 1));
    }
    return this.coarse;
  }

  /** The first hit of a ray: {face, point, barycentric}, or null. */
  hit(origin, direction) {
    const { positions: P, faces: F } = this;
    const { x: ox, y: oy, z: oz } = origin, { x: dx, y: dy, z: dz } = direction;
    const o = [ox, oy, oz], inverse = [1 / dx, 1 / dy, 1 / dz];
    let best = Infinity, found = null;
    const crosses = (boxes, k) => {
      let near = 0, far = best;
      for (let c = 0; c < 3; ++c) {
        const a = (boxes[k + c] - o[c]) * inverse[c], b = (boxes[k + 3 + c] - o[c]) * inverse[c];
        near = Math.max(near, Math.min(a, b));  // of a ray within the plane of a side: NaN, and the box is tried
        far = Math.min(far, Math.max(a, b));
      }
      return !(near > far * (1 + 1e-6) + 1e-30);
    };
    this.blocks ??= makeBlocks(P, F);
    visitBlocks(this.blocks, crosses, (t) => {
      const a = 3 * F[3 * t], b = 3 * F[3 * t + 1], c = 3 * F[3 * t + 2];
      const ax = P[a], ay = P[a + 1], az = P[a + 2];
      const ux = P[b] - ax, uy = P[b + 1] - ay, uz = P[b + 2] - az;
      const vx = P[c] - ax, vy = P[c + 1] - ay, vz = P[c + 2] - az;
      const px = dy * vz - dz * vy, py = dz * vx - dx * vz, pz = dx * vy - dy * vx;
      const det = ux * px + uy * py + uz * pz;
      if (det === 0) return;
      const sx = ox - ax, sy = oy - ay, sz = oz - az;
      const u = (sx * px + sy * py + sz * pz) / det;
      if (u < 0 || u > 1) return;
      const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
      const v = (dx * qx + dy * qy + dz * qz) / det;
      if (v < 0 || u + v > 1) return;
      const s = (vx * qx + vy * qy + vz * qz) / det;
      if (s > 0 && s < best) {
        best = s;
        found = { face: t, barycentric: [1 - u - v, u, v] };
      }
    });
    if (found) found.point = [ox + best * dx, oy + best * dy, oz + best * dz];
    return found;
  }

  /** The point of the surface nearest to a point: {face, point, barycentric, distance}. */
  nearest(point) {
    this.blocks ??= makeBlocks(this.positions, this.faces);
    let found = { distance: Infinity };
    const gap = (boxes, k) => {
      let sum = 0;
      for (let c = 0; c < 3; ++c) {
        const x = point[c], out = x < boxes[k + c] ? boxes[k + c] - x : x > boxes[k + 3 + c] ? x - boxes[k + 3 + c] : 0;
        sum += out * out;
      }
      return Math.sqrt(sum);
    };
    const look = (t) => {
      const barycentric = nearestIn(this.corners(t), point);
      const p = this.at(t, barycentric), distance = Math.hypot(...p.map((x, c) => x - point[c]));
      if (distance < found.distance) found = { face: t, barycentric, point: p, distance };
    };
    // The nearest box first: few others are closer than what is in it.
    const { boxes } = this.blocks;
    let first = 0;
    for (let k = 6, least = gap(boxes, 0); k < boxes.length; k += 6) {
      const here = gap(boxes, k);
      if (here < least) [least, first] = [here, k];
    }
    visitBlocks(this.blocks, (_, k) => k === first, look);
    visitBlocks(this.blocks, (all, k) => k !== first && gap(all, k) < found.distance, look);
    return found;
  }

  at(face, barycentric) {
    const corners = this.corners(face);
    return [0, 1, 2].map((c) => barycentric[0] * corners[0][c] + barycentric[1] * corners[1][c] + barycentric[2] * corners[2][c]);
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
  return { positions, normals };
}

function geometryOf({ positions, normals }) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new BufferAttribute(normals, 3, true));
  return geometry;
}

/** The value of a face at each of its three corners. */
function spreadOver(values, number, face) {
  const all = new Float32Array(3 * number);
  for (let t = 0, k = 0; t < number; ++t, k += 3) all[k] = all[k + 1] = all[k + 2] = values[face(t)];
  return all;
}

/** Barycentric coordinates of the point of a triangle that is nearest to p (Ericson 2004, Sec. 5.1.5). */
function nearestIn([a, b, c], p) {
  const minus = (x, y) => [x[0] - y[0], x[1] - y[1], x[2] - y[2]], times = (x, y) => x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
  const ab = minus(b, a), ac = minus(c, a), ap = minus(p, a), bp = minus(p, b), cp = minus(p, c);
  const d1 = times(ab, ap), d2 = times(ac, ap), d3 = times(ab, bp), d4 = times(ac, bp), d5 = times(ab, cp), d6 = times(ac, cp);
  if (d1 <= 0 && d2 <= 0) return [1, 0, 0];
  if (d3 >= 0 && d4 <= d3) return [0, 1, 0];
  if (d6 >= 0 && d5 <= d6) return [0, 0, 1];
  const vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return [1 - d1 / (d1 - d3), d1 / (d1 - d3), 0];
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return [1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)];
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const w = (d4 - d3) / (d4 - d3 + (d5 - d6));
    return [0, 1 - w, w];
  }
  const whole = va + vb + vc;
  return [va / whole, vb / whole, vc / whole];
}
