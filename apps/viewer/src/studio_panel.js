// SPDX-License-Identifier: MIT
//
// studio_panel.js: the parts of the studio's panel that say what the design is and change it.
import { connectionDetails, guidanceControls, remarksOf } from './design_panel.js';
import { arrange, count, fraction, h, plain, section, segmented, short, toggle } from './dom.js';
import { numberInput } from './number_input.js';
import { mark } from './panel.js';
import { slider } from './slider.js';
import { angleIn, direction } from './tangent.js';

const titles = { source: 'Source', sink: 'Sink', vortex: 'Vortex', spiral: 'Spiral', saddle: 'Saddle', wedge: 'Wedge', trisector: 'Trisector' };

/** Kinds that a field of symmetry n has, with their index. */
export function kindsOf(n) {
  if (n === 1) return [['source', 1], ['sink', 1], ['vortex', 1], ['saddle', -1]];
  if (n === 2) return [['wedge', 1], ['trisector', -1]];
  return [['source', 1], ['saddle', -1]];
}

export const titleOf = (kind) => titles[kind];

/** Text or number of a cone's index as a number. */
export function coneIndex(index) {
  if (typeof index === 'number') return index;
  const [a, b = '1'] = String(index).split('/');
  return Number(a) / Number(b);
}

export function fieldSection(app) {
  const n = segmented('Symmetry', [[1, 'Vector', '1'], [2, 'Line', '2'], [4, 'Cross', '4'], [6, 'Hex', '6']], 4, (v) => app.change((d) => setSymmetry(d, Number(v))));
  n.append(h('button', { type: 'button', role: 'radio', hidden: true, title: 'The symmetry of the design' }));
  const connection = segmented('Connection', [['global', 'Global', 'As Levi-Civita as possible'], ['local', 'Local', 'Its cheap approximation'], ['polar', 'Polar', 'Of the geodesic polar map around each vertex'], ['trivial', 'Cones', 'Flat except at cones that you place'], ['metric', 'Metric', 'Cones and turns around loops of any size, or the connection closest to one of your own']], 'global',
    (v) => app.change((d) => setConnection(d, v)));
  connection.classList.add('wrap');
  const details = connectionDetails(app), guidance = guidanceControls(app);
  const method = segmented('Method', [['variational', 'Exact', 'Holds the controls; elsewhere stays close to a given field'], ['eigen', 'Eigen', 'The smoothest field that follows the strokes and has the singularities']], 'variational', (v) => app.change((d) => setMethod(d, v)));
  const energy = slider('Energy', { least: -1, most: 1, value: 0, even: true }, (v, gesture) => app.change((d) => { d.s = Number(v.toFixed(2)); }, gesture), () => app.store.rest());
  energy.title = 'Which derivative counts: −1 antiholomorphic, 0 Dirichlet, 1 holomorphic';
  const boundary = boundaryControl(app);
  const features = featureControls(app);
  const mirror = mirrorControl(app);
  const element = section('Field', n, h('h2', { class: 'sub' }, 'Connection'), connection, details, h('h2', { class: 'sub' }, 'Method'), method, guidance, energy, boundary, features, mirror);
  element.refresh = (design, reports) => {
    const other = n.lastChild;
    other.hidden = [1, 2, 4, 6].includes(design.n);
    other.textContent = other.dataset.value = other.hidden ? '' : design.n;
    n.set(design.n);
    connection.set((design.connection?.kind || 'global').replace('-barycenter', ''));
    details.refresh(design);
    guidance.refresh(design);
    method.set(design.method || 'variational');
    energy.set(design.s || 0);
    boundary.refresh(design, reports);
    features.refresh(design, reports);
  };
  return element;
}

