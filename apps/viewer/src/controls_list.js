// SPDX-License-Identifier: MIT
//
// controls_list.js: everything that a design asks for, each with what became of it; the chosen one with its numbers. A
// control keeps its row while it is there, so that no edit takes a button or a slider from under the hand.
import { remarksOf } from './design_panel.js';
import { arrange, h, matched, plain, section, short, toggle } from './dom.js';
import { isNegative, mostZeros, titleOf } from './indices.js';
import { slider } from './slider.js';
import { angleIn, direction } from './tangent.js';

export function controlsSection(app) {
  const list = h('ul', { class: 'controls' }), remarks = remarksOf(app), kinds = kindsOfRows(app);
  const empty = h('li', { class: 'empty' }, 'Nothing yet. Choose a tool on the left, then click on the surface; with the brush, draw on it.');
  const element = section('Design', list, remarks);
  element.refresh = (design, reports) => {
    const report = new Map((reports || []).map((r) => [r.path, r])), seen = [...list.querySelectorAll('button, input')].indexOf(document.activeElement);
    remarks.refresh(design);
    const rows = kinds.flatMap((kind) => kind.refresh(design, report));
    arrange(list, rows.length ? rows : empty);
    // The row of what had the focus is gone: the next one has it.
    if (seen >= 0 && !list.contains(document.activeElement)) list.querySelectorAll('button, input')[seen]?.focus();
  };
  return element;
}

/** The three lists of a design: how a row says which one it is, what it does, and its numbers. */
function kindsOfRows(app) {
  const rest = () => app.store.rest();
  const degrees = (angle) => Math.round((((angle || 0) % 360) + 360) % 360);
  return [
    rowsOf('singularities', {
      chosen: () => app.selected, choose: (k) => app.select(k), remove: (k) => app.remove(k),
      mark: (s) => (isNegative(s.kind) ? 'mark negative' : 'mark positive'),
      label: (s) => `${s.name || titleOf(s.kind)}${s.count > 1 ? ` × ${s.count}` : ''} · ${degrees(s.angle)}°`,
      numbers: (at) => singularityNumbers(app, at, rest),
    }),
    rowsOf('fixed', {
      chosen: () => app.held, choose: (k) => app.selectFixed(k), remove: (k) => app.removeFixed(k),
      mark: () => 'mark square', label: (f) => f.name || `Direction · vertex ${f.vertex}`,
      numbers: (at) => directionNumbers(app, at, rest),
    }),
    rowsOf('strokes', {
      chosen: () => app.stroked, choose: (k) => app.selectStroke(k), remove: (k) => app.removeStroke(k),
      mark: () => 'mark stroke', label: (s, k) => (s.name ? s.name[0].toUpperCase() + s.name.slice(1) : `Stroke ${k + 1}`),
      numbers: (at) => strokeNumbers(app, at, rest),
    }),
  ];
}

/** Rows of one list. */
function rowsOf(name, kind) {
  let rows = [];
  return { refresh: (design, report) => {
    const controls = design[name] || [], chosen = kind.chosen();
    rows = matched(rows, controls, () => controlRow(kind));
    rows.forEach((row, k) => row.refresh(controls[k], k, k === chosen, design, report.get(`/${name}/${k}`)));
    return rows.map((row) => row.element);
  } };
}

function controlRow(kind) {
  let number = 0, numbers = null;
  const icon = h('i', { 'aria-hidden': 'true' }), text = h('span', {}), state = h('span', {});
  const name = h('button', { type: 'button', class: 'name', onclick: () => kind.choose(number) }, icon, text);
  const close = h('button', { type: 'button', class: 'close', onclick: () => kind.remove(number) }, '×');
  const element = h('li', {});
  const refresh = (control, k, chosen, design, report) => {
    number = k;
    const label = kind.label(control, k);
    if (chosen) (numbers ??= kind.numbers(() => number)).refresh(control, design);
    element.className = chosen ? 'chosen' : '';
    icon.className = kind.mark(control);
    name.setAttribute('aria-pressed', String(chosen));
    text.textContent = label;
    close.setAttribute('aria-label', `Remove ${label}`);
    state.className = report ? (report.met ? 'met' : 'unmet') : '';
    state.textContent = report ? (report.met ? '✓' : `${short(report.error_degrees)}°`) : '';
    state.title = report ? `Off by ${short(report.error_degrees)}°${/^\/strokes/.test(report.path) ? ' on average' : ''}; up to ${short(report.tolerance_degrees)}° counts as met` : '';
    arrange(element, name, state, close, chosen ? numbers.element : null);
  };
  return { element, refresh };
}

