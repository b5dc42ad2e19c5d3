// SPDX-License-Identifier: MIT
//
// studio.test.mjs: the studio by mouse and keyboard, its file, its history, its doors.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import http from 'node:http';
import { join } from 'node:path';
import { after, before, beforeEach, test } from 'node:test';

import { alcap, darkPixels, drawnAt, folder, Hand, launch, open, request, studio, unpack } from './browser.mjs';

let browser, page, server, mesh, place;

before(async () => {
  place = folder();
  mesh = join(place, 'ball.ply');
  alcap('make', 'icosphere:3', '-o', mesh);
  server = await studio(mesh);
  browser = await launch();
  page = await open(browser, server.url);
});
after(async () => {
  await browser?.close();
  await server?.kill();
});
beforeEach(async () => {
  // An empty design for every test.
  const { status } = await request(server.url, '/api/edit', {}, { method: 'POST', body: empty });
  assert.equal(status, 200);
  await settled();
});

const empty = JSON.stringify({ alcap_design: 1, n: 4, guidance: { field: 'smoothest' } });
const hand = (tab = page) => new Hand(tab, server);
const design = () => hand().design();
const state = () => hand().state();
const field = async (url = server.url) => (await request(url, '/api/export', { format: 'ply' })).body;
const settled = (tab) => hand(tab).settled();
const middle = () => hand().middle();
const drop = (...how) => hand().drop(...how);
const brush = (...points) => hand().brush(...points);

const apart = (a, b, period) => Math.abs(((((a - b) % period) + 1.5 * period) % period) - period / 2);

test('starts with the smoothest field and complains about nothing', async () => {
  assert.equal(await page.textContent('h1'), 'ball');
  assert.match(await page.textContent('.controls'), /Nothing yet/);
  assert.ok((await darkPixels(page)) > 3000);
  assert.deepEqual(page.complaints, []);
});

test('a saddle dropped and turned by 60 degrees on screen is in design.json and in the solved field', async () => {
  await drop('saddle');
  const before = design().singularities[0];
  const box = await page.locator('.knob').boundingBox();
  const ring = await page.locator('.ring.chosen').boundingBox();
  const center = [ring.x + ring.width / 2, ring.y + ring.height / 2];
  const start = Math.atan2(box.y + box.height / 2 - center[1], box.x + box.width / 2 - center[0]);
  const radius = Math.hypot(box.y + box.height / 2 - center[1], box.x + box.width / 2 - center[0]);
  const at = (degrees) => [center[0] + radius * Math.cos(start - (degrees * Math.PI) / 180), center[1] + radius * Math.sin(start - (degrees * Math.PI) / 180)];
  await page.mouse.move(...at(0));
  await page.mouse.down();
  for (let degrees = 5; degrees <= 60; degrees += 5) await page.mouse.move(...at(degrees));
  await page.mouse.up();
  await settled();
  const { singularities, n } = design();
  assert.equal(singularities.length, 1);
  assert.equal(singularities[0].kind, 'saddle');
  assert.equal(singularities[0].face, before.face);
  const turned = apart(singularities[0].angle || 0, before.angle || 0, 360);
  assert.ok(Math.abs(turned - 60) < 5, `turned by ${turned}`);
  // The field has it there, with that orientation.
  const { meta, arrays } = await state();
  const k = arrays.singular_faces.indexOf(before.face);
  assert.notEqual(k, -1);
  assert.equal(arrays.singular[8 * k + 6], -1);
  assert.ok(apart((arrays.singular[8 * k + 7] * 180) / Math.PI, singularities[0].angle, 360 / (n + 1)) < 1);
  assert.equal(meta.controls[0].met, true);
  // The command line finds the same.
  const report = JSON.parse(alcap('design', mesh, '--design', server.design, '--json'));
  assert.equal(report.controls[0].met, true);
  // A drag is one step of the history.
  await page.keyboard.press('Control+z');
  await page.waitForFunction((angle) => Math.abs((alcap.design.singularities[0]?.angle || 0) - angle) < 1e-9, before.angle || 0);
  assert.equal(design().singularities[0].angle || 0, before.angle || 0);
});

