// SPDX-License-Identifier: MIT
//
// scene.js: everything that is drawn for one result, and what of it is shown. The arrays are those of
// apps/alcap/page/view_scene.h; the studio replaces some of them at a time.
import { Raycaster, Vector2, Vector3 } from 'three';

import { Glyphs } from './glyphs.js';
import { Lines } from './lines.js';
import { Marks } from './marks.js';
import { Surface } from './surface.js';

export class View {
  constructor(stage, { meta, arrays }) {
    this.stage = stage;
    this.meta = meta;
    this.arrays = {};
    const d = meta.diagonal;
    const reach = reachOf(arrays.positions);
    this.surface = new Surface(arrays.positions, arrays.faces, reach);
    stage.reach = reach / d;
    this.spacing = meta.spacing || 0.012 * d;
    this.curves = new Lines({ variable: '--ink', width: 0.1 * this.spacing, widths: [0.8, 2.4] });
    this.separatrices = new Lines({ variable: '--accent', width: 0.0032 * d, widths: [1.8, 4], lift: 0.0022, order: 2 });
    this.glyphs = new Glyphs(this.surface, d, 0.022 * d);
    this.marks = new Marks(d);
    this.picked = new Lines({ variable: '--accent', width: 0.002 * d, widths: [2.5, 4], lift: 0.004, order: 7 });
    this.stale = {};  // what belongs to an earlier field: curves, separatrices
    this.state = { lines: 'curves', singularities: true, arms: true, separatrices: false, color: '' };
    stage.add(this.surface);
    stage.add(this.curves);
    stage.add(this.separatrices);
    this.glyphs.attach(stage);
    stage.add(this.marks);
    stage.add(this.picked);
    this.update({ meta, arrays });
    this.apply();
  }

  /** Takes over what is there; the rest stays. */
  update({ meta, arrays }) {
    Object.assign(this.meta, meta);
    Object.assign(this.arrays, arrays);
    if (arrays.branch) {
      this.glyphs.set(this.meta.n, arrays.branch, arrays.length);
      this.curves.material.uniforms.period.value = this.meta.n === 1 ? 6 * this.spacing : 0;
    }
    if (arrays.singular) this.marks.set(arrays.singular, arrays.arms);
    if (arrays.curves) {
      this.curves.curves(arrays.curves, arrays.curve_offsets);
      this.stale.curves = false;
    }
    if (arrays.separatrices) {
      this.separatrices.curves(arrays.separatrices, arrays.separatrix_offsets);
      this.stale.separatrices = false;
    }
    if (this.state?.color && arrays[`scalar.${this.state.color}`]) this.apply();
    this.stage.draw();
  }

  /** The field is another one: what was drawn along it is not of this one. */
  outdate() {
    this.stale = { curves: true, separatrices: true };
    this.apply();
  }

  set(key, value) {
    this.state[key] = value;
    this.apply();
    this.wanted?.();
  }

  apply() {
    const { lines, singularities, arms, separatrices, color } = this.state;
    // While curves are those of an earlier field, glyphs stand in for them.
    this.curves.show(lines === 'curves' && !this.stale.curves);
    this.glyphs.show(lines === 'glyphs' || (lines === 'curves' && Boolean(this.stale.curves)));
    this.separatrices.show(separatrices && !this.stale.separatrices);
    this.marks.show(singularities);
    this.marks.showArms(arms);
    const scalar = (this.meta.scalars || []).find((s) => s.name === color);
    const values = scalar && this.arrays[`scalar.${color}`];
    if (this.colored !== values) this.surface.color(values || null, scalar || {});
    this.colored = values;
    this.curves.material.uniforms.opacity.value = color ? 0.6 : 1;
    this.stage.draw();
  }

  /** Draws the outline of a face; of none for -1. */
  highlight(face) {
    if (face === this.highlighted) return;
    this.highlighted = face;
    const corners = face < 0 ? [] : this.surface.corners(face);
    this.picked.curves(new Float32Array([...corners, ...corners.slice(0, 1)].flat()), face < 0 ? [0] : [0, 4]);
    this.stage.draw();
  }

  /** What is under the pointer: {face, point, barycentric}, or null. */
  pick(event) {
    const box = this.stage.canvas.getBoundingClientRect();
    const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.stage.camera);
    return this.surface.hit(ray.ray.origin, ray.ray.direction);
  }

  /** The singularity that is seen nearest to a place on screen, within so many pixels: its number; -1 for none. */
  around(place, pixels) {
    const { stage, meta } = this, S = this.arrays.singular || [];
    const box = stage.canvas.getBoundingClientRect();
    let best = pixels, found = -1;
    for (let k = 0; k < S.length; k += 8) {
      const at = new Vector3(S[k], S[k + 1], S[k + 2]).project(stage.camera);
      const spot = { clientX: box.left + ((at.x + 1) / 2) * box.width, clientY: box.top + ((1 - at.y) / 2) * box.height };
      const distance = Math.hypot(spot.clientX - place.clientX, spot.clientY - place.clientY);
      if (!(distance < best)) continue;
      const hit = this.pick(spot);
      if (!hit || Math.hypot(...hit.point.map((x, c) => x - S[k + c])) > 0.015 * meta.diagonal) continue;  // behind something
      [best, found] = [distance, k / 8];
    }
    return found;
  }

  /** The singularity nearest to a point, if closer than the given part of the diagonal: its number. */
  near(point, part = 0.015) {
    const S = this.arrays.singular || [];
    let best = part * this.meta.diagonal, found = -1;
    for (let k = 0; k < S.length; k += 8) {
      const distance = Math.hypot(S[k] - point[0], S[k + 1] - point[1], S[k + 2] - point[2]);
      if (distance < best) [best, found] = [distance, k / 8];
    }
    return found;
  }
}

/** From the middle to the farthest point. */
function reachOf(P) {
  let most = 0;
  for (let v = 0; v < P.length; v += 3) most = Math.max(most, P[v] * P[v] + P[v + 1] * P[v + 1] + P[v + 2] * P[v + 2]);
  return Math.sqrt(most);
}
