// SPDX-License-Identifier: MIT
//
// design_panel.js: the parts of the panel for what a design says less often: what it stays close to, by which field, by
// how much at which vertex; the details of its connection, and a connection of one's own that it is near to.
import { count, h, plain, segmented, toggle } from './dom.js';
import { numberInput } from './number_input.js';
import { slider } from './slider.js';

const targets = { rotation: 'halfedge rotations', adjustment: 'halfedge adjustments', vertex_curvature: 'vertex curvatures', face_curvature: 'face curvatures' };

/** A button that reads a JSON file of this machine. */
function jsonButton(app, label, title, take) {
  const file = h('input', { type: 'file', accept: '.json,application/json', hidden: true, 'aria-label': label, onchange: async () => {
    const [one] = file.files;
    if (!one) return;
    try {
      take(JSON.parse(await one.text()));
    } catch {
      app.onStatus('problem', 'This file is not JSON.');
    }
    file.value = '';
  } });
  return h('span', {}, h('button', { type: 'button', class: 'plain', title, onclick: () => file.click() }, label), file);
}

/** A number that is set by typing, or left out. */
export function numberRow(label, title, change) {
  const input = numberInput(label, { optional: true }, change);
  const row = h('label', { class: 'row', title }, h('span', {}, label), input);
  row.set = input.set;
  return row;
}

export function more(title, ...children) {
  return h('details', { class: 'more' }, h('summary', {}, title), ...children);
}

/** What the field stays close to where nothing is asked for, and how closely. */
export function guidanceControls(app) {
  const kinds = [['smoothest', 'Smoothest', 'The smoothest field: edits stay local'], ['curvature', 'Curvature', 'The directions of principal curvature; for lines, that of the largest'],
    ['least-curvature', 'Least', 'The direction of least curvature'], ['strongest-curvature', 'Strongest', 'The direction whose curvature has the largest magnitude, whatever its sign'],
    ['zero', 'Small', 'A small field, nothing else: enough for a solution on flat surfaces'], ['file', 'File', 'The field in a file'], ['none', 'Free', 'Nothing: the edits decide everywhere']];
  const choices = segmented('Elsewhere', kinds, 'smoothest', (field) => field !== 'file' && app.change((d) => {
    const { file, field: old, ...rest } = d.guidance || {};
    d.guidance = field === 'none' ? undefined : { weight: rest.t === undefined ? 1 : undefined, ...rest, field };
  }));
  choices.classList.add('wrap');
  const keep = h('button', { type: 'button', class: 'plain', title: 'Saves this field beside the design and makes it the guidance', onclick: () => app.store.post('/api/keep') }, 'Keep this field');
  const hold = slider('Hold', { least: 0.01, most: 100, value: 1 }, (v, gesture) => app.change((d) => { d.guidance.weight = v; }, gesture), () => app.store.rest());
  hold.title = 'How closely the field follows it away from edits';
  const t = numberRow('t instead of Hold', 'The parameter of Knöppel et al. 2013, instead of Hold: −1 holds as much as Hold 1; larger values, up to λ₁, hold less', (value) => app.change((d) => {
    const { weight, weights, t: old, ...rest } = d.guidance;
    d.guidance = value === null ? { ...rest, weight: 1 } : { ...rest, t: value };
  }));
  const said = h('span', {}), remove = h('button', { type: 'button', class: 'plain', onclick: () => app.change((d) => { delete d.guidance.weights; }) }, 'Remove');
  const weights = h('div', { class: 'row' }, said, remove);
  const load = jsonButton(app, 'Weights at vertices…', 'A JSON file with a list of numbers, one per vertex, that multiply Hold', (list) => app.change((d) => {
    d.guidance = { ...d.guidance, weights: list };
    delete d.guidance.t;
  }));
  const details = more('More options', t, weights, load);
  const element = h('div', { class: 'guidance' }, h('h2', { class: 'sub' }, 'Away from edits'), choices, hold, details, keep);
  element.refresh = (design) => {
    const g = design.guidance, eigen = design.method === 'eigen', value = g?.file ? 'file' : g?.field || 'none';
    choices.set(value);
    for (const b of choices.children) {
      const v = b.dataset.value;
      b.hidden = v === 'file' && !g?.file;
      if (v === 'file' && g?.file) b.textContent = g.file.split('/').at(-1);
      // Principal directions are lines.
      b.disabled = (/curvature/.test(v) && design.n % 2 === 1) || (v === 'least-curvature' && design.n !== 2);
    }
    hold.hidden = value === 'none' || g.t !== undefined;
    hold.set(g?.weight ?? 1);
    details.hidden = value === 'none';
    t.hidden = eigen;
    t.set(g?.t);
    weights.hidden = !g?.weights;
    if (g?.weights) said.textContent = `${count(g.weights.length)} weights, ${plain(Math.min(...spread(g.weights)))} to ${plain(Math.max(...spread(g.weights)))}`;
  };
  return element;
}