test('a stroke drawn with the mouse aligns the field', async () => {
  const [x, y] = await middle();
  const from = [x - 70, y + 50], to = [x + 80, y - 20];
  await page.click('.toolbox [data-value=stroke]');
  const earlier = await state();
  await page.mouse.move(...from);
  await page.mouse.down();
  for (let s = 0; s <= 1.001; s += 0.05) await page.mouse.move(from[0] + s * (to[0] - from[0]), from[1] + s * (to[1] - from[1]));
  await page.mouse.up();
  await page.waitForFunction((revision) => Number(document.documentElement.dataset.revision) > revision, earlier.meta.revision);
  await settled();
  const [stroke] = design().strokes;
  assert.ok(stroke.points.length > 4);
  const off = (pack, m) => {
    // Mean deviation in degrees of the crosses at the corners of the stroke's faces from its direction there.
    const P = m.arrays.positions, F = m.arrays.faces;
    const place = ({ face, barycentric }) => [0, 1, 2].map((c) => barycentric.reduce((sum, b, j) => sum + b * P[3 * F[3 * face + j] + c], 0));
    let sum = 0, count = 0;
    for (let k = 1; k + 1 < stroke.points.length; ++k) {
      const a = place(stroke.points[k - 1]), b = place(stroke.points[k + 1]);
      const t = b.map((v, c) => v - a[c]);
      for (let j = 0; j < 3; ++j) {
        const v = F[3 * stroke.points[k].face + j];
        const d = [0, 1, 2].map((c) => pack.arrays.branch[3 * v + c]), normal = [0, 1, 2].map((c) => P[3 * v + c]);
        const cross = [d[1] * t[2] - d[2] * t[1], d[2] * t[0] - d[0] * t[2], d[0] * t[1] - d[1] * t[0]];
        const sine = (cross[0] * normal[0] + cross[1] * normal[1] + cross[2] * normal[2]) / Math.hypot(...normal);
        sum += apart((Math.atan2(sine, d[0] * t[0] + d[1] * t[1] + d[2] * t[2]) * 180) / Math.PI, 0, 90);
        ++count;
      }
    }
    return sum / count;
  };
  const surface = unpack((await request(server.url, '/api/mesh')).body);
  const drawn = off(await state(), surface);
  assert.ok(drawn < 12, `mean deviation ${drawn} degrees`);
  await page.click('.toolbox [data-value=turn]');
});

test('what an edit adds is drawn: every mark and every part of every stroke has its colour on the canvas', async () => {
  await drop('source', -90, -60);
  await brush([-80, 70], [-40, 90]);
  await drop('saddle', 90, -60);
  await drop('source', 10, -10);
  await brush([-20, 60], [40, 80], [90, 40], [120, 60]);
  const { arrays } = await state();
  const { singular } = arrays;
  for (const [sign, color] of [[1, [213, 94, 0]], [-1, [0, 114, 178]]]) {
    const marks = [];
    for (let k = 0; k < singular.length; k += 8) if (singular[k + 6] * sign > 0) marks.push(singular.slice(k, k + 6));
    const seen = await drawnAt(page, marks, color);
    assert.ok(seen.length > 0);
    assert.deepEqual(seen, seen.map(() => true), `marks of sign ${sign}`);
  }
  const { arrays: { positions: P, faces: F } } = unpack((await request(server.url, '/api/mesh')).body);
  const middles = design().strokes.flatMap(({ points }) => points.slice(1).map((to, k) => {
    const [a, b] = [points[k], to].map(({ face, barycentric }) => [0, 1, 2].map((c) => barycentric.reduce((sum, w, j) => sum + w * P[3 * F[3 * face + j] + c], 0)));
    const x = a.map((v, c) => (v + b[c]) / 2);
    return [...x, ...x];  // a ball: the normal is the place
  }));
  const seen = await drawnAt(page, middles, [15, 118, 110]);
  assert.ok(seen.length > 15);
  assert.ok(seen.filter((s) => s).length > 0.95 * seen.length, `${seen}`);
});

