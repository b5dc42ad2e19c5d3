// SPDX-License-Identifier: MIT
//
// merging.test.mjs: placed singularities that are put onto each other, and one of several zeros that is taken apart: by the
// mouse, by the keyboard, in a mirror. Every step by the saved design and by the singularities of the solved field.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { alcap, folder, Hand, judged, launch, open, request, studio, unpack } from './browser.mjs';

let browser, mesh;
before(async () => {
  mesh = join(folder(), 'ball.ply');
  alcap('make', 'icosphere:4', '-o', mesh, '-q');
  browser = await launch();
});
after(async () => { await browser?.close(); });

/** A studio on a ball with a page of its own, and what is asked of it. */
async function on(n, act, design = {}) {
  const server = await studio(mesh, '--design', join(folder(), 'a.json'));
  try {
    const { status } = await request(server.url, '/api/edit', {}, { method: 'POST', body: JSON.stringify({ alcap_design: 1, n, guidance: { field: 'smoothest' }, ...design }) });
    assert.equal(status, 200);
    const page = await open(browser, server.url, { viewport: { width: 800, height: 560 } }), hand = new Hand(page, server);
    await page.evaluate(() => alcap.view.set('lines', 'none'));  // nothing here is about curves
    await hand.settled();
    const { arrays: { positions: P, faces: F } } = unpack((await request(server.url, '/api/mesh')).body);
    const spot = ({ face, pin = [1 / 3, 1 / 3, 1 / 3] }) => [0, 1, 2].map((c) => pin.reduce((sum, w, j) => sum + w * P[3 * F[3 * face + j] + c], 0));
    const tools = {
      spot,
      list: () => hand.design().singularities || [],
      report: () => judged(mesh, server.design),
      /** How many zeros of the sign of a control the field has around its place, as far as those of one control are apart. */
      async zerosNear(control) {
        const { singular } = (await hand.state()).arrays, at = spot(control), sign = ['saddle', 'trisector'].includes(control.kind) ? -1 : 1;
        let number = 0;
        for (let k = 0; k < singular.length; k += 8) if (Math.hypot(...at.map((x, c) => x - singular[k + c])) < (control.count > 1 ? 0.3 : 0.13)) number += Math.max(0, sign * singular[k + 6]);
        return number;
      },
      /** The middle of a ring on the page. */
      ringAt: (k) => page.evaluate((k) => {
        const box = alcap.stage.canvas.getBoundingClientRect(), [x, y] = alcap.handles.project(alcap.handles.center(alcap.design.singularities[k]));
        return [box.left + x, box.top + y];
      }, k),
      /** Presses ring k and moves it onto ring j, or so far on the way there, without letting it go. */
      async onto(k, j, share = 1) {
        const from = await tools.ringAt(k), to = (await tools.ringAt(j)).map((x, c) => from[c] + share * (x - from[c]));
        await page.mouse.move(...from);
        await page.mouse.down();
        for (let s = 0.25; s <= 1.001; s += 0.25) await page.mouse.move(from[0] + s * (to[0] - from[0]), from[1] + s * (to[1] - from[1]));
      },
      said: () => page.textContent('.meeting-said'),
      mirrored: (axis) => page.click(`[aria-label=Mirror] [data-value="${axis}"]`),
    };
    await act(page, hand, tools);
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  } finally {
    await server.kill();
  }
}

/** How far fields differ away from a place, in degrees on average. */
function apartAwayFrom(place, mesh, before, after, n) {
  const { positions: P } = mesh;
  let sum = 0, number = 0;
  for (let v = 0; v < P.length; v += 3) {
    if (Math.hypot(...place.map((x, c) => x - P[v + c])) < 0.6) continue;
    const cosine = [0, 1, 2].reduce((s, c) => s + before[v + c] * after[v + c], 0) / (Math.hypot(...before.slice(v, v + 3)) * Math.hypot(...after.slice(v, v + 3)));
    const angle = (Math.acos(Math.min(1, Math.max(-1, cosine))) * 180) / Math.PI;
    sum += Math.abs(((angle + 180 / n) % (360 / n)) - 180 / n);
    ++number;
  }
  return sum / number;
}

