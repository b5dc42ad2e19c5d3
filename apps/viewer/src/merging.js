// SPDX-License-Identifier: MIT
//
// merging.js: two controls that become one, with the sum of their indices, and one of several zeros that becomes several
// controls around its place. In a mirror it happens on both sides.
import { holdable, indexOf, isNegative, kindFor, setIndex, swirls } from './indices.js';
import { angleIn, cross, direction, dot, frame, inside, plus, pointIn, scaled, subtract } from './tangent.js';

const positiveDegrees = (degrees) => ((degrees % 360) + 360) % 360;

/** The angle of a control in the frame of its face, as a number. */
function angleOf(surface, s) {
  const degrees = s.angle || 0;
  return ((s.relative_to ? angleIn(surface, s.face, direction(surface, s.face, degrees, s.relative_to)) : degrees) * Math.PI) / 180;
}

/** Where a control is. */
export const spotOf = (surface, s) => pointIn(surface, s.face, Array.isArray(s.pin) ? s.pin : [1 / 3, 1 / 3, 1 / 3]);

/**
 * What becomes of a design where singularity k is put onto number j, which keeps its place and its angle: {index: of the
 * sum, kind: none where both go, refused: more zeros than a control can have, both: on the other side of a mirror too,
 * apply(design): does it, and returns the number of the sum in the list, -1 for none}.
 */
export function merging(surface, mirror, design, k, j) {
  const list = design.singularities, index = (i) => (i < 0 ? 0 : indexOf(list[i]));
  const twin = mirror.twin(design, k), image = mirror.twin(design, j);
  const own = twin === j, middle = image < 0 && twin >= 0 && mirror.holds(spotOf(surface, list[j]));
  const sum = index(j) + index(k) + (middle ? index(twin) : 0);
  const gone = [k, ...(middle || image >= 0 ? [twin] : [])].filter((i) => i >= 0 && i !== j);
  const apply = (d) => {
    const s = d.singularities[j];
    if (sum) setIndex(surface, s, sum, d.n);
    if (sum && own) center(surface, mirror, s, d.n);
    const other = sum && image >= 0 && !own ? mirror.singularity(s, d.n) : null;
    if (other) d.singularities[image] = other;
    const left = new Set(gone.concat(sum ? [] : [j, own ? -1 : image]));
    d.singularities = d.singularities.filter((_, i) => !left.has(i));
    return d.singularities.indexOf(s);
  };
  const kind = sum ? kindFor(sum, design.n, list[j].kind) : '';
  return { index: sum, kind, refused: sum !== 0 && !holdable(sum), both: image >= 0 && !own, apply };
}

/** Puts a control onto the plane of the mirror, with a pattern that is its own image. */
function center(surface, mirror, s, n) {
  const hit = surface.nearest(spotOf(surface, s).map((x, c) => (c === mirror.axis ? 0 : x)));
  const before = direction(surface, s.face, s.angle || 0, s.relative_to);
  Object.assign(s, { face: hit.face, ...(s.pin ? { pin: inside(hit.barycentric) } : {}) });
  delete s.relative_to;
  if (swirls(s, n)) {
    const half = 180 / n;
    s.angle = Math.round((s.angle || 0) / half) * half;
    return;
  }
  // A branch lies in the plane: of both ways along it the one that a branch is nearer to.
  const period = 360 / Math.abs(n - indexOf(s)), old = angleIn(surface, hit.face, before);
  const off = (a) => Math.abs(a - old - period * Math.round((a - old) / period));
  const along = cross(frame(surface, hit.face).normal, mirror.normal());
  const [a, b] = [along, scaled(along, -1)].map((d) => angleIn(surface, hit.face, d));
  s.angle = off(b) < off(a) ? b : a;
}

/**
 * The controls that a singularity of several zeros becomes, with so many zeros each, around its place: from afar the field
 * stays what it was. {parts, images: of them in the mirror}; null where the surface has no room for them.
 */
export function splitting(surface, mirror, design, k, counts, diagonal) {
  const list = design.singularities, s = list[k], { n } = design, twin = mirror.twin(design, k), center = spotOf(surface, s);
  const number = counts.length, sides = mirror.axis >= 0 && twin < 0 && mirror.holds(center);
  const [a, b, c] = surface.corners(s.face), area = Math.hypot(...cross(subtract(b, a), subtract(c, a))) / 2;
  const gap = Math.max(8 * Math.sqrt(area), 0.05 * diagonal), radius = gap / (2 * Math.sin(Math.PI / number));
  const others = list.filter((_, i) => i !== k && i !== twin);
  for (const strict of [true, false]) {
    for (const size of [1, 1.25, 0.8, 1.6, 0.64, 2, 0.5]) {
      for (const turn of turnsOf(surface, mirror, s, counts, sides)) {
        const parts = ring(surface, s, counts, n, size * radius, turn);
        if (parts && sides) mirrorParts(mirror, parts, n, gap);
        const images = parts && twin >= 0 ? parts.map((p) => mirror.singularity(p, n)) : [];
        const fit = parts && images.every(Boolean) && fits(surface, [...parts, ...images], others, size * gap, strict);
        if (fit) return { parts, images, twin };
      }
    }
  }
  return null;
}