/** A stroke along every boundary loop, or across it. */
function boundaryControl(app) {
  const choices = segmented('Boundary', [['none', 'Free', 'No alignment with the boundary'], ['tangent', 'Along', 'Along every loop of the boundary'], ['normal', 'Across', 'Across every loop of the boundary']], 'none', (v) => app.change((d) => {
    if (v === 'none') delete d.boundary;
    else d.boundary = { ...d.boundary, align: v };
  }));
  const weight = slider('Weight', { least: 0.1, most: 1000, value: 1 }, (v, gesture) => app.change((d) => { d.boundary.weight = v; }, gesture), () => app.store.rest());
  const said = h('p', { class: 'quiet', role: 'status' });
  const element = h('div', { class: 'boundary' }, h('h2', { class: 'sub' }, 'Boundary'), choices, weight, said);
  element.refresh = (design, reports) => {
    element.hidden = !app.view.meta.boundary;
    weight.hidden = said.hidden = !design.boundary;
    choices.set(design.boundary?.align || 'none');
    if (!design.boundary) return;
    weight.set(design.boundary.weight ?? 1);
    const report = (reports || []).find((r) => r.path === '/boundary');
    said.textContent = report ? `Followed to ${short(report.error_degrees)}°.` : '';
  };
  return element;
}

/** Strokes along sharp edges, from an angle on that is found by looking. */
function featureControls(app) {
  const on = toggle('Along creases', false, (v) => app.change((d) => {
    if (v) d.features = { angle: 40 };
    else delete d.features;
  }));
  const angle = slider('Angle', { least: 1, most: 180, value: 40, even: true, unit: '°' }, (v, gesture) => app.change((d) => { d.features.angle = Math.round(v); }, gesture), () => app.store.rest());
  angle.title = 'Edges that fold by at least this are creases';
  const weight = slider('Weight', { least: 0.1, most: 1000, value: 1 }, (v, gesture) => app.change((d) => { d.features.weight = v; }, gesture), () => app.store.rest());
  const said = h('p', { class: 'quiet', role: 'status' });
  const element = h('div', { class: 'features' }, on, angle, weight, said);
  element.refresh = (design, reports) => {
    const wanted = Boolean(design.features);
    on.set(wanted);
    on.hidden = design.n % 2 === 1;
    angle.hidden = weight.hidden = said.hidden = !wanted;
    if (!wanted) return;
    angle.set(design.features.angle ?? 40);
    weight.set(design.features.weight ?? 1);
    const lines = (app.view.arrays.crease_offsets?.length || 1) - 1, report = (reports || []).find((r) => r.path === '/features');
    said.textContent = lines ? `${count(lines)} ${lines === 1 ? 'line' : 'lines'}${report ? `, followed to ${short(report.error_degrees)}°` : ''}` : 'No edge folds by that much.';
  };
  return element;
}

/** A plane on whose other side everything happens as well; only those that the surface has. */
function mirrorControl(app) {
  const choices = segmented('Mirror', [[-1, 'Off', 'Edits are not repeated'], ...['X', 'Y', 'Z'].map((name, axis) => [axis, name, `Repeats every edit across the plane ${name} = 0 through the middle`])], -1, (v) => {
    app.mirror.axis = Number(v);
  });
  const element = h('div', { hidden: true }, h('h2', { class: 'sub' }, 'Mirror edits'), choices);
  // Not in the way of the first picture.
  setTimeout(() => {
    const axes = app.mirror.axes();
    element.hidden = !axes.length;
    for (const b of choices.children) b.disabled = Number(b.dataset.value) >= 0 && !axes.includes(Number(b.dataset.value));
  }, 300);
  return element;
}

/** What the other method does not take is left out; undo brings it back. */
function setMethod(design, method) {
  if (method === 'variational') {
    delete design.method;
    design.guidance ??= { field: 'smoothest', weight: 1 };
    return;
  }
  design.method = method;
  // What an exact design has where nobody chose; any other stays, but lambda_t is what a weight makes of it here.
  if (design.guidance?.field === 'smoothest') delete design.guidance;
  if (design.guidance) delete design.guidance.t;
}

/** Cones stay where both kinds have them; those of a trivial connection are multiples of 1/n. */
function setConnection(design, kind) {
  const old = design.connection || {}, { cones, holonomy, loops, balance, target, ...rest } = old;
  const flat = kind === 'trivial' || kind === 'metric';
  design.connection = { ...rest, kind, ...(flat && cones ? { cones } : {}) };
  if (kind === 'metric' && holonomy) design.connection.holonomy = holonomy;
  if (kind === 'metric' && loops) design.connection.loops = loops;
  if (kind === 'trivial') for (const c of cones || []) c.index = Math.round(coneIndex(c.index) * design.n) / design.n;
}

