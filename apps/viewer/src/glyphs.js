// SPDX-License-Identifier: MIT
//
// glyphs.js: the branches of the field at vertices that are spread evenly: wedges for vectors, strokes for the rest.
import { Lines } from './lines.js';

export class Glyphs {
  constructor(surface, diagonal, spacing) {
    this.surface = surface;
    this.spacing = spacing;
    this.sets = {
      false: new Lines({ variable: '--ink', width: 0.14 * spacing, widths: [1, 4], order: 2 }),
      true: new Lines({ variable: '--ink', width: 0.22 * spacing, widths: [1.4, 7], taper: true, order: 2 }),
    };
    this.shown = false;
  }

  attach(stage) {
    for (const s of Object.values(this.sets)) stage.add(s);
    this.apply();
  }

  set(n, branch, length) {
    this.n = n;
    this.branch = branch;
    this.length = length;
    this.stale = true;
    if (this.shown) this.build();
  }

  show(visible) {
    this.shown = visible;
    if (visible && this.stale) this.build();
    this.apply();
  }

  apply() {
    for (const [taper, lines] of Object.entries(this.sets)) lines.show(this.shown && taper === String(this.n === 1));
  }

  build() {
    this.stale = false;
    this.vertices ??= spread(this.surface.positions, 0.85 * this.spacing);
    const { positions: P, normals: N } = this.surface;
    const { n, branch, length } = this;
    const typical = quantile(length, 0.8) || 1;
    const lone = n % 2 === 1, strokes = lone ? n : n / 2;
    const data = new Float32Array(8 * strokes * this.vertices.length);
    let to = 0;
    for (const v of this.vertices) {
      const size = Math.min(length[v] / typical, 1);
      if (!(size > 0)) continue;
      const reach = this.spacing * (lone ? 1 : 0.4) * (0.3 + 0.7 * size);
      const d = [0, 1, 2].map((c) => branch[3 * v + c] / 32767), m = [0, 1, 2].map((c) => N[3 * v + c] / 32767);
      const e = [m[1] * d[2] - m[2] * d[1], m[2] * d[0] - m[0] * d[2], m[0] * d[1] - m[1] * d[0]];
      for (let k = 0; k < strokes; ++k, to += 8) {
        const cos = Math.cos((2 * Math.PI * k) / n), sin = Math.sin((2 * Math.PI * k) / n);
        for (let c = 0; c < 3; ++c) {
          const x = (cos * d[c] + sin * e[c]) * reach;
          data[to + c] = P[3 * v + c] - (lone ? (n === 1 ? 0.5 * x : 0) : x);
          data[to + 3 + c] = P[3 * v + c] + (n === 1 ? 0.5 * x : x);
        }
      }
    }
    this.sets[n === 1].segments(data.subarray(0, to));
    this.apply();
  }
}

/** Vertices no two of which are closer than the distance, greedily. */
function spread(P, distance) {
  const cells = new Map(), found = [];
  const key = (x, y, z) => (x + 2048) * 16777216 + (y + 2048) * 4096 + (z + 2048);
  for (let v = 0; v < P.length / 3; ++v) {
    const [x, y, z] = [P[3 * v], P[3 * v + 1], P[3 * v + 2]];
    const [i, j, k] = [x, y, z].map((c) => Math.floor(c / distance));
    // The own cell first: it nearly always says no.
    let free = !(cells.get(key(i, j, k)) || []).some((w) => Math.hypot(P[3 * w] - x, P[3 * w + 1] - y, P[3 * w + 2] - z) < distance);
    for (let a = i - 1; free && a <= i + 1; ++a) {
      for (let b = j - 1; free && b <= j + 1; ++b) {
        for (let c = k - 1; free && c <= k + 1; ++c) {
          for (const w of cells.get(key(a, b, c)) || []) {
            if (Math.hypot(P[3 * w] - x, P[3 * w + 1] - y, P[3 * w + 2] - z) < distance) { free = false; break; }
          }
        }
      }
    }
    if (!free) continue;
    found.push(v);
    const home = key(i, j, k);
    if (cells.has(home)) cells.get(home).push(v);
    else cells.set(home, [v]);
  }
  return found;
}

function quantile(values, fraction) {
  const step = Math.max(1, Math.floor(values.length / 5000)), some = [];
  for (let k = 0; k < values.length; k += step) some.push(values[k]);
  some.sort((a, b) => a - b);
  return some[Math.floor(fraction * (some.length - 1))];
}
