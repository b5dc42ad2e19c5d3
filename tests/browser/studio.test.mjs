// SPDX-License-Identifier: MIT
//
// studio.test.mjs: the studio by mouse and keyboard, its file, its history, its doors.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import http from 'node:http';
import { join } from 'node:path';
import { after, before, beforeEach, test } from 'node:test';

import { alcap, darkPixels, drawnAt, folder, Hand, judged, launch, open, patience, request, studio, unpack } from './browser.mjs';

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
  assert.equal(judged(mesh, server.design).controls[0].met, true);
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
  await settled();
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

test('eigen designs: pins and wide strokes stay, guidance can be chosen, and the command line agrees', async () => {
  await drop('source', -60, 0);
  await brush([-40, 50], [60, 60]);
  const before = design();
  await hand().editing(() => page.click('[data-value=eigen]'));
  const d = design();
  assert.equal(d.method, 'eigen');
  assert.equal(d.guidance, undefined);
  assert.deepEqual(d.singularities, before.singularities);
  assert.deepEqual(d.strokes, before.strokes);
  assert.equal((await state()).meta.problem, '');
  await hand().editing(() => page.click('[aria-label=Elsewhere] [data-value=smoothest]'));
  assert.deepEqual(design().guidance, { field: 'smoothest' });  // a weight of 1 is what files without one have
  assert.equal((await state()).meta.problem, '');
  // How well the stroke can be followed depends on where it runs: both say the same of it.
  const report = judged(mesh, server.design), { controls } = (await state()).meta;
  assert.equal(report.certified, true);
  assert.equal(report.guidance.field, 'smoothest');
  assert.deepEqual(controls.map((c) => [c.path, c.met]), report.controls.map((c) => [c.path, c.met]));
  assert.equal(controls.length, 2);
  assert.equal(controls[0].met, true);
  controls.forEach((c, k) => assert.ok(Math.abs(c.error_degrees - report.controls[k].error_degrees) < 0.01, `${c.error_degrees} and ${report.controls[k].error_degrees}`));
  await hand().editing(() => page.click('[aria-label=Elsewhere] [data-value=none]'));
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

test('every format of the command line is offered, and each file holds what its label says', async () => {
  let said = '';
  try {
    alcap('field', mesh, '-o', join(place, 'field.unknown'), '-q');
  } catch (error) {
    said = error.stderr;
  }
  const known = said.match(/\(known: ([^)]*)\)/)[1].split(', ').map((f) => f.slice(1)).sort();
  assert.ok(known.length >= 11, said);
  const { arrays } = await state();
  const singular = arrays.singular_faces.length;
  const rows = { face: 1280, vertex: 642 };
  /** Of a file: format, number of rows of the field, and of singularities where it holds these. */
  const contents = (bytes) => {
    const text = bytes.toString('latin1'), lines = text.trim().split('\n');
    if (text.startsWith('ply\n')) return ['ply', Number(text.match(/element vertex (\d+)/)[1])];
    if (text.startsWith('<?xml')) {
      const [points, polygons] = ['Points', 'Polys'].map((what) => Number(text.match(new RegExp(`NumberOf${what}="(\\d+)"`))[1]));
      return polygons ? ['vtp', points] : ['vtp', 0, points];
    }
    if (text.startsWith('\x93NUMPY')) {
      const shape = text.match(/'shape': \((\d+), 14\)/);
      assert.equal(bytes.length, 10 + bytes.readUInt16LE(8) + 8 * 14 * shape[1]);
      return ['npy', Number(shape[1])];
    }
    if (text.startsWith('0 0\n14 ')) {
      assert.equal(bytes.length, 4 + lines[1].length + 1 + 8 * 14 * Number(lines[1].split(' ')[1]));
      return ['dmat', Number(lines[1].split(' ')[1])];
    }
    if (/^(face|vertex),x,y,z,/.test(text)) {
      assert.ok(lines.slice(1).every((l, k) => l.split(',').length === 15 && l.startsWith(`${k},`)));
      return ['csv', lines.length - 1, undefined, text.split(',')[0]];
    }
    if (/^\d+\n4\n/.test(text)) {
      assert.equal(lines.length - 2, Number(lines[0]));
      return ['rosy', Number(lines[0])];
    }
    const [n, number] = lines[0].split(' ').map(Number);
    assert.equal(n, 4);
    assert.equal(lines.length - 1, number);
    return lines[1].split(' ').length === 12 ? ['rawfield', number] : ['sings', 0, number];
  };
  await page.click('nav [title="Save the field for another program"]');
  const links = await page.locator('.exports a').evaluateAll((list) => list.map((a) => [a.getAttribute('href'), a.textContent]));
  const offered = new Set();
  for (const [link, label] of links) {
    const format = new URL(link, server.url).searchParams.get('format');
    offered.add(format);
    const answer = await fetch(new URL(link, server.url));
    assert.equal(answer.status, 200, link);
    const [kind, number, marks, per] = contents(Buffer.from(await answer.arrayBuffer()));
    assert.ok(label.toLowerCase().split(':')[0].endsWith(kind), `${label}: ${kind}`);
    if (/singular/.test(label)) {
      assert.deepEqual([number, marks], [0, singular], label);
    } else {
      const said = label.match(/per (face|vertex)/)?.[1] || 'vertex';
      assert.equal(number, rows[said], label);
      if (per) assert.equal(per, said);
    }
  }
  assert.deepEqual([...offered].sort(), known);
  assert.equal(links.length, known.length + 3);
  // What a click saves is such a file.
  const saved = page.waitForEvent('download');
  await page.click('.exports a >> text=vertex.csv');
  const download = await saved;
  assert.equal(download.suggestedFilename(), 'ball.field.vertex.csv');
  assert.deepEqual(contents(readFileSync(await download.path())), ['csv', 642, undefined, 'vertex']);
  // One of them holds crosses only.
  await hand().editing(() => page.click('[aria-label=Symmetry] [data-value="2"]'));
  await page.click('nav [title="Save the field for another program"]');
  assert.equal(await page.isVisible('.exports a >> text=rosy'), false);
  assert.equal(await page.isVisible('.exports a >> text=vertex.dmat'), true);
  await page.click('.exports .plain');
});

test('whatever grows by an edit is drawn whole: glyphs, marks, arms, curves, separatrices', async () => {
  await page.click('text=Separatrices');
  const accent = (await page.evaluate(() => getComputedStyle(document.documentElement).getPropertyValue('--accent'))).trim().match(/[\da-f]{2}/gi).map((x) => parseInt(x, 16));
  /** Triangles that the renderer draws of one thing alone, in instances: two to a segment. */
  const drawn = () => page.evaluate(async () => {
    const { stage, view } = alcap, { renderer, scene } = stage;
    view.glyphs.show(true);  // they are built when they are seen
    await stage.drawn();
    const count = (object) => {
      const others = new Map();
      const only = (node) => {
        if (node === object) return;
        const own = node.children.some((child) => child === object || child.children.includes(object));
        if (!own) {
          others.set(node, node.visible);
          node.visible = false;
        }
      };
      for (const node of scene.children) {
        only(node);
        if (node.children.includes(object)) node.children.forEach(only);
      }
      renderer.render(scene, stage.camera);
      const { triangles } = renderer.info.render;
      for (const [node, visible] of others) node.visible = visible;
      return triangles;
    };
    const glyphs = view.glyphs.sets[view.meta.n === 1].object;
    glyphs.visible = true;
    const numbers = {
      glyphs: count(glyphs) / 2, curves: count(view.curves.object) / 2, separatrices: count(view.separatrices.object) / 2,
      arms: view.marks.arms.reduce((sum, a) => sum + count(a.object) / 2, 0),
      marks: view.marks.kinds.reduce((sum, { shape, meshes: [mesh] }) => sum + count(mesh) / ((shape.index?.count ?? shape.attributes.position.count) / 3), 0),
    };
    view.apply();
    return numbers;
  });
  const segments = (offsets) => offsets.slice(1).reduce((sum, end, k) => sum + Math.max(end - offsets[k] - 1, 0), 0);
  const details = async (part, result) => unpack((await request(server.url, '/api/details', { result, part })).body).arrays;
  let before = null;
  for (const [n, singularities] of [[1, []], [2, []], [4, [{ face: 10, kind: 'saddle' }]], [6, [{ face: 10, kind: 'saddle' }, { face: 700, kind: 'saddle', count: 2 }]]]) {
    await request(server.url, '/api/edit', {}, { method: 'POST', body: JSON.stringify({ alcap_design: 1, n, guidance: { field: 'smoothest' }, singularities }) });
    await settled();
    const { meta, arrays } = await state();
    const curves = await details('curves', meta.result), lines = await details('separatrices', meta.result);
    const now = await drawn();
    assert.equal(now.curves, segments(curves.curve_offsets));
    assert.equal(now.separatrices, segments(lines.separatrix_offsets));
    assert.equal(now.arms, arrays.arms.length / 4);
    assert.equal(now.marks, arrays.singular_faces.length);
    const spread = await page.evaluate(() => alcap.view.glyphs.vertices.length);
    assert.ok(now.glyphs > 0.9 * spread * (n === 1 ? 1 : n / 2), `${now.glyphs} of ${spread}`);
    if (before) for (const what of Object.keys(now)) assert.ok(what === 'glyphs' && n === 2 ? true : now[what] > before[what], `${what}, n = ${n}: ${before[what]} to ${now[what]}`);
    before = now;
    // The last ones of each list are on the canvas.
    const arms = arrays.arms.length ? Array.from({ length: arrays.arms.length / 4 }, (_, k) => arrays.arms.slice(4 * k, 4 * k + 4)) : [];
    const length = await page.evaluate(() => 0.022 * alcap.view.meta.diagonal);
    for (const [sign, color] of [[1, [213, 94, 0]], [-1, [0, 114, 178]]]) {
      const points = arms.filter(([s]) => sign * arrays.singular[8 * s + 6] > 0).map(([s, ...d]) => {
        const at = arrays.singular.slice(8 * s, 8 * s + 6);
        return [...at.slice(0, 3).map((x, c) => x + 0.75 * length * d[c]), ...at.slice(3)];
      });
      const seen = await drawnAt(page, points, color);
      assert.ok(seen.every(Boolean), `arms of sign ${sign}, n = ${n}: ${seen}`);
    }
    const ends = lines.separatrix_offsets.slice(1).map((end, k) => (end + lines.separatrix_offsets[k]) >> 1).map((i) => lines.separatrices.slice(3 * i, 3 * i + 3)).map((p) => [...p, ...p]);
    const seen = await drawnAt(page, ends, accent);
    assert.ok((n < 4 || seen.length) && seen.filter(Boolean).length >= 0.8 * seen.length, `separatrices, n = ${n}: ${seen}`);
  }
  await page.click('text=Separatrices');
  await page.evaluate(() => alcap.view.apply());
  assert.deepEqual(page.complaints, []);
});

test('a singularity that no control asks for says so, and can be held where it is', async () => {
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
  assert.match(await page.textContent('.card'), /No control asks for it.*sum to 2/s);
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

test('a singularity of a larger index can be held, as zeros side by side', async () => {
  // On 80 faces the indices of a 40-fold field sum to 80/40: some faces hold two.
  const coarse = join(place, 'coarse.ply');
  alcap('make', 'icosphere:1', '-o', coarse, '-q');
  const other = await studio(coarse, '-n', '40'), tab = await open(browser, other.url), own = new Hand(tab, other);
  try {
    await own.settled();
    const { arrays: { singular } } = await own.state();
    const k = Array.from({ length: singular.length / 8 }, (_, j) => j).find((j) => Math.abs(singular[8 * j + 6]) > 1 && Math.abs(singular[8 * j + 6]) <= 8);
    assert.ok(k >= 0, 'no face holds more than one');
    const index = singular[8 * k + 6], { arrays: { singular_faces: faces } } = await own.state();
    await tab.evaluate((k) => alcap.card.tell(k), k);
    await own.editing(() => tab.click('.card .primary'));
    const [held] = own.design().singularities;
    assert.deepEqual([held.face, held.kind, held.count], [faces[k], index > 0 ? 'source' : 'saddle', Math.abs(index)]);
    assert.equal(await tab.inputValue('.controls .slider input[aria-label=Zeros]'), String(Math.abs(index)));
  } finally {
    await tab.context().close();
    await other.kill();
  }
});

test('a pair that is cancelled leaves a stroke that the field follows; one that stays leaves nothing', async () => {
  const stone = join(place, 'stone.ply');
  alcap('make', 'scan:4,0.25', '-o', stone, '-q');
  const other = await studio(stone), tab = await open(browser, other.url), own = new Hand(tab, other);
  try {
    await own.settled();
    await tab.click('[aria-label="Field as"] [data-value=none]');
    const pairs = await tab.evaluate(() => Array.from(alcap.view.arrays.singular_faces, (_, k) => [k, alcap.card.partner(k)]).filter(([k, partner]) => partner > k));
    const places = (arrays) => Array.from({ length: arrays.singular.length / 8 }, (_, k) => arrays.singular.slice(8 * k, 8 * k + 3));
    const first = await own.state(), before = places(first.arrays);
    let cancelled = 0;
    for (const pair of pairs) {
      await tab.evaluate(([k, partner]) => alcap.card.cancel(alcap.card.seen(k), alcap.card.seen(partner)), pair);
      await own.settled();
      const { meta, arrays } = await own.state(), left = places(arrays);
      if (await tab.isVisible('.card')) {
        assert.match(await tab.textContent('.card'), /The field keeps this pair/);
        assert.deepEqual(meta.design, first.meta.design);
        assert.deepEqual(left, before);
        await tab.click('.card .close');
        continue;
      }
      ++cancelled;
      const [a, b] = pair.map((k) => before[k]), far = (p, q) => Math.hypot(...p.map((x, c) => x - q[c]));
      assert.ok(left.length <= before.length - 2);
      for (const p of [a, b]) assert.ok(Math.min(...left.map((q) => far(p, q))) > 0.3 * far(a, b));
      assert.equal(own.design().strokes.length, 1);
      assert.equal(meta.controls[0].met, true, `off by ${meta.controls[0].error_degrees}`);
      assert.equal(judged(stone, other.design).met, true);
      await own.editing(() => tab.keyboard.press('Control+z'));  // one step
      assert.deepEqual(own.design(), first.meta.design);
    }
    assert.ok(pairs.length > 2 && cancelled > 1, `${cancelled} of ${pairs.length}`);
  } finally {
    await tab.context().close();
    await other.kill();
  }
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

test('what is edited after a refusal starts from the design that was taken', async () => {
  // The page learns the design again, slowly.
  await page.route('**/api/state*', async (route) => {
    await new Promise((go) => setTimeout(go, 1500));
    await route.continue();
  });
  try {
    await page.evaluate(() => { alcap.change((d) => { d.guidance.weights = [1, 2]; }); });
    await page.waitForFunction(() => /weights/.test(document.querySelector('.chip').textContent));
    await page.evaluate(() => { alcap.change((d) => { d.comment = 'after'; }); });
    await page.waitForFunction(() => !alcap.store.busy);
  } finally {
    await page.unroute('**/api/state*');
  }
  await settled();
  assert.equal(design().comment, 'after');
  assert.equal(design().guidance.weights, undefined);
  assert.equal(page.complaints.splice(0).length, 1);  // of the request that was refused
});

test('a page that has not seen an edit does not take it back', async () => {
  const tab = await (await browser.newContext({ viewport: { width: 700, height: 500 } })).newPage();
  tab.setDefaultTimeout(patience);
  await tab.route('**/api/wait*', () => {});  // it is told nothing
  await tab.goto(server.url);
  await tab.waitForSelector('html[data-ready]');
  for (const comment of ['first', 'second']) {
    assert.equal((await request(server.url, '/api/edit', {}, { method: 'POST', body: JSON.stringify({ ...JSON.parse(empty), comment }) })).status, 200);
  }
  const { meta } = await state();
  await tab.evaluate(() => alcap.store.step('undo'));
  await tab.waitForFunction(() => /Another tab/.test(document.querySelector('.chip').textContent));
  assert.equal(design().comment, 'second');
  assert.equal((await state()).meta.revision, meta.revision);
  await tab.waitForFunction(() => alcap.design.comment === 'second' && !alcap.store.busy);
  // Now it has.
  await tab.evaluate(() => alcap.store.step('undo'));
  await tab.waitForFunction(() => alcap.design.comment === 'first');
  assert.equal(design().comment, 'first');
  await tab.context().close();
  await settled();
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
