// SPDX-License-Identifier: MIT
//
// card.js: what is known about a singularity that no control asks for, why it is there, and what can be done about it.
import { count, fraction, h, short } from './dom.js';
import { holdable, indexOf, kindFor } from './indices.js';
import { mark } from './panel.js';
import { barycentricIn, dot, frame, inside, plus, scaled, subtract, unit } from './tangent.js';

const close = 0.15;   // of the diagonal: pairs further apart are no pairs
const bends = 4;      // of a stroke that cancels a pair

const number = (value) => String(value).replace('-', '−');

/** Why the field has singularities besides those of the design, in a sentence. */
function reason(app, paired) {
  const { n } = app.design, { euler, boundary } = app.view.meta;
  if (paired) return 'Together with the opposite one nearby it adds nothing to the sum of indices. Bumps of the surface and controls close to each other make such pairs.';
  if (euler === undefined || boundary) return 'On a surface with boundary, how many there are depends on the shape and on the controls.';
  const placed = (app.design.singularities || []).reduce((sum, s) => sum + indexOf(s), 0);
  if (!placed) return `All indices sum to ${number(euler)}, the Euler characteristic, whatever the field.`;
  return `All indices sum to ${number(euler)}, the Euler characteristic. Yours sum to ${fraction(placed, n)}; the others make up the remaining ${fraction(n * euler - placed, n) || '0'}.`;
}

export class Card {
  constructor(app) {
    this.app = app;
    this.element = h('div', { class: 'card', role: 'status', hidden: true });
  }

  close() { this.element.hidden = true; }

  /** About a face where nothing is; it is outlined. */
  face(t) {
    const { view } = this.app, { faces } = view.surface;
    const rows = [['Vertices', [0, 1, 2].map((c) => count(faces[3 * t + c])).join(', ')]];
    for (const s of view.meta.scalars || []) {
      const values = view.arrays[`scalar.${s.name}`];
      if (values && view.state.color) rows.push([s.label, short(values[t])]);
    }
    view.highlight(t);
    this.element.replaceChildren(h('p', { class: 'head' }, `Face ${count(t)}`), this.closer(),
      h('dl', {}, rows.map(([a, b]) => h('div', { class: 'row' }, h('dt', {}, a), h('dd', {}, b)))));
    this.element.hidden = false;
  }

  place(k) {
    return Array.from(this.app.view.arrays.singular.slice(8 * k, 8 * k + 3));
  }

  /** What is said about number k, and done with it, is of what is seen now: the next field has other numbers. */
  seen(k) {
    const { singular, singular_faces: faces } = this.app.view.arrays;
    return { place: this.place(k), face: faces[k], index: singular[8 * k + 6], angle: (singular[8 * k + 7] * 180) / Math.PI };
  }

  /** The nearest singularity of the opposite index that the design does not ask for, if it is close; -1 for none. */
  partner(k) {
    const { app } = this, { singular, singular_faces: faces } = app.view.arrays;
    const asked = new Set((app.design.singularities || []).map((s) => s.face));
    let best = close * app.view.meta.diagonal, found = -1;
    for (let j = 0; j < faces.length; ++j) {
      if (singular[8 * j + 6] !== -singular[8 * k + 6] || asked.has(faces[j])) continue;
      const distance = Math.hypot(...subtract(this.place(j), this.place(k)));
      if (distance < best) [best, found] = [distance, j];
    }
    return found;
  }

  closer() {
    return h('button', { type: 'button', class: 'close', 'aria-label': 'Close', onclick: () => {
      this.app.view.highlight(-1);
      this.close();
    } }, '×');
  }

  /** About the singularity with this number in the field's list. keys: the keyboard goes on from here. */
  tell(k, keys = false) {
    const { app } = this, { n } = app.design;
    const one = this.seen(k), partner = this.partner(k), other = partner >= 0 ? this.seen(partner) : null, { index } = one;
    const act = (what) => () => {
      this.close();
      what();
    };
    this.element.replaceChildren(
      h('p', { class: 'head' }, mark(index), ` Singularity ${fraction(index, n)}`),
      this.closer(),
      h('p', { class: 'quiet' }, `No control asks for it. ${reason(app, Boolean(other))}`),
      h('div', { class: 'actions' },
        holdable(index) ? h('button', { type: 'button', class: 'primary', title: Math.abs(index) > 1 ? `As ${Math.abs(index)} zeros side by side` : 'Makes it a control of the design', onclick: act(() => this.hold(one, keys)) }, 'Hold it here') : null,
        other ? h('button', { type: 'button', class: 'plain', title: 'Looks for a short stroke between them that removes both', onclick: act(() => this.cancel(one, other)) }, `Cancel it with the ${fraction(-index, n)} nearby`) : null));
    this.element.hidden = false;
    if (keys) (this.element.querySelector('.actions button') || this.element.querySelector('.close')).focus();
  }

  /** Makes it a control like those that are placed. */
  hold({ place, face, index, angle }, keys) {
    const { app } = this, list = app.design.singularities || [], there = list.findIndex((s) => s.face === face), count = Math.abs(index);
    if (there >= 0) app.select(there);  // somebody else was faster
    else app.add({ face, kind: kindFor(index, app.design.n), ...(count > 1 ? { count } : {}), angle, pin: inside(barycentricIn(app.view.surface, face, place)) });
    if (keys) app.handles.items[app.selected]?.ring.focus();
  }

