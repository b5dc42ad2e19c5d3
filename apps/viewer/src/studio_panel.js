// SPDX-License-Identifier: MIT
//
// studio_panel.js: the parts of the studio's panel that say what the design is and change it.
import { connectionDetails, guidanceControls } from './design_panel.js';
import { arrange, count, fraction, h, plain, section, segmented, short, toggle } from './dom.js';
import { featureControls } from './feature_panel.js';
import { indexOf, setIndex } from './indices.js';
import { numberInput } from './number_input.js';
import { mark } from './panel.js';
import { slider } from './slider.js';

/** Text or number of a cone's index as a number. */
export function coneIndex(index) {
  if (typeof index === 'number') return index;
  const [a, b = '1'] = String(index).split('/');
  return Number(a) / Number(b);
}

export function fieldSection(app) {
  const n = segmented('Symmetry', [[1, 'Vector', '1'], [2, 'Line', '2'], [4, 'Cross', '4'], [6, 'Hex', '6']], 4, (v) => app.change((d) => setSymmetry(d, Number(v), app.view.surface)));
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
function setSymmetry(design, n, surface) {
  design.n = n;
  if (n % 2 === 1) delete design.features;
  // A file holds a field of one symmetry; principal directions are lines, and the smallest curvature has one.
  const { file, ...guidance } = design.guidance || {};
  const left = file || (n % 2 === 1 && /curvature/.test(guidance.field)) || (n !== 2 && guidance.field === 'least-curvature');
  if (left) design.guidance = { ...guidance, field: 'smoothest' };
  for (const s of design.singularities || []) setIndex(surface, s, indexOf(s), n);
  for (const c of design.connection?.cones || []) c.index = Math.round(coneIndex(c.index) * n) / n;
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
