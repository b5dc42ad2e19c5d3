// SPDX-License-Identifier: MIT
//
// studio_times.mjs: how long a hand waits for the studio, by the wall clock and in this browser, against the targets of
// docs/studio.md. `run.sh ALCAP WORK --times` runs it; SHAPES names other meshes than the two of the targets.
import { cpus, loadavg } from 'node:os';
import { join } from 'node:path';

import { alcap, folder, Hand, launch, open, studio } from './browser.mjs';

const targets = { glyphs: 33, curves: 300, opened: 5000 };  // ms
const shapes = (process.env.SHAPES || 'icosphere:6 icosphere:8').split(' ');

const median = (list) => [...list].sort((a, b) => a - b)[Math.floor(list.length / 2)];
const milliseconds = (x) => `${Math.round(x)} ms`;

/** Notes for every field how much longer than the solve it took until its glyphs were drawn. */
const watch = (page) => page.evaluate(() => {
  window.glyphs = [];
  const { time } = alcap;
  alcap.time = function (pack) {
    const { since } = this.store;
    time.call(this, pack);
    this.stage.drawn().then((now) => window.glyphs.push(now - since - 1000 * pack.meta.seconds));
  };
});

async function measure(browser, shape) {
  const mesh = join(folder(), 'mesh.ply');
  alcap('make', shape, '-o', mesh, '-q');
  const server = await studio(mesh);
  try {
    const page = await open(browser, server.url);
    page.setDefaultTimeout(600000);
    const hand = new Hand(page, server);
    await hand.settled();
    const faces = await page.evaluate(() => alcap.view.arrays.faces.length / 3);
    const opened = Number(await page.evaluate(() => document.documentElement.dataset.opened));
    await hand.drop('source', 40, 30);
    await watch(page);
    const box = await page.locator('.ring.chosen').boundingBox(), [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await hand.editing(() => hand.drag([x, y], [x - 60, y - 40], [x - 100, y + 20]));
    await page.evaluate(() => alcap.stage.drawn());
    const { glyphs, curves, renderer } = await page.evaluate(() => {
      const gl = alcap.stage.renderer.getContext(), names = gl.getExtension('WEBGL_debug_renderer_info');
      return { glyphs: window.glyphs, curves: alcap.times.curves, renderer: names ? gl.getParameter(names.UNMASKED_RENDERER_WEBGL) : '' };
    });
    await page.context().close();
    return { shape, faces, opened, glyphs, curves, renderer };
  } finally {
    await server.kill();
  }
}

const [load] = loadavg(), cores = cpus();
console.log(`${cores.length} × ${cores[0].model}, load ${load.toFixed(1)} before${load > 0.5 ? ': UNDER LOAD, these times are too long' : ''}`);
const browser = await launch();
try {
  for (const shape of shapes) {
    const m = await measure(browser, shape);
    console.log(`\n${m.shape}: ${m.faces.toLocaleString('en-US')} triangles, ${m.renderer}`);
    console.log(`  on screen after             ${milliseconds(m.opened)} (target at 1.3 million: ${targets.opened})`);
    console.log(`  drag: glyphs after solve    median ${milliseconds(median(m.glyphs))}, worst of ${m.glyphs.length} ${milliseconds(Math.max(...m.glyphs))} (target: ${targets.glyphs})`);
    console.log(`  curves after the last edit  ${milliseconds(m.curves)} (target at 100,000: ${targets.curves})`);
  }
} finally {
  await browser.close();
}