/** Where the first part may lie, seen from the middle: where branches are, or so that the mirror has the ring as its own image. */
function turnsOf(surface, mirror, s, counts, sides) {
  const { x, y } = frame(surface, s.face), number = counts.length;
  const start = sides ? Math.atan2(dot(mirror.normal(), y), dot(mirror.normal(), x)) : angleOf(surface, s);
  if (!sides) return [0, 0.5, 0.25, 0.75].map((part) => start + (part * 2 * Math.PI) / number);
  const even = number % 2 === 0 && counts.every((c) => c === counts[0]);
  return even ? [start, start + Math.PI / number] : [start + Math.PI / 2, start - Math.PI / 2];
}

/** Parts at equal angles around the place of a control; null where the surface bends away from them. */
function ring(surface, s, counts, n, radius, turn) {
  const { x, y, normal } = frame(surface, s.face), center = spotOf(surface, s), sign = isNegative(s.kind) ? -1 : 1;
  const at = counts.map((_, j) => turn + (2 * Math.PI * j) / counts.length);
  const z = at.map((angle) => [radius * Math.cos(angle), radius * Math.sin(angle)]);
  // u = c (z - z_1)^k_1 (z - z_2)^k_2 ..., or its conjugate: from afar c z^k. A branch at angle a has arg u = n a.
  const whole = (swirls(s, n) ? n : n - indexOf(s)) * angleOf(surface, s), parts = [];
  for (let j = 0; j < counts.length; ++j) {
    const hit = surface.nearest(plus(center, plus(scaled(x, z[j][0]), scaled(y, z[j][1])))), there = Math.hypot(...subtract(hit.point, center));
    if (there < 0.5 * radius || there > 1.5 * radius || dot(frame(surface, hit.face).normal, normal) < 0.2) return null;
    const { name, count, relative_to, ...rest } = s;
    const part = { ...(name && !j ? { name } : {}), ...rest, face: hit.face };
    setIndex(surface, part, sign * counts[j], n);
    if (s.pin) part.pin = inside(hit.barycentric);
    let phase = whole;
    z.forEach((w, l) => { if (l !== j) phase += sign * counts[l] * Math.atan2(z[j][1] - w[1], z[j][0] - w[0]); });
    part.angle = positiveDegrees(swirls(part, n) ? (phase * 180) / (Math.PI * n) : carried(surface, part.face, x, y, phase / (n - indexOf(part))));
    parts.push(part);
  }
  return parts;
}

/** A direction of the plane x, y as an angle of another face, in degrees. */
function carried(surface, face, x, y, angle) {
  return angleIn(surface, face, plus(scaled(x, Math.cos(angle)), scaled(y, Math.sin(angle))));
}

/** Those on one side of the mirror become the images of those on the other. */
function mirrorParts(mirror, parts, n, gap) {
  const spot = (p) => spotOf(mirror.surface, p);
  parts.forEach((p, j) => {
    if (spot(p)[mirror.axis] < 0.2 * gap) return;
    const image = mirror.singularity(p, n), there = mirror.reflected(spot(p));
    const far = (q) => Math.hypot(...subtract(spot(q), there));
    const twin = parts.reduce((best, q, i) => (i !== j && (best < 0 || far(q) < far(parts[best])) ? i : best), -1);
    if (image && twin >= 0) parts[twin] = { ...image, ...(parts[twin].name ? { name: parts[twin].name } : {}) };
  });
}

/** Whether controls have room: a gap between them, and no vertex that two faces share; without `strict` no face is two's. */
function fits(surface, parts, others, gap, strict) {
  const taken = new Set(others.flatMap((s) => keysOf(surface, s, strict))), spots = parts.map((p) => spotOf(surface, p));
  return parts.every((p, j) => {
    const keys = keysOf(surface, p, strict), free = keys.every((key) => !taken.has(key));
    for (const key of keys) taken.add(key);
    return free && spots.slice(0, j).every((q) => Math.hypot(...subtract(q, spots[j])) > (strict ? 0.6 : 0.2) * gap);
  });
}

function keysOf(surface, s, strict) {
  return strict ? [0, 1, 2].map((c) => surface.faces[3 * s.face + c]) : [s.face];
}
