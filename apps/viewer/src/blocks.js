// SPDX-License-Identifier: MIT
//
// blocks.js: the faces of a surface in groups of neighbours with a box around each, so that a ray or a point looks at
// few faces; and a coarse copy of a large surface, to be drawn while it turns.

const size = 128;  // faces in a block
const few = 4096;  // faces that need no order

/** {order: numbers of faces, boxes: low and high corner of every `size` of them}. */
export function makeBlocks(P, F) {
  const count = F.length / 3, order = new Uint32Array(count);
  for (let t = 0; t < count; ++t) order[t] = t;
  const number = Math.ceil(count / size), boxes = new Float32Array(6 * number);
  const sorted = count > few ? sortAlongCurve(P, F, order) : order;
  for (let b = 0; b < number; ++b) {
    const box = boxes.subarray(6 * b, 6 * b + 6);
    box.fill(Infinity, 0, 3).fill(-Infinity, 3);
    for (let i = size * b; i < Math.min(size * (b + 1), count); ++i) {
      for (let c = 0; c < 3; ++c) {
        const v = 3 * F[3 * sorted[i] + c];
        for (let d = 0; d < 3; ++d) {
          if (P[v + d] < box[d]) box[d] = P[v + d];
          if (P[v + d] > box[3 + d]) box[3 + d] = P[v + d];
        }
      }
    }
  }
  return { order: sorted, boxes };
}

/** Numbers of the faces in the blocks that accept(box) holds for, one call of visit(face) each. */
export function visitBlocks({ order, boxes }, accept, visit) {
  for (let b = 0, k = 0; k < boxes.length; ++b, k += 6) {
    if (!accept(boxes, k)) continue;
    for (let i = size * b; i < Math.min(size * (b + 1), order.length); ++i) visit(order[i]);
  }
}

/** The faces in the order of their first corners along Morton's curve. */
function sortAlongCurve(P, F, order) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let v = 0; v < P.length; ++v) {
    const c = v % 3;
    if (P[v] < low[c]) low[c] = P[v];
    if (P[v] > high[c]) high[c] = P[v];
  }
  const scale = low.map((l, c) => 1023 / (high[c] - l || 1)), keys = new Uint32Array(order.length);
  const spread = (x) => {
    x = (x | (x << 16)) & 0x030000ff;
    x = (x | (x << 8)) & 0x0300f00f;
    x = (x | (x << 4)) & 0x030c30c3;
    return (x | (x << 2)) & 0x09249249;
  };
  for (let t = 0; t < order.length; ++t) {
    const v = 3 * F[3 * t];
    keys[t] = spread((P[v] - low[0]) * scale[0]) | (spread((P[v + 1] - low[1]) * scale[1]) << 1) | (spread((P[v + 2] - low[2]) * scale[2]) << 2);
  }
  let from = order, to = new Uint32Array(order.length);
  for (const shift of [0, 15]) {  // two passes of a radix sort
    const starts = new Uint32Array(32769);
    for (let i = 0; i < from.length; ++i) ++starts[((keys[from[i]] >>> shift) & 32767) + 1];
    for (let d = 1; d < starts.length; ++d) starts[d] += starts[d - 1];
    for (let i = 0; i < from.length; ++i) to[starts[(keys[from[i]] >>> shift) & 32767]++] = from[i];
    [from, to] = [to, from];
  }
  return from;
}

/** The surface with vertices that share a cell of a grid made one: {positions, normals: of three corners per face, faces: the number of the original of each}. */
export function coarsen(P, N, F, cell) {
  const table = new Map(), home = new Uint32Array(P.length / 3), sums = [];
  const key = (v) => (Math.floor(P[v] / cell) + 4096) * 67108864 + (Math.floor(P[v + 1] / cell) + 4096) * 8192 + Math.floor(P[v + 2] / cell) + 4096;
  for (let v = 0; v < home.length; ++v) {
    const k = key(3 * v);
    let at = table.get(k);
    if (at === undefined) {
      table.set(k, (at = sums.length / 7));
      sums.push(0, 0, 0, 0, 0, 0, 0);
    }
    home[v] = at;
    for (let c = 0; c < 3; ++c) {
      sums[7 * at + c] += P[3 * v + c];
      sums[7 * at + 3 + c] += N[3 * v + c];
    }
    ++sums[7 * at + 6];
  }
  const kept = [];
  for (let t = 0; 3 * t < F.length; ++t) {
    const [a, b, c] = [home[F[3 * t]], home[F[3 * t + 1]], home[F[3 * t + 2]]];
    if (a !== b && b !== c && c !== a) kept.push(t);
  }
  const positions = new Float32Array(9 * kept.length), normals = new Int16Array(9 * kept.length);
  kept.forEach((t, k) => {
    for (let j = 0; j < 3; ++j) {
      const s = 7 * home[F[3 * t + j]], length = Math.hypot(sums[s + 3], sums[s + 4], sums[s + 5]) || 1;
      for (let c = 0; c < 3; ++c) {
        positions[9 * k + 3 * j + c] = sums[s + c] / sums[s + 6];
        normals[9 * k + 3 * j + c] = (32767 * sums[s + 3 + c]) / length;
      }
    }
  });
  return { positions, normals, faces: Uint32Array.from(kept) };
}
