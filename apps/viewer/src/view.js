// SPDX-License-Identifier: MIT
//
// view.js: the page of one finished result.
import { h } from './dom.js';
import { listen, onClick, viewKeys } from './keys.js';
import { colorSection, displaySection, figuresSection, makeCard, makeHeader, makeHelp, makePanel, singularitySection } from './panel.js';
import { View } from './scene.js';

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
    h('button', { type: 'button', title: 'Everything into view (F)', onclick: () => stage.frame(stage.diagonal) }, 'Fit'),
    h('button', { type: 'button', title: 'Save a picture (P)', onclick: () => pictures.choose() }, 'Picture'),
    h('button', { type: 'button', title: 'Keys (?)', onclick: () => help.showModal() }, 'Keys'));
}

/** A dialog that saves what is on screen, in one of several sizes. */
export function makePictures(stage, title) {
  const list = h('ul', {});
  const dialog = h('dialog', { class: 'exports', 'aria-label': 'Picture' }, h('h2', {}, 'Save a picture of'), list,
    h('form', { method: 'dialog' }, h('button', { class: 'plain' }, 'Close')));
  dialog.addEventListener('click', (event) => { if (event.target === dialog) dialog.close(); });
  dialog.choose = () => {
    list.replaceChildren(...[1, 2, 4].map((scale) => {
      const [x, y] = [stage.width, stage.height].map((size) => Math.floor(size * stage.ratio * scale));
      return h('li', {}, h('button', { type: 'button', class: 'item', onclick: async () => {
        dialog.close();
        download(await stage.picture(scale), `${title}.png`);
      } }, `${x} × ${y} pixels`));
    }));
    dialog.showModal();
  };
  return dialog;
}

export function download(blob, name) {
  const link = h('a', { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