test('one dropped onto another adds its index, in the place of that; the ring says so before', () => on(4, async (page, hand, { list, ringAt, onto, said, zerosNear, report }) => {
  await hand.drop('saddle', -50, 0);
  await hand.drop('saddle', 60, 20);
  const before = list();
  await onto(0, 1);
  assert.equal(await said(), 'Becomes saddle × 2, index −2/4');
  assert.match(await page.getAttribute('.ring.meeting', 'aria-label'), new RegExp(`in face ${before[1].face}$`));
  assert.equal(list().length, 2);
  // Beside it again it is one that moves.
  const [x, y] = await ringAt(1);
  await page.mouse.move(x - 40, y - 40);
  assert.equal(await said(), '');
  assert.equal(await page.locator('.ring.meeting').count(), 0);
  await page.mouse.move(x, y);
  await hand.editing(() => page.mouse.up());
  const [sum, ...more] = list();
  assert.deepEqual(more, []);
  assert.deepEqual([sum.kind, sum.count, sum.face, sum.angle], ['saddle', 2, before[1].face, before[1].angle]);
  assert.equal(await said(), '');
  assert.equal(await page.evaluate(() => alcap.selected), 0);
  assert.equal(await zerosNear(sum), 2);
  assert.equal((await hand.state()).meta.controls[0].met, true);
  assert.equal(report().controls[0].met, true);
  // The drag and what it led to are one step.
  await hand.editing(() => page.keyboard.press('Control+z'));
  assert.deepEqual(list(), before);
}));

test('two that lie close to each other are not merged by a press on one, nor by moving it away', () => on(4, async (page, hand, { list, ringAt, said }) => {
  await hand.drop('saddle', 0, 0);
  const [a] = list(), [x, y] = await ringAt(0);
  // Another one in a face some pixels away.
  const face = await page.evaluate(([x, y]) => alcap.view.pick({ clientX: x + 9, clientY: y }).face, [x, y]);
  assert.notEqual(face, a.face);
  await hand.editing(() => page.evaluate((face) => alcap.change((d) => { d.singularities.push({ face, kind: 'saddle' }); }), face));
  const [near, other] = [await ringAt(1), await ringAt(0)];  // the later one is on top
  assert.ok(Math.hypot(near[0] - other[0], near[1] - other[1]) < 14);
  const away = near[0] < other[0] ? -1 : 1;
  await hand.editing(async () => {
    await page.mouse.move(...near);
    await page.mouse.down();
    await page.mouse.move(near[0] + 6 * away, near[1]);
    await page.mouse.up();
  });
  assert.equal(list().length, 2);
  await page.locator('.ring').last().focus();
  await hand.editing(() => page.keyboard.press(away < 0 ? 'ArrowLeft' : 'ArrowRight'));
  assert.equal(await said(), '');
  assert.equal(list().length, 2);
  // From farther away it is.
  await hand.editing(() => page.keyboard.press(away < 0 ? 'ArrowLeft' : 'ArrowRight'));
  await page.keyboard.press(away < 0 ? 'ArrowRight' : 'ArrowLeft');
  for (let k = 0; k < 3 && !(await said()); ++k) {
    await hand.settled();
    await page.keyboard.press(away < 0 ? 'ArrowRight' : 'ArrowLeft');
  }
  assert.equal(await said(), 'Becomes saddle × 2, index −2/4');
}));

test('opposite ones that meet both go, and the field is the smoothest again', () => on(4, async (page, hand, { list, onto, said }) => {
  const smoothest = (await hand.state()).arrays.branch;
  await hand.drop('source', -50, 0);
  await hand.drop('saddle', 40, 20);
  assert.notDeepEqual((await hand.state()).arrays.branch, smoothest);
  await onto(1, 0);
  assert.equal(await said(), 'Both go: their indices cancel');
  await hand.editing(() => page.mouse.up());
  assert.deepEqual(list(), []);
  assert.equal(await page.locator('.ring').count(), 0);
  assert.deepEqual((await hand.state()).arrays.branch, smoothest);
  await hand.editing(() => page.keyboard.press('Control+z'));
  assert.deepEqual(list().map((s) => s.kind), ['source', 'saddle']);
}));

test('kinds are those of the symmetry; more than eight zeros are refused', () => on(2, async (page, hand, { list, onto, said, zerosNear }) => {
  await hand.drop('wedge', -70, 0);
  await hand.drop('wedge', 60, 20);
  await hand.drop('trisector', 0, -80);
  await onto(0, 1);
  await hand.editing(() => page.mouse.up());
  // Of index 1, as a source: its angle is a swirl.
  assert.deepEqual(list().map((s) => [s.kind, s.count]), [['source', 2], ['trisector', undefined]]);
  assert.equal(await zerosNear(list()[0]), 2);
  await onto(1, 0);
  assert.equal(await said(), 'Becomes wedge, index +1/2');
  await hand.editing(() => page.mouse.up());
  assert.deepEqual(list().map((s) => [s.kind, s.count]), [['wedge', undefined]]);
  assert.equal(await zerosNear(list()[0]), 1);
  // Five and four zeros.
  const { face } = list()[0];
  await hand.editing(() => page.evaluate((face) => alcap.change((d) => { d.singularities = [{ face, kind: 'saddle', count: 5 }, { face: 1000, kind: 'saddle', count: 4 }]; }), face));
  await page.evaluate(() => {
    // Both are to be seen.
    const [a, b] = alcap.design.singularities.map((s) => alcap.handles.center(s)), { camera, controls } = alcap.stage;
    camera.position.set(...a.map((x, c) => x + b[c])).normalize().multiplyScalar(5);
    controls.update();
    alcap.stage.draw();
    return alcap.stage.drawn();
  });
  const before = list();
  await onto(0, 1);
  assert.equal(await said(), 'Index −9/2 is more than 8 zeros');
  assert.equal(await page.locator('.ring.meeting.refused').count(), 1);
  await page.mouse.up();
  await hand.settled();
  assert.deepEqual(list().map((s) => [s.kind, s.count]), before.map((s) => [s.kind, s.count]));
  assert.equal(await said(), '');
}));

