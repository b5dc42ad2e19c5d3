// SPDX-License-Identifier: MIT
//
// card.js: what is known about a singularity that nobody asked for, why it is there, and what can be done about it.
import { count, fraction, h, short } from './dom.js';
import { mark } from './panel.js';
import { kindsOf } from './studio_panel.js';
import { barycentricIn, dot, frame, plus, scaled, subtract, unit } from './tangent.js';

const close = 0.15;  // of the diagonal: pairs further apart are no pairs

const number = (value) => String(value).replace('-', '−');

/** Why the field has singularities besides those of the design, in a sentence. */
function reason(app, paired) {
  const { n } = app.design, { euler, boundary } = app.view.meta;
  if (paired) return 'With the opposite one near by it adds nothing to the sum of indices: bumps of the surface make such pairs, and controls close to each other.';
  if (euler === undefined || boundary) return 'The field needs it here: on a surface with boundary their number follows from the shape.';
  const placed = (app.design.singularities || []).reduce((sum, s) => sum + (s.kind === 'saddle' || s.kind === 'trisector' ? -1 : 1) * (s.count || 1), 0);
  if (!placed) return `All indices sum to ${number(euler)}, the Euler characteristic; here the surface bends most.`;
  return `All indices sum to ${number(euler)}, the Euler characteristic. Yours sum to ${fraction(placed, n)}, so others make up ${fraction(n * euler - placed, n) || '0'}.`;
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

  /** About the singularity with this number in the field's list. */
  tell(k) {
    const { app } = this, { n } = app.design;
    const index = app.view.arrays.singular[8 * k + 6], partner = this.partner(k);
    const act = (what) => () => {
      this.close();
      what();
    };
    this.element.replaceChildren(
      h('p', { class: 'head' }, mark(index), ` Singularity ${fraction(index, n)}`),
      this.closer(),
      h('p', { class: 'quiet' }, `Nobody asked for it. ${reason(app, partner >= 0)}`),
      h('div', { class: 'actions' },
        Math.abs(index) === 1 ? h('button', { type: 'button', class: 'primary', onclick: act(() => this.hold(k)) }, 'Hold it here') : null,
        partner >= 0 ? h('button', { type: 'button', class: 'plain', title: 'A short stroke between them makes the field go on without them', onclick: act(() => this.cancel(k, partner)) }, `Cancel it with its ${fraction(-index, n)}`) : null));
    this.element.hidden = false;
  }

  /** Makes it a control like those that are placed. */
  hold(k) {
    const { app } = this, { singular, singular_faces: faces } = app.view.arrays, { n } = app.design;
    const face = faces[k], kind = kindsOf(n)[singular[8 * k + 6] > 0 ? 0 : kindsOf(n).length - 1][0];
    const pin = inside(barycentricIn(app.view.surface, face, this.place(k)));
    app.add({ face, kind, angle: (singular[8 * k + 7] * 180) / Math.PI, pin });
  }

  /** A short stroke between the two, along what the field does around them: the first of several that leaves two singularities less. */
  async cancel(k, partner) {
    const { app } = this;
    const [a, b] = [this.place(k), this.place(partner)], before = app.view.arrays.singular_faces.length;
    const middle = app.view.surface.nearest(scaled(plus(a, b), 0.5)), apart = Math.hypot(...subtract(a, b));
    const points = this.across(middle, apart);
    const gesture = `cancel-${Date.now()}`, number = (app.design.strokes || []).length;
    for (const [weight, width] of [[10, 1], [100, 1], [10, 0], [100, 0], [1000, 1]]) {
      const radius = app.eigen() ? 0 : width * apart;
      await app.change((d) => { (d.strokes ??= [])[number] = { name: 'cancelled pair', points, weight, ...(radius ? { radius } : {}) }; }, gesture);
      if (app.view.arrays.singular_faces.length <= before - 2) return app.store.rest();
    }
    await app.store.step('undo');
    this.element.replaceChildren(h('p', { class: 'head' }, 'The field keeps this pair'), this.closer(),
      h('p', { class: 'quiet' }, 'Without it, others would appear near by. Hold a singularity elsewhere, or draw strokes along what the field shall do here.'));
    this.element.hidden = false;
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

/** A zero on an edge belongs to neither face: a little inside. */
export function inside(barycentric) {
  return barycentric.map((b) => 0.08 / 1.24 + Math.min(Math.max(b, 0), 1) / 1.24);
}