/** How many zeros, how strong, whether held in a point, and where its angle starts. */
function singularityNumbers(app, at, rest) {
  const zeros = slider('Zeros', { least: 1, most: mostZeros, value: 1, even: true, steps: mostZeros - 1 }, (v, gesture) => app.setCount(at(), Math.round(v), gesture), rest);
  zeros.title = 'How many zeros lie side by side; from afar they are one of that index';
  const single = h('button', { type: 'button', class: 'plain', onclick: () => app.split(at()) });
  const halves = h('button', { type: 'button', class: 'plain', title: 'Makes two controls of about half the index each (Shift+T)', onclick: () => app.split(at(), true) }, 'In two');
  const split = h('div', { class: 'actions' }, single, halves);
  const strength = slider('Strength', { least: 0.1, most: 100, value: 1 }, (v, gesture) => app.edit(at(), (one) => { one.strength = v; }, gesture), rest);
  const pin = toggle('Exactly here', false, (v) => app.edit(at(), (one) => {
    if (v) one.pin = [1 / 3, 1 / 3, 1 / 3];
    else delete one.pin;
  }));
  pin.title = 'The zero lies at this point, not just in this face';
  // Angles of files may start from a direction of space.
  const from = h('p', { class: 'quiet' });
  const face = h('button', { type: 'button', class: 'plain', title: 'The field stays as it is', onclick: () => app.edit(at(), (one) => {
    one.angle = angleIn(app.view.surface, one.face, direction(app.view.surface, one.face, one.angle || 0, one.relative_to));
    delete one.relative_to;
  }) }, 'Start from the face');
  const element = h('div', { class: 'numbers' }, zeros, split, strength, pin, from, face);
  const refresh = (s, design) => {
    const count = s.count ?? 1;
    // A vortex and its like are single.
    zeros.hidden = !['source', 'saddle', 'wedge', 'trisector'].includes(s.kind);
    zeros.set(count);
    split.hidden = count < 2;
    halves.hidden = count < 3;
    single.textContent = `Split into ${count}`;
    single.title = `Makes ${count} controls of one zero each, around this place (T)`;
    strength.set(s.strength ?? 1);
    pin.set(Boolean(s.pin));
    from.hidden = face.hidden = !s.relative_to;
    if (s.relative_to) from.textContent = `Its angle starts from the direction ${s.relative_to.map(plain).join(', ')}.`;
  };
  return { element, refresh };
}

/** Whether a direction has a length, and which. */
function directionNumbers(app, at, rest) {
  const free = toggle('Any length', false, (v) => app.editFixed(at(), (one) => {
    if (v) one.length = 'free';
    else delete one.length;
  }));
  free.title = 'Holds the direction only, not the length of the field';
  const length = slider('Length', { least: 0.01, most: 100, value: 1 }, (v, gesture) => app.editFixed(at(), (one) => { one.length = v; }, gesture), rest);
  const element = h('div', { class: 'numbers' }, free, length);
  const refresh = (f, design) => {
    element.hidden = design.method === 'eigen';
    free.set(f.length === 'free');
    length.hidden = f.length === 'free';
    if (f.length !== 'free') length.set(f.length ?? 1);
  };
  return { element, refresh };
}

function strokeNumbers(app, at, rest) {
  const weight = slider('Weight', { least: 0.1, most: 1000, value: 1 }, (v, gesture) => app.editStroke(at(), (one) => { one.weight = v; }, gesture), rest);
  const width = slider('Width', { least: 0, most: 0.2 * app.view.meta.diagonal, value: 0, even: true }, (v, gesture) => app.editStroke(at(), (one) => { one.radius = v; }, gesture), rest);
  const element = h('div', { class: 'numbers' }, weight, width);
  const refresh = (s) => {
    weight.set(s.weight ?? 1);
    width.set(s.radius ?? 0);
  };
  return { element, refresh };
}