/** Kinds are those of the new symmetry: by their sign. */
function setSymmetry(design, n) {
  design.n = n;
  if (n % 2 === 1) delete design.features;
  // A file holds a field of one symmetry; principal directions are lines, and the smallest curvature has one.
  const { file, ...guidance } = design.guidance || {};
  const left = file || (n % 2 === 1 && /curvature/.test(guidance.field)) || (n !== 2 && guidance.field === 'least-curvature');
  if (left) design.guidance = { ...guidance, field: 'smoothest' };
  const negative = (kind) => kind === 'saddle' || kind === 'trisector';
  for (const s of design.singularities || []) {
    s.kind = s.count > 1 ? (negative(s.kind) ? 'saddle' : 'source') : kindsOf(n).find(([, index]) => (index < 0) === negative(s.kind))[0];
  }
  for (const c of design.connection?.cones || []) c.index = Math.round(coneIndex(c.index) * n) / n;
}

/** Everything that was asked for, each with what became of it; the chosen one with its numbers. */
export function controlsSection(app) {
  const list = h('ul', { class: 'controls' }), remarks = remarksOf(app);
  const element = section('Design', list, remarks);
  let shape = '', updates = [];
  element.refresh = (design, reports) => {
    const report = new Map((reports || []).map((r) => [r.path, r]));
    remarks.refresh(design);
    const rows = [
      ...(design.singularities || []).map((s, k) => ({
        path: `/singularities/${k}`, icon: () => mark(s.kind === 'saddle' || s.kind === 'trisector' ? -1 : 1), chosen: k === app.selected, kind: `${design.n === 1 ? s.kind : `${design.n}${kindsOf(design.n)[0][0] === s.kind || s.kind === 'source'}`}${design.method}${Boolean(s.relative_to)}`,
        label: `${s.name || titles[s.kind]}${s.count > 1 ? ` × ${s.count}` : ''} · ${Math.round((((s.angle || 0) % 360) + 360) % 360)}°`, choose: () => app.select(k), remove: () => app.remove(k),
        numbers: () => [...countSlider(app, k, s, design.n), slider('Strength', { least: 0.1, most: 100, value: s.strength ?? 1 }, (v, gesture) => app.edit(k, (one) => { one.strength = v; }, gesture), () => app.store.rest()), ...pinToggle(app, k, s), ...startOfAngle(app, k, s)],
      })),
      ...(design.fixed || []).map((f, k) => ({
        path: `/fixed/${k}`, icon: () => h('i', { class: 'mark square' }), chosen: k === app.held, kind: `direction${design.method}${f.length === 'free'}`,
        label: f.name || `Direction · vertex ${f.vertex}`, choose: () => app.selectFixed(k), remove: () => app.removeFixed(k),
        numbers: () => (app.eigen() ? [] : [lengthToggle(app, k, f), ...lengthSlider(app, k, f)]),
      })),
      ...(design.strokes || []).map((s, k) => ({
        path: `/strokes/${k}`, icon: () => h('i', { class: 'mark stroke' }), chosen: k === app.stroked, kind: 'stroke',
        label: s.name ? s.name[0].toUpperCase() + s.name.slice(1) : `Stroke ${k + 1}`, choose: () => app.selectStroke(k), remove: () => app.removeStroke(k),
        numbers: () => [
          slider('Weight', { least: 0.1, most: 1000, value: s.weight ?? 1 }, (v, gesture) => app.editStroke(k, (one) => { one.weight = v; }, gesture), () => app.store.rest()),
          slider('Width', { least: 0, most: 0.2 * app.view.meta.diagonal, value: s.radius ?? 0, even: true }, (v, gesture) => app.editStroke(k, (one) => { one.radius = v; }, gesture), () => app.store.rest()),
        ],
      })),
    ];
    // A slider under the hand stays the element that it is.
    const next = JSON.stringify(rows.map(({ path, chosen, kind }) => [path, chosen, kind]));
    if (next !== shape) {
      shape = next;
      const made = rows.map(controlRow), focus = [...list.querySelectorAll('button, input')].indexOf(document.activeElement);
      list.replaceChildren(...made.map((m) => m.element));
      if (focus >= 0) list.querySelectorAll('button, input')[focus]?.focus();
      updates = made.map((m) => m.update);
      if (!rows.length) list.append(h('li', { class: 'empty' }, 'Nothing yet. Choose a tool on the left, then click on the surface; with the brush, draw on it.'));
    }
    rows.forEach((r, k) => updates[k](r, report.get(r.path)));
  };
  return element;
}

