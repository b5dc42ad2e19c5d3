// SPDX-License-Identifier: MIT
//
// dom.js: elements in one call, and numbers as people read them.

/** h('button', {class: 'x', onclick: f}, 'text', child): properties starting with "on" are listeners. */
export function h(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(properties)) {
    if (key.startsWith('on')) element.addEventListener(key.slice(2), value);
    else if (value === true) element.setAttribute(key, '');
    else if (value !== false && value !== null && value !== undefined) element.setAttribute(key, value);
  }
  element.append(...children.flat().filter((c) => c !== null && c !== undefined));
  return element;
}

const exact = new Intl.NumberFormat('en-US');

export function count(value) {
  return exact.format(value);
}

/** Three digits, without needless zeros. */
export function short(value) {
  if (!Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  const text = size >= 1e4 || size < 1e-2 ? value.toExponential(2) : value.toPrecision(3);
  return text.replace(/\.?0+(e|$)/, '$1').replace('e+', 'e').replace('-', '−').replace('e-', 'e−');
}

const rounded = new Intl.NumberFormat('en-US', { maximumSignificantDigits: 3, useGrouping: false });

/** Three digits without an exponent, for numbers that people set. */
export function plain(value) {
  return rounded.format(value);
}

/** An index in n-ths: +1/4. */
export function fraction(index, n) {
  const sign = index > 0 ? '+' : index < 0 ? '−' : '';
  const size = Math.abs(index);
  return size % n === 0 ? `${sign}${size / n}` : `${sign}${size}/${n}`;
}

export function fieldName(n) {
  return { 1: 'Vector field', 2: 'Line field', 3: 'Triple field', 4: 'Cross field', 6: 'Hexagonal field' }[n] || `${n}-fold field`;
}

/** A row of buttons of which one is pressed; offer(options) makes it one of other options, where those that stay are the buttons that they were. */
export function segmented(label, options, value, choose) {
  const row = h('div', { class: 'segmented', role: 'radiogroup', 'aria-label': label });
  let now = value;
  const set = (next) => {
    now = next;
    for (const b of row.children) b.setAttribute('aria-checked', String(b.dataset.value === String(next)));
  };
  const button = ([key, text, help]) => h('button', { type: 'button', role: 'radio', 'data-value': key, title: help, onclick: (event) => {
    set(key);
    row.keys = event.detail === 0;  // chosen by the keyboard
    choose(key);
  } }, text);
  row.offer = (list) => {
    const old = new Map([...row.children].map((b) => [b.dataset.value, b]));
    arrange(row, list.map((option) => old.get(String(option[0])) || button(option)));
    set(now);
  };
  row.addEventListener('keydown', (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    const all = [...row.children];
    const next = all[(all.indexOf(document.activeElement) + step + all.length) % all.length];
    next.focus();
    next.click();
    event.preventDefault();
    event.stopPropagation();
  });
  row.offer(options);
  row.set = set;
  return row;
}

export function toggle(label, value, change, key) {
  const box = h('input', { type: 'checkbox', onchange: () => change(box.checked) });
  box.checked = value;
  const row = h('label', { class: 'toggle' }, h('span', {}, label), key ? h('kbd', {}, key) : null, box, h('i', { 'aria-hidden': 'true' }));
  row.set = (next) => { box.checked = next; };
  row.flip = () => { box.checked = !box.checked; change(box.checked); };
  return row;
}

/** Makes these the children of an element. Those that stay are not touched, so that a field one types into keeps the keyboard and what was typed. */
export function arrange(element, ...children) {
  const next = children.flat().filter((c) => c !== null && c !== undefined), kept = new Set(next);
  for (const child of [...element.childNodes]) if (!kept.has(child)) child.remove();
  next.forEach((child, k) => { if (element.childNodes[k] !== child) element.insertBefore(child, element.childNodes[k] || null); });
}

/** What stands for each control of a list (an object, whose `text` is for this alone): what stood for the same one before, wherever in the list; for one that was edited, what stood in its place; or a new one. */
export function matched(items, controls, make) {
  const texts = controls.map((c) => JSON.stringify(c)), left = new Map();
  items.forEach((item, k) => {
    if (item.text === texts[k]) return;
    if (!left.has(item.text)) left.set(item.text, []);
    left.get(item.text).push(item);
  });
  const found = texts.map((text, k) => (items[k]?.text === text ? items[k] : left.get(text)?.shift())), taken = new Set(found);
  return found.map((item, k) => Object.assign(item || (items[k] && !taken.has(items[k]) ? items[k] : make()), { text: texts[k] }));
}

/** A part of a panel with a heading. */
export function section(title, ...children) {
  return h('section', {}, title ? h('h2', {}, title) : null, ...children);
}
