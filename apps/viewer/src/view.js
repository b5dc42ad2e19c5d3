// SPDX-License-Identifier: MIT
//
// view.js: the page of one finished result.
import { h } from './dom.js';
import { listen, onClick, viewKeys } from './keys.js';
import { colorSection, displaySection, figuresSection, makeCard, makeHeader, makeHelp, makePanel, singularitySection } from './panel.js';
import { View } from './scene.js';

const least = 16;  // pixels: pictures are no narrower

export function startView(stage, ui, scene) {
  const view = new View(stage, scene);
  const help = makeHelp(viewKeys);
  const card = makeCard(view);
  const display = displaySection(view), color = colorSection(view);
  const panel = makePanel(makeHeader(scene.meta), display, color, singularitySection(view), figuresSection(view));
  const pictures = makePictures(stage, scene.meta.title);
  ui.append(panel, card, help, pictures, toolbar(stage, help, pictures));
  stage.resize();
  stage.frame(scene.meta.diagonal);
  onClick(stage.canvas, (event) => card.show(view.pick(event)));
  listen(stage, { ...display.keys, ...color.keys, '?': () => help.showModal(), p: () => pictures.choose(), Escape: () => card.show(null) });
  return view;
}

export function toolbar(stage, help, pictures) {
  return h('nav', { class: 'tools', 'aria-label': 'View' },
    h('button', { type: 'button', title: 'Fit to view (F)', onclick: () => stage.frame(stage.diagonal) }, 'Fit'),
    h('button', { type: 'button', title: 'Save a picture (P)', onclick: () => pictures.choose() }, 'Picture'),
    h('button', { type: 'button', title: 'Keys (?)', onclick: () => help.showModal() }, 'Keys'));
}

/** A dialog that saves what is on screen, in one of several sizes or as wide as one says. */
export function makePictures(stage, title) {
  const list = h('ul', {}), note = h('p', { class: 'quiet', role: 'status' });
  const width = h('input', { type: 'number', class: 'turns', step: '1', 'aria-label': 'Width in pixels', oninput: () => say() });
  const save = h('button', { type: 'button', class: 'plain', onclick: () => take(Number(width.value)) }, 'Save');
  const take = async (x) => {
    dialog.close();
    download(await stage.picture(x), `${title}.png`);
  };
  const say = () => {
    const x = Number(width.value), fits = Number.isInteger(x) && x >= least && x <= stage.widest;
    save.disabled = !fits;
    note.textContent = fits ? `${x} × ${stage.pictureSize(x).size[1]} pixels` : `Choose from ${least} to ${stage.widest} pixels; this machine cannot draw wider pictures.`;
  };
  const own = h('div', { class: 'row own' }, h('label', {}, 'Width ', width), save);
  const dialog = h('dialog', { class: 'exports', 'aria-label': 'Picture' }, h('h2', {}, 'Save a picture of'), list, own, note,
    h('form', { method: 'dialog' }, h('button', { class: 'plain' }, 'Close')));
  dialog.addEventListener('click', (event) => { if (event.target === dialog) dialog.close(); });
  dialog.choose = () => {
    const sizes = [1, 2, 4].map((scale) => Math.floor(stage.width * stage.ratio * scale)).filter((x) => x <= stage.widest);
    list.replaceChildren(...sizes.map((x) => h('li', {}, h('button', { type: 'button', class: 'item', onclick: () => take(x) }, stage.pictureSize(x).size.join(' × ') + ' pixels'))));
    Object.assign(width, { min: least, max: stage.widest, value: Math.min(3000, stage.widest) });
    say();
    dialog.showModal();
  };
  return dialog;
}

export function download(blob, name) {
  const link = h('a', { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