/** Zeros side by side that are one from afar; those of the names wedge and trisector are single. */
function countSlider(app, k, s, n) {
  const negative = s.kind === 'saddle' || s.kind === 'trisector';
  if (!negative && n === 1 && s.kind !== 'source') return [];
  const change = (v, gesture) => app.edit(k, (one, d) => {
    const count = Math.round(v), names = d.n === 2 ? ['wedge', 'trisector'] : ['source', 'saddle'];
    if (count > 1) one.count = count;
    else delete one.count;
    one.kind = count > 1 ? (negative ? 'saddle' : 'source') : names[Number(negative)];
  }, gesture);
  const row = slider('Zeros', { least: 1, most: 8, value: s.count ?? 1, even: true, steps: 7 }, change, () => app.store.rest());
  row.title = 'How many zeros lie side by side; from afar they are one of that index';
  return [row];
}

/** Whether the zero is held where it was put, or only in that face. */
function pinToggle(app, k, s) {
  const row = toggle('Exactly here', Boolean(s.pin), (v) => app.edit(k, (one) => {
    if (v) one.pin = [1 / 3, 1 / 3, 1 / 3];
    else delete one.pin;
  }));
  row.title = 'The zero lies at this point, not just in this face';
  return [row];
}

/** Angles of files may start from a direction of space. */
function startOfAngle(app, k, s) {
  if (!s.relative_to) return [];
  const from = () => app.edit(k, (one) => {
    one.angle = angleIn(app.view.surface, one.face, direction(app.view.surface, one.face, one.angle || 0, one.relative_to));
    delete one.relative_to;
  });
  return [h('p', { class: 'quiet' }, `Its angle starts from the direction ${s.relative_to.map(plain).join(', ')}.`), h('button', { type: 'button', class: 'plain', title: 'The field stays as it is', onclick: from }, 'Start from the face')];
}

function lengthSlider(app, k, f) {
  if (f.length === 'free') return [];
  return [slider('Length', { least: 0.01, most: 100, value: f.length ?? 1 }, (v, gesture) => app.editFixed(k, (one) => { one.length = v; }, gesture), () => app.store.rest())];
}

function lengthToggle(app, k, f) {
  const row = toggle('Any length', f.length === 'free', (v) => app.editFixed(k, (one) => {
    if (v) one.length = 'free';
    else delete one.length;
  }));
  row.title = 'Holds the direction only, not the length of the field';
  return row;
}

function controlRow({ icon, chosen, numbers, choose, remove }) {
  const text = h('span', {}), state = h('span', {});
  const close = h('button', { type: 'button', class: 'close', onclick: remove }, '×');
  const element = h('li', { class: chosen ? 'chosen' : '' },
    h('button', { type: 'button', class: 'name', 'aria-pressed': String(chosen), onclick: choose }, icon(), text), state, close, chosen ? h('div', { class: 'numbers' }, ...numbers()) : null);
  const update = ({ label }, report) => {
    text.textContent = label;
    close.setAttribute('aria-label', `Remove ${label}`);
    state.className = report ? (report.met ? 'met' : 'unmet') : '';
    state.textContent = report ? (report.met ? '✓' : `${short(report.error_degrees)}°`) : '';
    state.title = report ? `Off by ${short(report.error_degrees)}°${/^\/strokes/.test(report.path) ? ' on average' : ''}; up to ${short(report.tolerance_degrees)}° counts as met` : '';
  };
  return { element, update };
}