test('a saddle dragged across the surface takes its pattern with it, in one step of the history', async () => {
  await drop('saddle', -50, 10);
  const before = design().singularities[0];
  const heading = (s, surface) => {  // the direction of a branch in space
    const [a, b, c] = [0, 1, 2].map((j) => [0, 1, 2].map((k) => surface.positions[3 * surface.faces[3 * s.face + j] + k]));
    const minus = (p, q) => p.map((v, k) => v - q[k]), unit = (p) => p.map((v) => v / Math.hypot(...p));
    const times = (p, q) => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    const x = unit(minus(b, a)), y = times(unit(times(minus(b, a), minus(c, a))), x);
    const angle = ((s.angle || 0) * Math.PI) / 180;
    return x.map((v, k) => Math.cos(angle) * v + Math.sin(angle) * y[k]);
  };
  const box = await page.locator('.ring.chosen').boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let s = 8; s <= 64; s += 8) await page.mouse.move(x + s, y - s / 2);
  await page.mouse.up();
  await settled();
  const [moved] = design().singularities;
  assert.notEqual(moved.face, before.face);
  const ring = await page.locator('.ring.chosen').boundingBox();
  assert.ok(Math.hypot(ring.x + ring.width / 2 - x - 64, ring.y + ring.height / 2 - y + 32) < 12);
  const { arrays: surface } = unpack((await request(server.url, '/api/mesh')).body);
  const [d, e] = [heading(before, surface), heading(moved, surface)];
  assert.ok(d.reduce((sum, v, k) => sum + v * e[k], 0) > 0.85);  // the ball curves by 25 degrees on the way
  const { meta, arrays } = await state();
  assert.equal(meta.controls[0].met, true);
  assert.equal(arrays.singular[8 * arrays.singular_faces.indexOf(moved.face) + 6], -1);
  assert.match(await page.textContent('.chip'), /Solved in/);
  await page.keyboard.press('Control+z');
  await page.waitForFunction((face) => alcap.design.singularities[0]?.face === face, before.face);
  assert.deepEqual(design().singularities[0], before);
  await settled();
  assert.equal(await page.textContent('.chip'), 'Saved');  // nothing was solved
  // The keyboard moves it as well.
  await page.locator('.ring').focus();
  for (let k = 0; k < 4; ++k) {
    await page.keyboard.press('ArrowRight');
    await settled();
  }
  assert.notEqual(design().singularities[0].face, before.face);
});

test('a stroke is an object: chosen on the surface, weighed by a slider in one step, removed by a key', async () => {
  await brush([-60, 20], [60, 20]);
  const free = (await state()).meta.controls[0].error_degrees;
  const [x, y] = await middle();
  await page.mouse.click(x, y + 20);
  await page.waitForSelector('.controls li.chosen .slider');
  const weight = page.locator('.controls .slider input[aria-label=Weight]');
  assert.equal(await page.textContent('.controls .slider output'), '10');
  const box = await weight.boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  for (let s = 0.5; s <= 0.9; s += 0.05) await page.mouse.move(box.x + s * box.width, box.y + box.height / 2);
  await page.mouse.up();
  await settled();
  assert.ok(design().strokes[0].weight > 100, `weight ${design().strokes[0].weight}`);
  assert.ok((await state()).meta.controls[0].error_degrees < free);
  assert.equal((await state()).meta.controls[0].tolerance_degrees, 10);
  await page.keyboard.press('Control+z');
  await page.waitForFunction(() => alcap.design.strokes?.[0]?.weight === 10);
  await page.mouse.click(x, y + 20);
  await page.keyboard.press('Delete');
  await page.waitForFunction(() => !alcap.design.strokes?.length);
});

