// SPDX-License-Identifier: MIT
//
// hands.test.mjs: the studio without a mouse: by the keyboard alone, by fingers on a phone, without motion.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { alcap, folder, Hand, launch, patience, studio } from './browser.mjs';

let browser, mesh;
before(async () => {
  mesh = join(folder(), 'ball.ply');
  alcap('make', 'icosphere:3', '-o', mesh, '-q');
  browser = await launch();
});
after(async () => { await browser?.close(); });

async function on(context, act, media = {}) {
  const server = await studio(mesh, '--design', join(folder(), 'a.json'));
  try {
    const page = await (await browser.newContext(context)).newPage();
    page.setDefaultTimeout(patience);
    await page.emulateMedia(media);
    await page.goto(server.url);
    await page.waitForSelector('html[data-ready]');
    const hand = new Hand(page, server);
    await hand.settled();
    await act(page, hand);
    await page.context().close();
  } finally {
    await server.kill();
  }
}

test('the keyboard alone places, moves, turns and removes', () => on({ viewport: { width: 1000, height: 700 } }, async (page, hand) => {
  const key = (name) => hand.editing(() => page.keyboard.press(name));
  await page.keyboard.press('z');
  await page.waitForSelector('.cross', { state: 'visible' });
  assert.ok((await page.evaluate(() => alcap.view.highlighted)) >= 0);
  await page.keyboard.press('ArrowLeft');  // the view turns under the cross
  await key('Enter');
  const [placed] = hand.design().singularities;
  assert.equal(placed.kind, 'saddle');
  await page.waitForSelector('.cross', { state: 'hidden' });
  // It has the focus: arrows move it.
  assert.match(await page.evaluate(() => document.activeElement.getAttribute('aria-label')), /^saddle in face/);
  for (let k = 0; k < 4; ++k) await key('ArrowRight');
  const [moved] = hand.design().singularities;
  assert.notEqual(moved.face, placed.face);
  // The knob is the next one.
  for (let k = 0; k < 3 && !(await page.evaluate(() => document.activeElement.classList.contains('knob'))); ++k) await page.keyboard.press('Tab');
  await key('ArrowLeft');
  const turned = (hand.design().singularities[0].angle - (moved.angle || 0) + 720) % 360;
  assert.ok(Math.abs(turned - 5) < 1e-6, `${turned}`);
  await key('Delete');
  assert.deepEqual(hand.design().singularities || [], []);
  // By the toolbox: the button with the focus puts it down as well.
  await page.focus('.toolbox [data-value=source]');
  await page.keyboard.press('Enter');
  await key('Enter');
  assert.equal(hand.design().singularities[0].kind, 'source');
}));

test('the keyboard alone reaches singularities that no control asks for: card, hold', () => on({ viewport: { width: 1000, height: 700 } }, async (page, hand) => {
  const shown = () => page.isVisible('.card');
  await page.keyboard.press('v');
  await page.waitForSelector('.cross', { state: 'visible' });
  const own = (await hand.state()).arrays;
  /** Where on screen the one is, from the cross, that faces the viewer most. */
  const way = (k) => page.evaluate((wanted) => {
    const { singular: S } = alcap.view.arrays, { camera } = alcap.stage, at = alcap.ahead(), box = alcap.stage.canvas.getBoundingClientRect();
    const facing = (k) => [0, 1, 2].reduce((sum, c) => sum + S[8 * k + 3 + c] * camera.position.toArray()[c], 0);
    const k = wanted ?? Array.from({ length: S.length / 8 }, (_, j) => j).reduce((best, j) => (facing(j) > facing(best) ? j : best));
    const [x, y] = alcap.handles.project(S.slice(8 * k, 8 * k + 3));
    return [box.left + x - at.clientX, box.top + y - at.clientY, k];
  }, k);
  let [dx, dy, number] = await way();
  for (let k = 0; k < 40 && Math.hypot(dx, dy) > 30; ++k) {
    await page.keyboard.press(Math.abs(dx) > Math.abs(dy) ? (dx > 0 ? 'ArrowRight' : 'ArrowLeft') : dy > 0 ? 'ArrowDown' : 'ArrowUp');
    await page.evaluate(() => alcap.stage.drawn());
    [dx, dy] = await way(number);
  }
  await page.keyboard.press('Enter');
  assert.equal(await shown(), true);
  assert.match(await page.textContent('.card'), /No control asks/);
  assert.equal(await page.evaluate(() => document.activeElement.textContent), 'Hold it here');
  await hand.editing(() => page.keyboard.press('Enter'));
  const [held] = hand.design().singularities;
  assert.equal(held.face, own.singular_faces[number]);
  assert.equal((await hand.state()).meta.controls[0].met, true);
  assert.match(await page.evaluate(() => document.activeElement.getAttribute('aria-label')), /^source in face/);
  // At the cross it is reached again, as what it is now; Esc leaves.
  await page.focus('#canvas');
  await page.keyboard.press('v');
  await page.keyboard.press('Enter');
  assert.equal(await page.evaluate(() => alcap.selected), 0);
  await page.keyboard.press('Escape');
  await page.waitForSelector('.cross', { state: 'hidden' });
  assert.equal(await shown(), false);
}));

