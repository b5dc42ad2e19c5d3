// SPDX-License-Identifier: MIT
//
// fixed.js: directions held at vertices, as what handles move and turn: at a corner of a face of the vertex, by an angle
// in the frame of that face.
import { angleIn, direction, dot, frame, scaled, subtract, unit } from './tangent.js';

export class Fixed {
  constructor(surface) {
    this.surface = surface;
    this.faces = new Map();
  }

  /** A face of a vertex, always the same one. */
  faceOf(vertex) {
    if (!this.faces.has(vertex)) this.faces.set(vertex, Math.floor(this.surface.faces.indexOf(vertex) / 3));
    return this.faces.get(vertex);
  }

  point(vertex) {
    return Array.from(this.surface.positions.subarray(3 * vertex, 3 * vertex + 3));
  }

  /** A direction of space in the tangent plane at a vertex; that of the face's first edge where nothing is left of it. */
  inPlane(vertex, d) {
    const { x, normal } = frame(this.surface, this.faceOf(vertex));
    const flat = subtract(d, scaled(normal, dot(d, normal)));
    return Math.hypot(...flat) > 1e-3 * Math.hypot(...d) ? unit(flat) : x;
  }

  /** As the handles have singularities. Of designs made elsewhere that say it another way: what the field has there. */
  item(fixed, branch) {
    const { vertex } = fixed, face = this.faceOf(vertex);
    const pin = [0, 1, 2].map((c) => (this.surface.faces[3 * face + c] === vertex ? 1 : 0));
    const d = fixed.direction || Array.from(branch.subarray(3 * vertex, 3 * vertex + 3));
    return { kind: 'direction', vertex, face, pin, angle: angleIn(this.surface, face, d) };
  }

  turned(vertex, degrees) {
    return direction(this.surface, this.faceOf(vertex), degrees).map((x) => Number(x.toPrecision(9)));
  }

  /** The corner of a face that a place in it is nearest to. */
  vertexAt({ face, barycentric }) {
    return this.surface.faces[3 * face + barycentric.indexOf(Math.max(...barycentric))];
  }
}

/** The place of a direction on the other side of a mirror: {vertex, direction}, or null where both are one. */
export function mirrored(mirror, fixed, one) {
  const hit = mirror.surface.nearest(mirror.reflected(fixed.point(one.vertex)));
  const vertex = fixed.vertexAt(hit);
  if (vertex === one.vertex || !one.direction) return null;
  return { ...one, vertex, direction: fixed.inPlane(vertex, mirror.reflected(one.direction)) };
}

/** The direction of a list that mirrors number k; -1 for none. */
export function twinOf(mirror, fixed, list, k) {
  if (mirror.axis < 0 || !list?.[k]) return -1;
  const image = mirror.reflected(fixed.point(list[k].vertex));
  return list.findIndex((one, j) => j !== k && mirror.near(fixed.point(one.vertex), image));
}