/** Some of a long list, both ends of its range among them. */
function spread(list) {
  return [list.reduce((a, b) => Math.min(a, b), Infinity), list.reduce((a, b) => Math.max(a, b), -Infinity)];
}

/** How the deviation that the connection minimises is weighed, where the polar map looks, and what it is near to. */
export function connectionDetails(app) {
  const edit = (act) => (v, gesture) => app.change((d) => act((d.connection ??= { kind: 'global' }), v), gesture);
  const rest = () => app.store.rest();
  const detail = slider('Detail', { least: 0.01, most: 100, value: 1 }, edit((c, v) => { c.detail = v; }), rest);
  detail.title = 'Smaller values spread the curvature of a vertex over more faces, so that the field ignores small bumps';
  const center = segmented('Centre', [['polar', 'Incentre', 'Directions at corners aim at the centre of the inscribed circle'], ['polar-barycenter', 'Barycentre', 'Directions at corners aim at the centre of mass']], 'polar', edit((c, v) => { c.kind = v; }));
  const factor = segmented('Length factor', [['mean_edge', 'Mean edge', 'Independent of scale and of edge density'], ['metric', 'Metric', 'Lengths as they are'], ['per_edge', 'Per edge', 'Each edge by its own length']], 'mean_edge', edit((c, v) => { c.length_factor = v; }));
  const cap = slider('Tan cap', { least: 1, most: 100, value: 10 }, edit((c, v) => { c.tan_cap = v; }), rest);
  cap.title = 'The largest tangent of a half angle that counts, so that thin faces do not dominate';
  const weighing = more('Weights of the deviation', factor, cap);
  const said = h('span', {}), remove = h('button', { type: 'button', class: 'plain', onclick: edit((c) => { delete c.target; delete c.spread; }) }, 'Remove');
  const spreads = toggle('Spread its curvature', true, (v) => edit((c) => { if (v) delete c.spread; else c.spread = false; })());
  spreads.title = 'On: as far as is optimal. Off: the curvature of a vertex stays in the faces around it';
  const target = h('div', { class: 'target' }, h('div', { class: 'row' }, said, remove), spreads);
  const load = jsonButton(app, 'Load a target connection…', 'A JSON file with one of rotation, adjustment, vertex_curvature, face_curvature: see docs/design.md', (json) => edit((c) => {
    for (const key of ['cones', 'holonomy', 'loops', 'balance']) delete c[key];
    Object.assign(c, { kind: 'metric', target: json.target || json });
  })());
  const element = h('div', { class: 'connection' }, detail, center, weighing, target, load);
  element.refresh = (design) => {
    const c = design.connection || {}, kind = c.kind || 'global', optimal = kind !== 'local' && !kind.startsWith('polar');
    detail.hidden = weighing.hidden = !optimal;
    detail.set(c.detail ?? 1);
    factor.set(c.length_factor || 'mean_edge');
    cap.set(c.tan_cap ?? 10);
    center.hidden = !kind.startsWith('polar');
    center.set(kind);
    load.hidden = kind !== 'metric';
    target.hidden = !c.target;
    if (!c.target) return;
    const [[key, list]] = Object.entries(c.target);
    said.textContent = `Target: ${count(list.length)} ${targets[key] || key}`;
    spreads.set(c.spread !== false);
  };
  return element;
}

/** What the file of the design said that its list of controls does not. */
export function remarksOf(app) {
  const said = h('div', {});
  const comment = h('input', { type: 'text', class: 'comment', 'aria-label': 'Comment', placeholder: 'Comment', onchange: () => app.change((d) => {
    if (comment.value) d.comment = comment.value;
    else delete d.comment;
  }) });
  const element = h('div', { class: 'remarks' }, said, comment);
  element.refresh = (design) => {
    if (document.activeElement !== comment) comment.value = design.comment || '';
    said.replaceChildren(...(app.view.meta.came || []).map((text) => h('p', { class: 'quiet' }, text)));
  };
  return element;
}
