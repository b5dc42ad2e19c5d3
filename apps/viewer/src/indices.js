// SPDX-License-Identifier: MIT
//
// indices.js: the kinds of singularities that a design can ask for, the index of each in n-ths, and how an index is one
// control: several zeros side by side are a source or a saddle.
import { angleIn, direction } from './tangent.js';

const titles = { source: 'Source', sink: 'Sink', vortex: 'Vortex', spiral: 'Spiral', saddle: 'Saddle', wedge: 'Wedge', trisector: 'Trisector' };

export const mostZeros = 8;  // side by side in a design

/** Kinds that a field of symmetry n has, with their index. */
export function kindsOf(n) {
  if (n === 1) return [['source', 1], ['sink', 1], ['vortex', 1], ['saddle', -1]];
  if (n === 2) return [['wedge', 1], ['trisector', -1]];
  return [['source', 1], ['saddle', -1]];
}

export const titleOf = (kind) => titles[kind];

export const isNegative = (kind) => kind === 'saddle' || kind === 'trisector';

export const indexOf = (s) => (isNegative(s.kind) ? -1 : 1) * (s.count || 1);

/** Whether a control can ask for this index, in n-ths. */
export const holdable = (index) => index !== 0 && Math.abs(index) <= mostZeros;

/** Whether its angle is a swirl, the same in every face: patterns of index 1 have no straight branches. */
export const swirls = (s, n) => indexOf(s) === n;

/** The kind of a control of this index; of one zero the kind of before, where its sign is the same. */
export function kindFor(index, n, before) {
  const sign = index > 0 ? 1 : -1;
  if (Math.abs(index) > 1) return index > 0 ? 'source' : 'saddle';
  const kinds = kindsOf(n).filter(([, one]) => one === sign).map(([kind]) => kind);
  return kinds.includes(before) ? before : kinds[0];
}

/** Makes a singularity one of another index. */
export function setIndex(surface, s, index, n) {
  s.kind = kindFor(index, n, s.kind);
  if (Math.abs(index) > 1) s.count = Math.abs(index);
  else delete s.count;
  if (!s.relative_to || !swirls(s, n)) return;
  s.angle = angleIn(surface, s.face, direction(surface, s.face, s.angle || 0, s.relative_to));
  delete s.relative_to;
}