/** The smoothest fields one after the other, to look at: the design stays as it is. */
export function modesSection(app) {
  const numbers = Array.from({ length: 8 }, (_, k) => [k + 1, String(k + 1), `The ${['smoothest', 'second', 'third', 'fourth', 'fifth', 'sixth', 'seventh', 'eighth'][k]}${k ? ' smoothest' : ''} field of this connection`]);
  const row = segmented('Smoothest field', [[0, 'Design', 'The field of the design'], ...numbers], 0, (k) => app.store.post('/api/mode', { mode: k }));
  row.classList.add('wrap');
  const said = h('p', { class: 'quiet' });
  const element = section('Smoothest fields', row, said);
  element.refresh = (design, { mode = 0, eigenvalues = [] }) => {
    row.set(mode);
    said.textContent = mode ? `λ${mode} = ${short(eigenvalues[mode - 1])}. Export saves this field; the next edit goes back to the design.` : 'The eigenfields of the connection, without controls.';
  };
  return element;
}

/** Sizes, and how long the last edit took: until its field had come, until that was drawn, until the rest was. */
export function memorySection(app) {
  const list = h('dl', {}), element = section('Figures', list);
  const size = (bytes) => (bytes < 1e9 ? `${count(Math.round(bytes / 1e6))} MB` : `${short(bytes / 1e9)} GB`);
  const times = [['opened', 'On screen after'], ['field', 'Field after'], ['shown', 'Drawn after the solve'], ['coarse', 'Coarse curves after'], ['curves', 'Curves after'], ['all', 'Everything after']];
  element.refresh = (view, after) => {
    const rows = [['Vertices', count(view.arrays.positions.length / 3)], ['Faces', count(view.arrays.faces.length / 3)],
      ...(view.meta.memory ? [['Memory used by alcap', size(view.meta.memory)]] : []),
      ...times.filter(([key]) => after[key] !== undefined).map(([key, label]) => [label, `${count(Math.round(after[key]))} ms`])];
    list.replaceChildren(...rows.map(([label, value]) => h('div', { class: 'row' }, h('dt', {}, label), h('dd', {}, value))));
  };
  return element;
}

const minus = (number) => String(number).replace('-', '−');

/** What is missing to the sum that topology demands, in turns; 0 where nothing is. */
function missingTurns(design, euler, closed) {
  const sum = (design.connection?.cones || []).reduce((s, c) => s + coneIndex(c.index), 0);
  const lacks = euler - sum;
  return !closed || design.connection?.balance || Math.abs(lacks) < 1e-6 ? 0 : lacks;
}

/** Cones of a trivial or metric connection, the turns around its loops, and whether cones sum to what topology demands. */
export function conesSection(app) {
  const body = h('div', { class: 'cones' });
  const element = section('Cones', body), rows = turnRows();
  const set = (vertex, index) => app.change((d) => {
    const { cones } = d.connection, k = cones.findIndex((c) => c.vertex === vertex);
    if (index) cones[k].index = index;
    else cones.splice(k, 1);
  });
  const balance = toggleBalance((v) => app.change((d) => { if (v) d.connection.balance = true; else delete d.connection.balance; }));
  element.refresh = (design, euler, closed) => {
    const kind = design.connection?.kind, metric = kind === 'metric';
    element.hidden = (kind !== 'trivial' && !metric) || Boolean(design.connection?.target);
    app.loops?.show(!element.hidden);
    const cones = design.connection?.cones || [], n = design.n;
    const turns = (x) => (metric ? minus(plain(x)) : fraction(Math.round(x * n), n) || '0');
    const sum = cones.reduce((s, c) => s + coneIndex(c.index), 0), lacks = missingTurns(design, euler, closed);
    element.missing = element.hidden || !lacks ? '' : `The cones sum to ${turns(sum)} so far, of ${minus(euler)}.`;
    const at = (c) => [mark(coneIndex(c.index)), ` vertex ${c.vertex}`];
    const typed = (c) => rows.typed(`Cone at vertex ${c.vertex}`, at(c), coneIndex(c.index), 0.05, (v) => set(c.vertex, v));
    const stepped = (c) => rows.stepped(`at vertex ${c.vertex}`, at(c), turns(coneIndex(c.index)), (by) => set(c.vertex, (Math.round(coneIndex(c.index) * n) + by) / n));
    balance.set(Boolean(design.connection?.balance));
    arrange(body,
      cones.map(metric ? typed : stepped),
      h('div', { class: `row sum ${lacks ? 'wrong' : ''}` }, h('span', {}, closed ? `Sum, of ${minus(euler)} needed` : 'Sum'), h('b', {}, turns(sum), lacks ? '' : ' ✓')),
      lacks ? h('p', { class: 'quiet' }, `Place ${metric ? `${lacks > 0 ? '+' : ''}${turns(lacks)}` : turns(lacks)} more: choose the cone tool and click on the surface.`) : null,
      metric ? null : balance,
      loopRows(app, rows, design, metric ? 0.05 : 1 / n),
    );
  };
  return element;
}

