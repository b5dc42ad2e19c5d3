// SPDX-License-Identifier: MIT
//
// mirror.js: designs that are the same on both sides of a plane: which planes the surface allows, and what becomes of
// controls there. The planes go through the middle of the box around the surface, across its axes.
import { swirls } from './indices.js';
import { angleIn, direction, pointIn } from './tangent.js';

const same = 0.01;   // of the diagonal: a surface this close to its mirror image is symmetric
const found = 0.03;  // of the diagonal: a control this close to the image of another one is its twin

export class Mirror {
  constructor(surface, diagonal) {
    this.surface = surface;
    this.diagonal = diagonal;
    this.axis = -1;  // 0, 1, 2; -1: off
  }

  /** Whether the surface is its own image across the plane, from some hundred vertices. */
  allows(axis) {
    const { positions: P } = this.surface;
    const number = P.length / 3, step = Math.max(1, Math.floor(number / 200));
    let tried = 0, close = 0;
    for (let v = 0; v < number; v += step, ++tried) {
      const p = [P[3 * v], P[3 * v + 1], P[3 * v + 2]];
      p[axis] = -p[axis];
      if (this.surface.nearest(p).distance < same * this.diagonal) ++close;
    }
    return close > 0.97 * tried;
  }

  axes() {
    return (this.allowed ??= [0, 1, 2].filter((axis) => this.allows(axis)));
  }

  reflected(p) {
    return p.map((x, c) => (c === this.axis ? -x : x));
  }

  /** Of the plane. */
  normal() {
    return [0, 1, 2].map((c) => Number(c === this.axis));
  }

  /** Whether a control at this point is its own image. */
  holds(p) {
    return this.axis >= 0 && this.near(p, this.reflected(p));
  }

  /** A point of the surface, {face, barycentric}, on the other side. */
  place({ face, barycentric }) {
    const hit = this.surface.nearest(this.reflected(pointIn(this.surface, face, barycentric)));
    return { face: hit.face, barycentric: hit.barycentric, point: hit.point };
  }

  /** A singularity of a design on the other side; null where both are one. */
  singularity(s, n) {
    const center = Array.isArray(s.pin) ? s.pin : [1 / 3, 1 / 3, 1 / 3];
    const there = this.place({ face: s.face, barycentric: center });
    if (there.face === s.face) return null;
    const image = { ...s, face: there.face };
    if (s.pin) image.pin = there.barycentric;
    if (swirls(s, n)) {
      // A swirl turns the other way; that of a vortex starts at 90 degrees, that of a sink at 180.
      image.angle = (s.kind === 'vortex' ? -180 : 0) - (s.angle || 0);
    } else {
      const d = direction(this.surface, s.face, s.angle || 0, s.relative_to);
      delete image.relative_to;
      image.angle = angleIn(this.surface, there.face, this.reflected(d));
    }
    image.angle = ((image.angle % 360) + 360) % 360;
    return image;
  }

  /** Of a stroke along edges: between the vertices nearest to the images of its own. */
  stroke(s) {
    if (s.vertices) return { ...s, vertices: s.vertices.map((v) => this.vertex(v)).filter((v, k, all) => v !== all[k - 1]) };
    return { ...s, points: s.points.map((p) => { const { face, barycentric } = this.place(p); return { face, barycentric }; }) };
  }

  vertex(v) {
    const { face, barycentric } = this.surface.nearest(this.reflected(Array.from(this.surface.positions.subarray(3 * v, 3 * v + 3))));
    return this.surface.faces[3 * face + barycentric.indexOf(Math.max(...barycentric))];
  }

  /** The singularity of the design that mirrors number k; -1 for none. Of several the nearest: while one is dragged onto another there are two. */
  twin(design, k) {
    const list = design.singularities || [], s = list[k];
    if (this.axis < 0 || !s) return -1;
    const spot = (one) => pointIn(this.surface, one.face, Array.isArray(one.pin) ? one.pin : [1 / 3, 1 / 3, 1 / 3]);
    const image = this.reflected(spot(s)), far = (j) => Math.hypot(...spot(list[j]).map((x, c) => x - image[c]));
    const like = list.map((_, j) => j).filter((j) => j !== k && list[j].kind === s.kind && (list[j].count || 1) === (s.count || 1) && this.near(spot(list[j]), image));
    return like.reduce((best, j) => (best < 0 || far(j) < far(best) ? j : best), -1);
  }

  /** The same for strokes: drawn with as many points, from one end or the other. */
  twinStroke(design, k) {
    const list = design.strokes || [], s = list[k];
    if (this.axis < 0 || !s?.points?.length) return -1;
    const spot = (p) => pointIn(this.surface, p.face, p.barycentric);
    const ends = [s.points[0], s.points.at(-1)].map((p) => this.reflected(spot(p)));
    return list.findIndex((one, j) => j !== k && one.points?.length === s.points.length && this.near(spot(one.points[0]), ends[0]) && this.near(spot(one.points.at(-1)), ends[1]));
  }

  near(a, b) {
    return Math.hypot(...a.map((x, c) => x - b[c])) < found * this.diagonal;
  }
}
