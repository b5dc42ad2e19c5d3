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
  ui.append(panel, card, help, toolbar(stage, help, scene.meta.title));
  stage.resize();
  stage.frame(scene.meta.diagonal);
  onClick(stage.canvas, (event) => card.show(view.pick(event)));
  listen(stage, { ...display.keys, ...color.keys, '?': () => help.showModal(), p: () => savePicture(stage, scene.meta.title), Escape: () => card.show(null) });
  return view;
}

export function toolbar(stage, help, title) {
  return h('nav', { class: 'tools', 'aria-label': 'View' },
    h('button', { type: 'button', title: 'Everything into view (F)', onclick: () => stage.frame(stage.diagonal) }, 'Fit'),
    h('button', { type: 'button', title: 'Save a picture (P)', onclick: () => savePicture(stage, title) }, 'Picture'),
    h('button', { type: 'button', title: 'Keys (?)', onclick: () => help.showModal() }, 'Keys'));
}

export function savePicture(stage, title) {
  stage.renderer.render(stage.scene, stage.camera);
  stage.canvas.toBlob((blob) => download(blob, `${title}.png`), 'image/png');
}

export function download(blob, name) {
  const link = h('a', { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