/**
 * Rows with a number of turns that is typed or stepped. One that was there before stays the element that it is, so that a
 * refresh takes nothing from under the hand.
 */
function turnRows() {
  const rows = new Map();
  const keep = (key, make) => {
    if (!rows.has(key)) rows.set(key, make());
    return rows.get(key);
  };
  const typed = (label, head, value, step, change) => {
    const row = keep(label, () => {
      const name = h('span', {}), input = numberInput(label, { step }, (v) => row.change(v));
      return { name, input, element: h('div', { class: 'row' }, name, input) };
    });
    row.name.replaceChildren(...head);
    row.change = change;
    row.input.step = String(step);
    row.input.set(Number(value.toPrecision(6)));
    return row.element;
  };
  const stepped = (place, head, text, change) => {
    const row = keep(place, () => {
      const name = h('span', {}), value = h('span', {});
      const button = (label, by, sign) => h('button', { type: 'button', 'aria-label': `${label} ${place}`, onclick: () => row.change(by) }, sign);
      return { name, value, element: h('div', { class: 'row' }, name, h('b', { class: 'stepper' }, button('Less', -1, '−'), value, button('More', 1, '+'))) };
    });
    row.name.replaceChildren(...head);
    row.change = change;
    row.value.textContent = text;
    return row.element;
  };
  return { typed, stepped };
}

/** How far the field has turned after each loop around a handle, and its index at each boundary: those of the connection that was solved, until some are set. */
function loopRows(app, rows, design, step) {
  const { holonomy = [], loop_index: loops = [] } = app.view.meta;
  const typed = (key, values, name) => values.map((value, k) => rows.typed(`${name} ${k + 1}`, [`${name} ${k + 1}`], coneIndex(design.connection?.[key]?.[k] ?? value), step, (v) => app.change((d) => {
    const all = (d.connection[key] || values).map((x) => coneIndex(x));
    all[k] = v;
    d.connection[key] = all;
  })));
  if (!holonomy.length && !loops.length) return [];
  const own = design.connection?.holonomy || design.connection?.loops;
  return [h('h2', { class: 'sub' }, 'Turns around loops'), ...typed('holonomy', holonomy, 'Loop'), ...typed('loops', loops, 'Boundary'),
    own ? h('button', { type: 'button', class: 'plain', title: 'Those that change the surface\'s own connection least', onclick: () => app.change((d) => { delete d.connection.holonomy; delete d.connection.loops; }) }, 'Choose them for me') : h('p', { class: 'quiet' }, 'Chosen to change the connection of the surface least. In turns.')];
}

/** Whether cones are added where the curvature is, until the sum is right. */
function toggleBalance(change) {
  const row = toggle('Add what is missing', false, change);
  row.title = 'Adds cones of the smallest index where the curvature is, until the sum is right';
  return row;
}

export function showSection(view) {
  return section('Show',
    segmented('Field as', [['curves', 'Curves', '1'], ['glyphs', 'Glyphs', '2'], ['none', 'Off', '3']], view.state.lines, (v) => view.set('lines', v)),
    toggle('Singularities', view.state.singularities, (v) => view.set('singularities', v), 'S'),
    toggle('Orientation', view.state.arms, (v) => view.set('arms', v), 'O'),
    toggle('Separatrices', view.state.separatrices, (v) => view.set('separatrices', v), 'X'));
}