test('the eraser splits a stroke where it passes, and takes what is left of it', async () => {
  await brush([-80, 20], [80, 20]);
  const whole = design().strokes[0].points.length;
  const [x, y] = await middle();
  await page.click('.toolbox [data-value=erase]');
  await hand().editing(() => hand().drag([x, y - 30], [x, y + 70]));
  assert.equal(design().strokes.length, 2);
  const left = design().strokes.map((s) => s.points.length);
  assert.ok(left[0] > 3 && left[1] > 3 && left[0] + left[1] < whole, `${whole} became ${left}`);
  await hand().editing(() => hand().drag([x - 100, y + 20], [x + 100, y + 20]));
  assert.deepEqual(design().strokes || [], []);
  await page.click('.toolbox [data-value=turn]');
});

test('edits are mirrored: a control, its move and its removal happen on both sides', async () => {
  await page.click('[aria-label=Mirror] [data-value="0"]');
  try {
    await drop('saddle', 60, 20);
    const { arrays: { positions: P, faces: F } } = unpack((await request(server.url, '/api/mesh')).body);
    const spot = ({ face, pin }) => [0, 1, 2].map((c) => pin.reduce((sum, w, j) => sum + w * P[3 * F[3 * face + j] + c], 0));
    const check = () => {
      const [a, b, ...more] = design().singularities.map(spot);
      assert.equal(more.length, 0);
      assert.ok(Math.hypot(a[0] + b[0], a[1] - b[1], a[2] - b[2]) < 0.02, `${a} and ${b}`);
      return a;
    };
    const before = check();
    await page.focus('.ring.chosen');
    for (let k = 0; k < 3; ++k) await hand().editing(() => page.keyboard.press('ArrowRight'));
    const after = check();
    assert.ok(Math.hypot(...after.map((v, c) => v - before[c])) > 0.05);
    await hand().editing(() => page.keyboard.press('Delete'));
    assert.deepEqual(design().singularities || [], []);
  } finally {
    await page.click('[aria-label=Mirror] [data-value="-1"]');
  }
});

test('the smoothest fields can be looked at, and the design stays as it is', async () => {
  await drop('source');
  const own = await field(), text = readFileSync(server.design, 'utf8');
  const show = (k) => hand().editing(() => page.click(`[aria-label="Smoothest field"] [data-value="${k}"]`));
  await show(2);
  const { meta } = await state();
  assert.equal(meta.mode, 2);
  assert.ok(meta.eigenvalues.length === 8 && meta.eigenvalues.every((v, k) => k === 0 || v >= meta.eigenvalues[k - 1] * (1 - 1e-6)));
  assert.notEqual(Buffer.compare(own, await field()), 0);
  assert.equal(readFileSync(server.design, 'utf8'), text);
  await show(0);
  assert.equal(Buffer.compare(own, await field()), 0);
  assert.equal((await request(server.url, '/api/mode', { mode: 99 }, { method: 'POST', body: '' })).status, 400);
});

test('eigen designs: what they do not take is left out, and the command line agrees', async () => {
  await drop('source', -60, 0);
  await brush([-40, 50], [60, 60]);
  await hand().editing(() => page.click('[data-value=eigen]'));
  const d = design();
  assert.equal(d.method, 'eigen');
  assert.equal(d.singularities[0].pin, undefined);
  assert.equal((await state()).meta.problem, '');
  const report = JSON.parse(alcap('design', mesh, '--design', server.design, '--json'));
  assert.equal(report.ok, true);
  await hand().editing(() => page.click('[data-value=variational]'));
  assert.equal(design().guidance.field, 'smoothest');
});

test('what nobody looks at is not computed: curves are asked for when they are shown', async () => {
  await page.click('[aria-label="Field as"] [data-value=glyphs]');
  const asked = [];
  const note = (r) => { if (r.url().includes('/api/details')) asked.push(new URL(r.url()).searchParams.get('part')); };
  page.on('request', note);
  await drop('source');
  assert.deepEqual(asked, []);
  await page.click('[aria-label="Field as"] [data-value=curves]');
  await page.waitForFunction(() => !alcap.view.stale.curves);
  assert.deepEqual(asked, ['curves']);
  page.off('request', note);
});

