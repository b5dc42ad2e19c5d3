// SPDX-License-Identifier: MIT
//
// feature_panel.js: the part of the panel for sharp edges, `features` of a design: which edges these are, from an angle on
// that is found by looking, and whether the field is drawn to them or held, along or across.
import { more, numberRow } from './design_panel.js';
import { count, h, segmented, short, toggle } from './dom.js';
import { slider } from './slider.js';

/** The edges that a design names itself, instead of an angle; null where it does not. */
const named = ({ file, edges }) => (file ? `the edges in ${file.split('/').at(-1)}` : edges ? `${count(edges.length)} named ${edges.length === 1 ? 'edge' : 'edges'}` : null);

/** Keys of `features` that are set one by one: what is left out has its default. */
function editing(app) {
  const set = (key, none = null) => (v, gesture) => app.change(({ features }) => {
    if (v === none || v === null) delete features[key];
    else features[key] = v;
  }, gesture);
  const bend = (v, gesture) => app.change(({ features }) => {
    features.angle = Math.round(v);
    if (features.low_angle > features.angle) features.low_angle = features.angle;
  }, gesture);
  return { set, bend, rest: () => app.store.rest() };
}

function moreControls(set) {
  const boundary = toggle('With the boundary', false, set('boundary', false));
  boundary.title = 'Edges of the boundary are features too';
  const low = numberRow('Join from °', 'Hysteresis: edges that fold by at least this are features as well where they are joined to sharper ones; empty: off', set('low_angle'));
  const gap = numberRow('Gap', 'Ends of lines this close to another feature are joined to it, in the unit of the mesh; empty: off', set('gap'));
  const spur = numberRow('Spur', 'Lines with an end that are shorter than this are left out, in the unit of the mesh; empty: off', set('spur'));
  const corner = numberRow('Corner from °', 'Lines that turn by at least this break there; empty: 40', set('corner_angle'));
  const element = more('More options', boundary, low, gap, spur, corner);
  element.refresh = (features, rim) => {
    // What names its edges has no angles, and names those of the boundary itself.
    const own = named(features) !== null;
    boundary.hidden = own || !(rim || features.boundary);
    boundary.set(Boolean(features.boundary));
    low.hidden = own;
    low.set(features.low_angle || undefined);
    gap.set(features.gap || undefined);
    spur.set(features.spur || undefined);
    corner.set(features.corner_angle);
  };
  return element;
}

/** How many lines there are, and how well the field follows them. */
function outcome(features, { arrays, meta }, report) {
  const lines = (arrays.crease_offsets?.length || 1) - 1, own = named(features);
  if (!lines) return own ? `No line along ${own}.` : features.spur ? 'No line is left.' : 'No edge folds by that much.';
  const free = meta.free_corners ? `; free at ${count(meta.free_corners)} ${meta.free_corners === 1 ? 'corner' : 'corners'}, where no field follows them all` : '';
  return `${count(lines)} ${lines === 1 ? 'line' : 'lines'}${own ? ` of ${own}` : ''}${report ? `, ${features.hold ? 'held' : 'followed'} to ${short(report.error_degrees)}°` : ''}${free}`;
}

export function featureControls(app) {
  const { set, bend, rest } = editing(app);
  const on = toggle('Creases', false, (v) => app.change((d) => {
    if (v) d.features = { angle: 40 };
    else delete d.features;
  }));
  on.title = 'The field runs along sharp edges';
  const how = segmented('At creases', [['follow', 'Follow', 'Draws the field to them, as strokes do'], ['hold', 'Hold exactly', 'The direction is exact at every vertex of them']], 'follow', (v) => set('hold', false)(v === 'hold'));
  const way = segmented('Way of creases', [['along', 'Along', 'The field runs along them'], ['across', 'Across', 'The field runs across them']], 'along', (v) => set('across', false)(v === 'across'));
  const angle = slider('Angle', { least: 1, most: 180, value: 40, even: true, unit: '°' }, bend, rest);
  angle.title = 'Edges that fold by at least this are creases';
  const weight = slider('Weight', { least: 0.1, most: 1000, value: 1 }, set('weight'), rest);
  const details = moreControls(set), said = h('p', { class: 'quiet', role: 'status' });
  const body = h('div', {}, how, way, angle, weight, details, said);
  const element = h('div', { class: 'features' }, on, body);
  element.refresh = (design, reports) => {
    const { features } = design;
    on.set(Boolean(features));
    on.hidden = design.n % 2 === 1;
    body.hidden = !features;
    if (!features) return;
    how.set(features.hold ? 'hold' : 'follow');
    // A cross along an edge is one across it.
    way.hidden = design.n % 4 === 0 && !features.across;
    way.set(features.across ? 'across' : 'along');
    angle.hidden = named(features) !== null;
    angle.set(features.angle ?? 40);
    weight.set(features.weight ?? 1);
    weight.title = features.hold ? 'How strongly lengths along creases are drawn to 1' : 'How strongly the field is drawn to them';
    details.refresh(features, app.view.meta.boundary);
    said.textContent = outcome(features, app.view, (reports || []).find((r) => r.path === '/features'));
  };
  return element;
}
