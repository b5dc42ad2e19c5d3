// SPDX-License-Identifier: MIT
//
// number_input.js: a number that is set by typing.
import { h } from './dom.js';

/**
 * A field for a number. What is typed stays until it is taken, by Enter or by leaving the field, whatever `set` says in the
 * meantime; `set` is for every refresh. Text that is not a number changes nothing and gives way to the number of before.
 * An empty field is not a number either, except where the number is `optional`: change(null).
 */
export function numberInput(label, { step = 'any', optional = false }, change) {
  let shown = '', held = false;
  const hold = () => { held = true; };
  const take = () => {
    const empty = input.value === '' && !input.validity.badInput, value = empty ? null : input.valueAsNumber;
    held = false;
    if (empty ? !optional : !Number.isFinite(value)) {
      input.value = shown;
    } else {
      shown = input.value;
      change(value);
    }
  };
  const leave = () => {
    held = false;
    input.value = shown;
  };
  const input = h('input', { type: 'number', class: 'turns', step: String(step), 'aria-label': label, onfocus: hold, oninput: hold, onchange: take, onblur: leave });
  input.set = (value) => {
    shown = value === undefined ? '' : String(value);
    if (!held) input.value = shown;
  };
  return input;
}