test('every format that the page offers can be saved', async () => {
  await page.click('nav [title="Save the field for another program"]');
  const links = await page.locator('.exports a').evaluateAll((list) => list.map((a) => a.getAttribute('href')));
  assert.ok(links.length >= 5);
  for (const link of links) {
    const answer = await fetch(new URL(link, server.url));
    assert.equal(answer.status, 200, link);
    assert.ok((await answer.arrayBuffer()).byteLength > 10, link);
  }
  await page.click('.exports .plain');
});

test('a singularity that nobody asked for says so, and can be held where it is', async () => {
  const { arrays } = await state();
  const { singular, singular_faces: faces } = arrays;
  const shown = await page.evaluate((singular) => {
    const { camera, canvas } = alcap.stage, box = canvas.getBoundingClientRect();
    for (let k = 0; k < singular.length; k += 8) {
      const p = camera.position.clone().set(...singular.slice(k, k + 3));
      if (p.dot(camera.position) < 0.5 * p.length() * camera.position.length()) continue;
      p.project(camera);
      return { number: k / 8, x: box.left + ((p.x + 1) / 2) * box.width, y: box.top + ((1 - p.y) / 2) * box.height };
    }
    return null;
  }, singular);
  assert.ok(shown);
  await page.mouse.click(shown.x, shown.y);
  assert.match(await page.textContent('.card'), /Nobody asked for it.*sum to 2/s);
  const { meta } = await state();
  await page.click('.card .primary');
  await page.waitForFunction((revision) => Number(document.documentElement.dataset.revision) > revision, meta.revision);
  await settled();
  const [held] = design().singularities;
  assert.equal(held.face, faces[shown.number]);
  assert.equal(held.kind, 'source');
  const after = await state();
  assert.equal(after.meta.controls[0].met, true);
  // The field wanted it there: the others stay, or move to the next face.
  const places = (list) => Array.from({ length: list.length / 8 }, (_, k) => list.slice(8 * k, 8 * k + 3));
  const [earlier, later] = [places(singular), places(after.arrays.singular)];
  assert.equal(later.length, earlier.length);
  for (const p of earlier) assert.ok(Math.min(...later.map((q) => Math.hypot(...p.map((v, c) => v - q[c])))) < 0.15);
});

test('undo brings the field of before back, bit for bit; redo the other', async () => {
  const first = await field();
  await drop('source', 30, 20);
  const second = await field();
  assert.notEqual(Buffer.compare(first, second), 0);
  await page.keyboard.press('Control+z');
  await page.waitForFunction(() => !(alcap.design.singularities || []).length);
  assert.equal(Buffer.compare(first, await field()), 0);
  await page.keyboard.press('Control+Shift+z');
  await page.waitForFunction(() => (alcap.design.singularities || []).length === 1);
  assert.equal(Buffer.compare(second, await field()), 0);
});

test('every request needs the token, our host and our origin', async () => {
  const { port, searchParams } = new URL(server.url);
  const t = searchParams.get('t');
  const get = (path, headers = {}, method = 'GET') => new Promise((done, fail) => {
    http.request({ host: '127.0.0.1', port, path, method, headers }, (answer) => { answer.resume(); done(answer.statusCode); }).on('error', fail).end();
  });
  assert.equal(await get(`/?t=${t}`), 200);
  for (const path of ['/', '/api/mesh', '/api/state', '/api/design', '/api/export', '/nothing']) {
    assert.equal(await get(path), 403);
    assert.equal(await get(`${path}?t=${t.slice(0, -1)}`), 403);
    assert.equal(await get(`${path}?t=${'0'.repeat(32)}`), 403);
  }
  assert.equal(await get(`/?t=${t}`, { Host: `evil.example:${port}` }), 403);
  assert.equal(await get(`/api/undo?t=${t}`, { Origin: 'http://evil.example' }, 'POST'), 403);
  assert.equal(await get(`/api/undo?t=${t}`, { 'Sec-Fetch-Site': 'cross-site' }, 'POST'), 403);
  assert.equal(await get(`/api/state?t=${t}`, { Origin: `http://127.0.0.1:${port}` }), 200);
});