test('the keyboard alone draws a stroke, erases a part of it, and drops one that is not wanted', () => on({ viewport: { width: 1000, height: 700 } }, async (page, hand) => {
  const drawn = () => page.evaluate(() => alcap.strokes.drawn?.length ?? 0);
  const pressed = async (name) => {
    await page.keyboard.press(name);
    await page.evaluate(() => alcap.stage.drawn());
  };
  await pressed('b');
  await page.waitForSelector('.cross', { state: 'visible' });
  await pressed('Enter');
  for (let k = 0; k < 5; ++k) await pressed('ArrowRight');
  const before = await drawn();
  assert.ok(before > 5, `${before}`);
  await hand.editing(() => page.keyboard.press('Enter'));
  assert.equal(await drawn(), 0);
  const [stroke] = hand.design().strokes;
  assert.equal(stroke.points.length, before);
  // On the sphere it turned about the axis that points up: the stroke keeps its height, and its length is that of the turn.
  const places = await page.evaluate((points) => points.map((p) => alcap.view.surface.at(p.face, p.barycentric)), stroke.points);
  const angle = Math.acos(places[0].reduce((sum, x, c) => sum + x * places.at(-1)[c], 0) / (Math.hypot(...places[0]) * Math.hypot(...places.at(-1))));
  assert.ok(angle > 0.4 && angle < 0.65, `${angle}`);
  const steps = places.slice(1).map((p, k) => Math.hypot(...p.map((x, c) => x - places[k][c])));
  assert.ok(Math.max(...steps) < 0.1, `${Math.max(...steps)}`);
  // It is the chosen one: its beads are there, and the Delete key would take it.
  assert.equal(await page.evaluate(() => alcap.stroked), 0);
  assert.ok((await page.locator('.bead').count()) >= 2);
  // Its numbers end inside its row.
  const [row, number] = await page.evaluate(() => ['.controls li.chosen', '.numbers output'].map((what) => document.querySelector(what).getBoundingClientRect().right));
  assert.ok(number <= row - 8, `${number} of ${row}`);
  // One that is begun and dropped leaves nothing.
  await pressed('Enter');
  for (let k = 0; k < 3; ++k) await pressed('ArrowDown');
  assert.ok((await drawn()) > 1);
  await pressed('Escape');
  assert.equal(await drawn(), 0);
  assert.equal(hand.design().strokes.length, 1);
  for (let k = 0; k < 3; ++k) await pressed('ArrowUp');
  // The eraser at its end takes a part.
  await pressed('e');
  await hand.editing(() => page.keyboard.press('Enter'));
  const left = hand.design().strokes;
  assert.ok(left.length === 1 && left[0].points.length < stroke.points.length && left[0].points.length > 1, JSON.stringify(left.map((s) => s.points.length)));
  await hand.editing(() => page.keyboard.press('Control+z'));
  assert.equal(hand.design().strokes[0].points.length, before);
}));

test('on a phone the sheet covers at most half, and everything is large enough for a finger', () => on({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true }, async (page, hand) => {
  const middle = await page.evaluate(() => {
    const box = alcap.stage.canvas.getBoundingClientRect();
    return [box.left + alcap.stage.free.width / 2, box.top + alcap.stage.free.height / 2];
  });
  await page.tap('.toolbox [data-value=source]');
  await hand.editing(() => page.touchscreen.tap(...middle));
  assert.equal(hand.design().singularities.length, 1);
  /** What can be touched and takes less than 44 pixels each way around its middle. */
  const small = (within) => page.evaluate((within) => {
    const found = [];
    for (const e of document.querySelectorAll(within)) {
      e.scrollIntoView?.({ block: 'center', inline: 'center' });
      const box = e.getBoundingClientRect();
      if (!box.width || !box.height || e.disabled) continue;
      const [x, y] = [box.left + box.width / 2, box.top + box.height / 2];
      const own = (dx, dy) => {
        const hit = document.elementFromPoint(x + dx, y + dy), label = e.closest('label');
        return Boolean(hit) && (hit === e || e.contains(hit) || Boolean(label && label.contains(hit)));
      };
      if (!own(0, 0)) continue;  // under something else
      const [w, h] = [[-21, 0, 21, 0], [0, -21, 0, 21]].map(([a, b, c, d]) => own(a, b) && own(c, d));
      if (!w || !h) found.push(`${e.tagName}.${e.className} ${e.textContent || e.getAttribute('aria-label')} ${Math.round(box.width)} x ${Math.round(box.height)}`);
    }
    return found;
  }, within);
  assert.deepEqual(await small('.toolbox button, .tools button, .fold, .ring, .knob'), []);
  await page.tap('.tools [title^="Save a picture"]');
  assert.deepEqual(await small('dialog[open] button, dialog[open] input'), []);
  await page.tap('dialog[open] form .plain');
  await page.tap('.fold');
  const sheet = await page.locator('.panel').boundingBox();
  assert.ok(sheet.height <= 0.5 * 844 + 1, `${sheet.height} of 844`);
  await page.tap('.controls .name');
  assert.deepEqual(await small('.panel button, .panel summary, .panel input, .panel .toggle, .panel .slider'), []);
}));

test('without motion the view does not glide, and switches do not slide', () => on({ viewport: { width: 1000, height: 700 } }, async (page) => {
  assert.equal(await page.evaluate(() => alcap.stage.controls.enableDamping), false);
  assert.equal(await page.evaluate(() => getComputedStyle(document.querySelector('.toggle i')).transitionDuration), '0s');
  // In the dark the surface lies on a dark ground.
  assert.ok((await page.evaluate(() => alcap.stage.scene.background.r)) < 0.05);
}, { reducedMotion: 'reduce', colorScheme: 'dark' }));