test('by the keyboard: arrows put one onto another, Enter merges, Esc does not, T takes it apart again', () => on(4, async (page, hand, { list, ringAt, said, zerosNear }) => {
  await hand.drop('source', -40, 0);
  await hand.drop('source', 20, 0);
  const before = list(), key = (name) => hand.editing(() => page.keyboard.press(name));
  await page.locator('.ring').nth(0).focus();
  const [goal] = [await ringAt(1)];
  for (let k = 0; k < 12 && !(await said()); ++k) {
    const [x, y] = await ringAt(0);
    const name = Math.abs(goal[1] - y) > 6 ? (goal[1] > y ? 'ArrowDown' : 'ArrowUp') : goal[0] > x ? 'ArrowRight' : 'ArrowLeft';
    await page.keyboard.press(name);
    await page.waitForFunction(() => !alcap.store.busy);
    await hand.settled();
  }
  assert.equal(await said(), 'Becomes source × 2, index +2/4');
  const beside = list();
  await page.keyboard.press('Escape');
  assert.equal(await said(), '');
  assert.deepEqual(list(), beside);
  await page.keyboard.press(goal[0] > (await ringAt(0))[0] ? 'ArrowRight' : 'ArrowLeft');
  assert.equal(await said(), 'Becomes source × 2, index +2/4');
  await key('Enter');
  const [sum] = list();
  assert.deepEqual([list().length, sum.kind, sum.count, sum.face], [1, 'source', 2, before[1].face]);
  assert.equal(await zerosNear(sum), 2);
  // It has the focus; on with it.
  assert.equal(await page.evaluate(() => document.activeElement.getAttribute('aria-label')), `source in face ${sum.face}`);
  await key('t');
  assert.deepEqual(list().map((s) => [s.kind, s.count]), [['source', undefined], ['source', undefined]]);
  for (const s of list()) assert.equal(await zerosNear(s), 1);
  assert.match(await page.evaluate(() => document.activeElement.getAttribute('aria-label')), /^source in face/);
  await key('Control+z');
  assert.deepEqual(list(), [sum]);
  await key('Control+z');
  assert.deepEqual(list(), beside);
}));

for (const [n, kind, count] of [[4, 'saddle', 4], [4, 'source', 3], [2, 'source', 2], [1, 'saddle', 2], [4, 'source', 4], [6, 'source', 5]]) {
  test(`split: ${count} zeros of a ${kind}, n = ${n}, become as many controls around its place, and the field away from them stays`, () => on(n, async (page, hand, { list, spot, zerosNear }) => {
    const { arrays: mesh } = unpack((await request(hand.server.url, '/api/mesh')).body), sign = kind === 'saddle' ? -1 : 1;
    await hand.drop(n === 2 ? 'wedge' : kind, 20, 30);
    await hand.editing(() => page.evaluate(({ kind, count }) => alcap.change((d) => Object.assign(d.singularities[0], { kind, count, angle: 25, strength: 1.2 })), { kind, count }));
    const [whole] = list(), before = (await hand.state()).arrays.branch;
    assert.equal(await zerosNear(whole), count);
    await hand.editing(() => page.click(`.numbers .actions button:text("Split into ${count}")`));
    const parts = list();
    assert.equal(parts.length, count);
    const places = parts.map(spot);
    parts.forEach((p, j) => {
      assert.deepEqual([p.kind, p.count, p.strength], [n === 2 ? 'wedge' : kind, undefined, 1.2]);
      assert.ok(Math.hypot(...places[j].map((x, c) => x - spot(whole)[c])) < 0.6);
      for (const q of places.slice(0, j)) assert.ok(Math.hypot(...q.map((x, c) => x - places[j][c])) > 0.1);
    });
    const { meta, arrays } = await hand.state();
    assert.ok(meta.controls.every((c) => c.error_degrees < 1.5), JSON.stringify(meta.controls));
    for (const p of parts) assert.equal(arrays.singular[8 * arrays.singular_faces.indexOf(p.face) + 6], sign);
    const off = apartAwayFrom(spot(whole), mesh, before, arrays.branch, n);
    assert.ok(off < 20 / n, `${off} degrees`);  // any two fields: 90 / n
    await hand.editing(() => page.keyboard.press('Control+z'));
    assert.deepEqual(list(), [whole]);
    if (count < 3) return;
    await hand.editing(() => page.click('.numbers .actions button:text("In two")'));
    assert.deepEqual(list().map((s) => s.count), [Math.ceil(count / 2), count < 4 ? undefined : Math.floor(count / 2)]);
    assert.ok((await hand.state()).meta.controls.every((c) => c.error_degrees < 1.5));
  }));
}