test('designs that make no sense or name files are refused, and change nothing', async () => {
  const before = readFileSync(server.design, 'utf8');
  const post = async (body) => (await request(server.url, '/api/edit', {}, { method: 'POST', body })).status;
  assert.equal(await post('{'), 400);
  assert.equal(await post('{"alcap_design": 1, "n": 4, "surprise": 1}'), 400);
  assert.equal(await post('{"alcap_design": 1, "n": 4, "singularities": [{"face": 99999999, "kind": "saddle"}]}'), 400);
  assert.equal(await post('{"alcap_design": 1, "n": 4, "guidance": {"file": "/etc/hostname"}}'), 400);
  assert.equal(await post(`{"alcap_design": 1, "n": 4, "comment": "${'x'.repeat(9 << 20)}"}`).catch(() => 413), 413);
  assert.equal(readFileSync(server.design, 'utf8'), before);
});

test('cones: a running sum says what is missing, and the field comes when it is right', async () => {
  const cones = (list) => JSON.stringify({ alcap_design: 1, n: 4, guidance: { field: 'smoothest' }, connection: { kind: 'trivial', cones: list.map((vertex) => ({ vertex, index: '1/4' })) } });
  const post = (list) => request(server.url, '/api/edit', {}, { method: 'POST', body: cones(list) });
  assert.equal((await post([0, 1, 2])).status, 200);
  await page.waitForFunction(() => /Place \+5\/4 more/.test(document.querySelector('.cones').textContent));
  await page.waitForFunction(() => /^The cones sum to \+3\/4 so far, of 2\.$/.test(document.querySelector('.chip').textContent));
  assert.notEqual((await state()).meta.problem, '');
  await page.click('.cones .toggle');
  await page.waitForFunction(() => alcap.design.connection.balance === true);
  await settled();
  assert.equal((await state()).meta.problem, '');
  await page.click('.cones .toggle');
  await page.waitForFunction(() => !alcap.design.connection.balance);
  await settled();
  await post([0, 1, 2, 3, 4, 5, 6, 7]);
  await page.waitForFunction(() => /of 2 needed\+2 ✓/.test(document.querySelector('.cones').textContent));
  assert.equal((await state()).meta.problem, '');
});

test('the field aligns with principal curvature, and vector fields are not offered it', async () => {
  await page.click('[data-value=curvature]');
  await page.waitForFunction(() => alcap.design.guidance.field === 'curvature');
  await settled();
  assert.equal(design().guidance.field, 'curvature');
  await page.click('[role=radiogroup][aria-label=Symmetry] [data-value="1"]');
  await page.waitForFunction(() => alcap.design.n === 1);
  await settled();
  assert.equal(design().guidance.field, 'smoothest');
  assert.equal(await page.isDisabled('[data-value=curvature]'), true);
  assert.deepEqual(await page.locator('.toolbox button').allTextContents(), ['Turn', 'Source', 'Sink', 'Vortex', 'Saddle', 'Direction', 'Brush', 'Eraser']);
});

test('a second tab follows', async () => {
  const tab = await open(browser, server.url, { viewport: { width: 390, height: 844 } });
  await settled(tab);
  await drop('source');
  await tab.waitForFunction(() => (alcap.design.singularities || []).length === 1);
  await settled(tab);
  assert.ok((await darkPixels(tab)) > 1500);
  assert.deepEqual(tab.complaints, []);
  await tab.context().close();
});

test('a killed server starts again with the same design and the same field', async () => {
  await drop('saddle', -40, 30);
  const text = readFileSync(server.design, 'utf8'), before = await field();
  await page.goto('about:blank');
  await server.kill();
  server = await studio(mesh);
  assert.equal(readFileSync(server.design, 'utf8'), text);
  page = await open(browser, server.url);
  await page.waitForFunction(() => (alcap.design.singularities || []).length === 1);
  assert.deepEqual(await page.evaluate(() => alcap.design), JSON.parse(text));
  const again = await field();
  assert.equal(again.length, before.length);
  assert.deepEqual(page.complaints, []);
});
