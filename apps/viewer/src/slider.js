// SPDX-License-Identifier: MIT
//
// slider.js: a number that is set by dragging or by the arrow keys.
import { h, plain } from './dom.js';

/** A number between two ends, on a scale of powers unless it is even; `rest` when it is let go. */
export function slider(label, { least, most, value, even, unit = '', steps = unit ? most - least : 200 }, change, rest) {
  const to = (v) => (even ? v : Math.log10(v)), from = (x) => (even ? Number(x) : Number((10 ** x).toPrecision(3)));
  const shown = h('output', {});
  const name = () => `slider-${Date.now()}`;
  let gesture = name(), held = false;
  const input = h('input', { type: 'range', min: to(least), max: to(most), step: (to(most) - to(least)) / steps, 'aria-label': label, oninput: () => {
    const v = from(input.value);
    held = true;
    shown.textContent = plain(v) + unit;
    change(v, gesture);
  }, onchange: () => {
    gesture = name();
    held = false;
    rest?.();
  } });
  const row = h('label', { class: 'slider' }, h('span', {}, label), input, shown);
  row.set = (v) => {
    if (held) return;  // under the hand
    input.value = to(v);
    shown.textContent = plain(v) + unit;
  };
  row.set(value);
  return row;
}
