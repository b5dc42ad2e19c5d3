// SPDX-License-Identifier: MIT
//
// colors.js: perceptual colour maps as textures. The colours of things are those of style.css.
import { DataTexture, LinearFilter, SRGBColorSpace } from 'three';

/** Sequential (viridis) and diverging (vik, Crameri 2018): stops at equal distances. */
const stops = {
  sequential: ['#440154', '#482878', '#3e4a89', '#31688e', '#26828e', '#1f9e89', '#35b779', '#6dcd59', '#b4de2c', '#fde725'],
  diverging: ['#00335f', '#0d5a8c', '#4a90b5', '#98c1d6', '#e2e8ea', '#f1ece6', '#e6c3a8', '#d18e61', '#b45a23', '#7a2a08'],
};

const channel = (hex, k) => parseInt(hex.slice(1 + 2 * k, 3 + 2 * k), 16);

/** The colour at t in [0, 1]: three bytes. */
export function sample(map, t) {
  const list = stops[map];
  const x = Math.min(Math.max(t, 0), 1) * (list.length - 1);
  const k = Math.min(Math.floor(x), list.length - 2);
  return [0, 1, 2].map((c) => Math.round(channel(list[k], c) + (x - k) * (channel(list[k + 1], c) - channel(list[k], c))));
}

export function gradient(map) {
  return `linear-gradient(90deg, ${stops[map].join(', ')})`;
}

export function texture(map) {
  const bytes = new Uint8Array(256 * 4);
  for (let k = 0; k < 256; ++k) bytes.set([...sample(map, k / 255), 255], 4 * k);
  const result = new DataTexture(bytes, 256, 1);
  result.colorSpace = SRGBColorSpace;
  result.minFilter = result.magFilter = LinearFilter;
  result.needsUpdate = true;
  return result;
}
