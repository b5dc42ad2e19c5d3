// SPDX-License-Identifier: MIT
//
// pack.js: bytes of apps/alcap/page/view_pack.h as typed arrays.

const types = { f32: Float32Array, u32: Uint32Array, i16: Int16Array, bf16: Uint16Array };

/** base64 text to an ArrayBuffer. */
export function decodeBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text).buffer;
  const padding = text.endsWith('==') ? 2 : text.endsWith('=') ? 1 : 0;
  const bytes = new Uint8Array((text.length / 4) * 3 - padding);
  const step = 1 << 20;  // a multiple of 4: pieces that atob turns into short strings
  for (let from = 0, to = 0; from < text.length; from += step) {
    const piece = atob(text.slice(from, from + step));
    for (let k = 0; k < piece.length; ++k) bytes[to++] = piece.charCodeAt(k);
  }
  return bytes.buffer;
}

/** {meta, arrays: {name: typed array}}. Views into the buffer, except bf16, which become Float32Arrays. */
export function unpack(buffer) {
  const bytes = new Uint8Array(buffer);
  const text = new TextDecoder();
  if (text.decode(bytes.subarray(0, 8)) !== 'ALCAPPK1') throw new Error('These are not the data of this page.');
  const size = new DataView(buffer).getUint32(8, true);
  const header = JSON.parse(text.decode(bytes.subarray(16, 16 + size)));
  const arrays = {};
  for (const { name, type, offset, length } of header.arrays) {
    const view = new types[type](buffer, 16 + size + offset, length);
    arrays[name] = type === 'bf16' ? widen(view) : view;
  }
  return { meta: header.meta, arrays };
}

function widen(halves) {
  const bits = new Uint32Array(halves.length);
  for (let k = 0; k < halves.length; ++k) bits[k] = halves[k] << 16;
  return new Float32Array(bits.buffer);
}