test('in a mirror both happen on both sides, in one step', () => on(4, async (page, hand, { list, spot, onto, said, mirrored, zerosNear }) => {
  await page.waitForSelector('[aria-label=Mirror]', { state: 'visible' });
  await mirrored(0);
  /** Every control has an image of its kind, its index and its angle. */
  const symmetric = () => {
    for (const s of list()) {
      const [x, y, z] = spot(s);
      const image = list().find((q) => q.kind === s.kind && q.count === s.count && Math.hypot(spot(q)[0] + x, spot(q)[1] - y, spot(q)[2] - z) < 0.03);
      assert.ok(image, `${JSON.stringify(s)} has no image`);
    }
  };
  await hand.drop('saddle', 80, -30);
  await hand.drop('saddle', 120, 60);
  assert.equal(list().length, 4);
  const before = list(), first = await page.evaluate(() => alcap.design.singularities.map((s, k) => [alcap.handles.center(s)[0], k]).sort((a, b) => b[0] - a[0]).map(([, k]) => k));
  await onto(first[0], first[1]);
  assert.equal(await said(), 'Becomes saddle × 2, index −2/4, on both sides');
  await hand.editing(() => page.mouse.up());
  assert.deepEqual(list().map((s) => s.count), [2, 2]);
  symmetric();
  for (const s of list()) assert.equal(await zerosNear(s), 2);
  assert.ok((await hand.state()).meta.controls.every((c) => c.met));
  const merged = list();
  await hand.editing(() => page.keyboard.press('t'));
  assert.equal(list().length, 4);
  symmetric();
  const { meta, arrays } = await hand.state();
  assert.ok(meta.controls.every((c) => c.error_degrees < 1.5), JSON.stringify(meta.controls));
  for (const s of list()) assert.equal(arrays.singular[8 * arrays.singular_faces.indexOf(s.face) + 6], -1);
  await hand.editing(() => page.keyboard.press('Control+z'));
  assert.deepEqual(list(), merged);
  await hand.editing(() => page.keyboard.press('Control+z'));
  assert.deepEqual(list(), before);
}));

test('one that is dropped onto its own image lies in the plane of the mirror, and is taken apart to both sides', () => on(4, async (page, hand, { list, spot, onto, ringAt, said, mirrored, zerosNear }) => {
  await page.waitForSelector('[aria-label=Mirror]', { state: 'visible' });
  await page.evaluate(() => {
    // The plane is in the middle of the picture.
    alcap.stage.camera.position.set(0, 0, alcap.stage.camera.position.length());
    alcap.stage.controls.update();
    return alcap.stage.drawn();
  });
  await mirrored(0);
  await hand.drop('source', 60, 10);
  assert.equal(list().length, 2);
  const before = list();
  // The image comes from the other side as far.
  await onto(0, 1, 0.48);
  const [x, y] = await ringAt(0);
  await page.mouse.move(x - 1, y);
  assert.equal(await said(), 'Becomes source × 2, index +2/4');
  await hand.editing(() => page.mouse.up());
  const [sum, ...more] = list();
  assert.deepEqual([more.length, sum.kind, sum.count], [0, 'source', 2]);
  assert.ok(Math.abs(spot(sum)[0]) < 0.03, `${spot(sum)}`);
  assert.equal(await zerosNear(sum), 2);
  await hand.editing(() => page.keyboard.press('t'));
  const [a, b] = list().map(spot);
  assert.ok(Math.hypot(a[0] + b[0], a[1] - b[1], a[2] - b[2]) < 0.03 && Math.abs(a[0]) > 0.05, `${a} and ${b}`);
  for (const s of list()) assert.equal(await zerosNear(s), 1);
  await hand.editing(() => page.keyboard.press('Control+z'));
  await hand.editing(() => page.keyboard.press('Control+z'));
  assert.deepEqual(list(), before);
}));