  /** A short stroke between the two, along what the field does around them: the first of several that leaves two singularities less, bent to what the field then does there. */
  async cancel({ place: a }, { place: b }) {
    const { app } = this, before = app.view.arrays.singular_faces.length;
    const middle = app.view.surface.nearest(scaled(plus(a, b), 0.5)), apart = Math.hypot(...subtract(a, b));
    const straight = this.across(middle, apart);
    const gesture = `cancel-${Date.now()}`, number = (app.design.strokes || []).length;
    for (const [weight, width] of [[10, 1], [100, 1], [10, 0], [100, 0], [1000, 1]]) {
      const radius = width * apart;
      /** Whether the pair is gone with a stroke through these points. */
      const gone = async (points) => {
        await app.change((d) => { (d.strokes ??= [])[number] = { name: 'cancelled pair', points, weight, ...(radius ? { radius } : {}) }; }, gesture);
        const { singular } = app.view.arrays, left = Array.from({ length: singular.length / 8 }, (_, j) => this.place(j));
        return left.length <= before - 2 && [a, b].every((p) => left.every((q) => Math.hypot(...subtract(p, q)) > 0.3 * apart));
      };
      if (!(await gone(straight))) continue;
      await this.bend(number, straight, gone, middle, apart);
      return app.store.rest();
    }
    await app.store.step('undo');
    this.element.replaceChildren(h('p', { class: 'head' }, 'The field keeps this pair'), this.closer(),
      h('p', { class: 'quiet' }, 'None of the strokes that were tried removes it. Hold a singularity elsewhere, or draw strokes here in the directions you want.'));
    this.element.hidden = false;
  }

  /** A straight stroke that cancels a pair rarely is one that the field can follow: it becomes a curve of that field, while the pair stays away and the field follows it better. */
  async bend(number, points, gone, middle, apart) {
    const { app } = this;
    const report = () => (app.controls || []).find((c) => c.path === `/strokes/${number}`) || { met: true };
    for (let tries = 0, { met, error_degrees: error } = report(); !met && tries < bends; ++tries) {
      const next = this.along(points, middle, apart), fine = await gone(next), now = report();
      if (!fine || !(now.error_degrees < error)) {
        await gone(points);
        return;
      }
      [points, met, error] = [next, now.met, now.error_degrees];
    }
  }

  /** Points of the curve of the field through the middle of a stroke, to both sides. */
  along(points, middle, apart) {
    const { surface } = this.app.view, half = Math.floor(points.length / 2), step = (1.2 * apart) / half;
    const [p, q] = [points.at(half - 1), points.at(half + 1)].map(({ face, barycentric }) => surface.at(face, barycentric));
    const side = (sign) => {
      const list = [];
      for (let at = middle, way = scaled(subtract(q, p), sign); list.length < half;) {
        way = this.branch(at, way);
        at = surface.nearest(plus(at.point, scaled(way, step)));
        list.push({ face: at.face, barycentric: at.barycentric });
      }
      return list;
    };
    return [...side(-1).reverse(), { face: middle.face, barycentric: middle.barycentric }, ...side(1)];
  }

  /** The direction of the field at a place that is nearest to another one. */
  branch({ face, barycentric }, way) {
    const { surface, arrays } = this.app.view, { n } = this.app.design;
    const { x, y } = frame(surface, face);
    let re = 0, im = 0;
    barycentric.forEach((weight, j) => {
      const v = surface.faces[3 * face + j], d = arrays.branch.subarray(3 * v, 3 * v + 3), angle = Math.atan2(dot(d, y), dot(d, x));
      re += weight * Math.cos(n * angle);
      im += weight * Math.sin(n * angle);
    });
    const wanted = Math.atan2(dot(way, y), dot(way, x)), period = (2 * Math.PI) / n, angle = Math.atan2(im, re) / n;
    const turned = angle + period * Math.round((wanted - angle) / period);
    return plus(scaled(x, Math.cos(turned)), scaled(y, Math.sin(turned)));
  }

  /** Points of a straight stroke through the middle of a pair, in the direction that the field has in the mean on a ring around it. */
  across(middle, apart) {
    const { surface, arrays } = this.app.view, { n } = this.app.design;
    const { x, y, normal } = frame(surface, middle.face), P = surface.positions, N = surface.normals;
    let re = 0, im = 0;
    for (let v = 0; v < P.length; v += 3) {
      const way = subtract([P[v], P[v + 1], P[v + 2]], middle.point), distance = Math.hypot(...way);
      if (distance < 0.7 * apart || distance > 1.3 * apart || dot([N[v], N[v + 1], N[v + 2]], normal) <= 0) continue;
      const d = [arrays.branch[v], arrays.branch[v + 1], arrays.branch[v + 2]];
      const angle = Math.atan2(dot(d, y), dot(d, x));
      re += Math.cos(n * angle);
      im += Math.sin(n * angle);
    }
    const angle = Math.atan2(im, re) / n, along = unit(plus(scaled(x, Math.cos(angle)), scaled(y, Math.sin(angle))));
    const half = 1.2 * apart, steps = Math.max(8, Math.min(60, Math.round((2 * half) / (0.006 * this.app.stage.diagonal))));
    return Array.from({ length: steps + 1 }, (_, i) => {
      const { face, barycentric } = surface.nearest(plus(middle.point, scaled(along, half * ((2 * i) / steps - 1))));
      return { face, barycentric };
    });
  }
}
