// SPDX-License-Identifier: MIT
//
// panel.js: the parts of the side panel that describe a result and choose what of it is shown, the card about a place
// on the surface, and the help.
import { gradient } from './colors.js';
import { count, fieldName, fraction, h, section, segmented, short, toggle } from './dom.js';

/** Folds to its header on phones. */
export function makePanel(header, ...sections) {
  const panel = h('aside', { class: 'panel', 'aria-label': 'Result and display' });
  const fold = h('button', { class: 'fold', type: 'button', 'aria-expanded': 'false', 'aria-label': 'Show or hide details', onclick: () => {
    fold.setAttribute('aria-expanded', String(panel.classList.toggle('open')));
  } }, h('i', { 'aria-hidden': 'true' }));
  panel.append(fold, header, h('div', { class: 'scroll' }, ...sections));
  return panel;
}

export function makeHeader(meta) {
  const chip = meta.holds === undefined ? null
    : h('span', { class: meta.holds ? 'chip good' : 'chip bad', title: meta.holds ? 'Residual, indices and convergence were checked' : 'Something did not converge or match; see the report' },
      meta.holds ? (meta.met === false ? '✓ Certified · design not met' : '✓ Certified') : '! Not certified');
  return h('header', {}, h('h1', {}, meta.title), h('p', { class: 'sub' }, `${fieldName(meta.n)} · n = ${meta.n}`), chip);
}

export function displaySection(view) {
  const s = view.state;
  const lines = segmented('Field as', [['curves', 'Curves', 'Evenly spaced integral curves (1)'], ['glyphs', 'Glyphs', 'Branches at vertices (2)'], ['none', 'Off', 'Only the surface (3)']], s.lines,
    (v) => view.set('lines', v));
  const rows = [['singularities', 'Singularities', 'S'], ['arms', 'Orientation', 'O'], ['separatrices', 'Separatrices', 'X']]
    .map(([key, text, letter]) => [letter, toggle(text, s[key], (v) => view.set(key, v), letter)]);
  const element = section('Field', lines, ...rows.map((r) => r[1]));
  element.keys = {
    1: () => choose('curves'), 2: () => choose('glyphs'), 3: () => choose('none'),
    ...Object.fromEntries(rows.map(([letter, row]) => [letter.toLowerCase(), () => row.flip()])),
  };
  function choose(value) {
    lines.set(value);
    view.set('lines', value);
  }
  return element;
}

/** In the studio the numbers come when they are first asked for; what there will be is in meta.offered. */
export function colorSection(view) {
  const legend = h('figure', { class: 'legend', hidden: true });
  let list = [];
  const choose = (name) => {
    view.set('color', name);
    element.refresh();
  };
  const chips = segmented('Colour by', [], view.state.color, choose);
  chips.classList.add('wrap');
  const element = section('Colour', chips, legend);
  element.offer = () => {
    const offered = view.meta.offered || view.meta.scalars || [];
    list = [['', 'Plain', 'No colours'], ...offered.map((s) => [s.name, s.label, s.help])];
    element.hidden = !offered.length;
    chips.offer(list);
    chips.set(view.state.color);
    element.refresh();
  };
  element.refresh = () => {
    const s = (view.meta.scalars || []).find((one) => one.name === view.state.color);
    legend.hidden = !s;
    if (!s) return;
    legend.replaceChildren(
      h('div', { class: 'bar', style: `background:${gradient(s.diverging ? 'diverging' : 'sequential')}` }),
      h('div', { class: 'ticks' }, h('span', {}, short(s.low)), h('span', {}, short((s.low + s.high) / 2)), h('span', {}, short(s.high))),
      h('figcaption', {}, `${s.help[0].toUpperCase()}${s.help.slice(1)}. The outermost 2 % share the end colours.`),
    );
  };
  element.keys = { c: () => {
    const next = list[(list.findIndex((l) => l[0] === view.state.color) + 1) % list.length][0];
    chips.set(next);
    choose(next);
  } };
  element.offer();
  return element;
}

/** Counts per index, and their sum, which topology decides. */
export function singularitySection(view) {
  const body = h('div', { class: 'counts' });
  const element = section('Singularities', body);
  element.refresh = () => {
    const { n, euler } = view.meta;
    const S = view.arrays.singular || [];
    const counts = new Map();
    let sum = 0;
    for (let k = 6; k < S.length; k += 8) {
      counts.set(S[k], (counts.get(S[k]) || 0) + 1);
      sum += S[k];
    }
    const rows = [...counts].sort((a, b) => b[0] - a[0]).map(([index, number]) => h('div', { class: 'row' },
      h('span', {}, mark(index), ` index ${fraction(index, n)}`), h('b', {}, count(number))));
    body.replaceChildren(...(rows.length ? rows : [h('p', { class: 'quiet' }, 'None: the field vanishes nowhere.')]),
      h('div', { class: 'row sum' }, h('span', {}, 'Sum of indices'), h('b', {}, fraction(sum, n) || '0')),
      ...(euler === undefined ? [] : [h('div', { class: 'row' }, h('span', {}, 'Euler characteristic'), h('b', {}, String(euler).replace('-', '−')))]));
  };
  element.refresh();
  return element;
}

export function mark(index) {
  return h('i', { class: index > 0 ? 'mark positive' : 'mark negative', 'aria-hidden': 'true' });
}

export function figuresSection(view) {
  const rows = [['Vertices', count(view.arrays.positions.length / 3)], ['Faces', count(view.arrays.faces.length / 3)], ...(view.meta.figures || [])];
  return section('Figures', h('dl', {}, rows.map(([label, value]) => h('div', { class: 'row' }, h('dt', {}, label), h('dd', {}, value)))));
}

/** What is known about a place: shown beside the pointer's last click. */
export function makeCard(view) {
  const card = h('div', { class: 'card', role: 'status', hidden: true });
  card.show = (hit) => {
    card.hidden = !hit;
    view.highlight(-1);
    if (!hit) return;
    const rows = [];
    const near = view.near(hit.point);
    const head = h('p', { class: 'head' });
    if (near >= 0) {
      const index = view.arrays.singular[8 * near + 6];
      hit = { ...hit, face: view.arrays.singular_faces[near] };
      head.append(mark(index), ` Singularity ${fraction(index, view.meta.n)}`);
      rows.push(['Turned by', `${short((view.arrays.singular[8 * near + 7] * 180) / Math.PI)}°`]);
    } else {
      head.append(`Face ${count(hit.face)}`);
    }
    if (near >= 0) rows.unshift(['Face', count(hit.face)]);
    view.highlight(hit.face);
    for (const s of view.meta.scalars || []) {
      const values = view.arrays[`scalar.${s.name}`];
      if (values) rows.push([s.label, short(values[hit.face])]);
    }
    const close = h('button', { type: 'button', class: 'close', 'aria-label': 'Close', onclick: () => card.show(null) }, '×');
    card.replaceChildren(head, close, h('dl', {}, rows.map(([a, b]) => h('div', { class: 'row' }, h('dt', {}, a), h('dd', {}, b)))));
  };
  return card;
}

export function makeHelp(rows) {
  const dialog = h('dialog', { class: 'help', 'aria-label': 'Keys' },
    h('h2', {}, 'Keys'), h('dl', {}, rows.map(([keys, text]) => h('div', { class: 'row' }, h('dt', {}, keys.split(' ').map((k) => h('kbd', {}, k))), h('dd', {}, text)))),
    h('form', { method: 'dialog' }, h('button', { class: 'plain' }, 'Close')));
  dialog.addEventListener('click', (event) => { if (event.target === dialog) dialog.close(); });
  return dialog;
}
