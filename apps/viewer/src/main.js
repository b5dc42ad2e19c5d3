// SPDX-License-Identifier: MIT
//
// main.js: starts the page: a finished result that came with it, or the studio.
import { decodeBase64, unpack } from './pack.js';
import { Stage } from './stage.js';
import { startStudio } from './studio.js';
import { startView } from './view.js';

const veil = document.getElementById('veil');

export function say(text, failed = false) {
  veil.hidden = text === '';
  veil.classList.toggle('failed', failed);
  document.getElementById('veil-text').textContent = text;
}

function makeStage() {
  try {
    return new Stage(document.getElementById('canvas'));
  } catch {
    throw new Error('This page needs WebGL 2, which this browser does not offer. Try another browser, or turn on hardware acceleration.');
  }
}

async function start() {
  const boot = JSON.parse(document.getElementById('boot').textContent);
  // One frame first, so that the page says what it does.
  await new Promise((next) => requestAnimationFrame(() => setTimeout(next)));
  const ui = document.getElementById('ui');
  const element = document.getElementById('data');
  const scene = boot.mode === 'view' && unpack(decodeBase64(element.textContent.trim()));
  element.remove();
  const stage = makeStage();
  // Under a name, for whoever looks at the page from its console.
  window.alcap = scene ? { stage, view: startView(stage, ui, scene) } : await startStudio(stage, ui, boot);
  say('');
  document.documentElement.dataset.ready = boot.mode;
}

start().catch((error) => {
  console.error(error);
  say(error.message || 'Something went wrong.', true);
});
