// SPDX-License-Identifier: MIT
//
// design.test.mjs: whatever a design file can hold (docs/design.schema.json) is shown by the studio, kept by edits, and
// within reach of the panel.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { alcap, drawnAt, folder, Hand, judged, launch, open, request, studio, unpack } from './browser.mjs';

let browser;
before(async () => { browser = await launch(); });
after(async () => { await browser?.close(); });

/** A studio on a ball with a design of its own; make(place, mesh) returns the design. */
async function on(name, make, act) {
  const place = folder(), mesh = join(place, `${name}.ply`), file = join(place, 'a.design.json');
  alcap('make', 'icosphere:3', '-o', mesh, '-q');
  writeFileSync(file, JSON.stringify({ alcap_design: 1, ...make(place, mesh) }));
  const server = await studio(mesh, '--design', file);
  try {
    const page = await open(browser, server.url);
    const hand = new Hand(page, server);
    await hand.settled();
    await act(page, hand, { place, mesh, report: () => judged(mesh, server.design) });
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  } finally {
    await server.kill();
  }
}

const slide = async (page, hand, label, key) => {
  await page.focus(`.panel input[aria-label="${label}"]`);
  await hand.editing(() => page.keyboard.press(key));
};
const load = (page, hand, label, place, value) => {
  const file = join(place, 'value.json');
  writeFileSync(file, JSON.stringify(value));
  return hand.editing(() => page.setInputFiles(`.panel input[type=file][aria-label="${label}"]`, file));
};

test('a design from elsewhere is shown, said, and kept whatever is edited; no page names files', () => on('all', (place, mesh) => {
  alcap('field', mesh, '-n', '2', '-o', join(place, 'own.ply'), '-q');
  return {
    comment: 'from elsewhere', n: 2, s: 0.25, mesh: { vertices: 642, faces: 1280 },
    connection: { kind: 'global', detail: 2, length_factor: 'metric', tan_cap: 20 },
    guidance: { file: 'own.ply', weight: 0.5, weights: Array.from({ length: 642 }, (_, v) => (v % 2 ? 1 : 2)) },
    singularities: [
      { name: 'bow', at: [0.1, 0.9, 0.4], kind: 'saddle', count: 2, angle: 15, relative_to: [1, 0, 0], strength: 3 },
      { face: 40, kind: 'trisector', pin: true },
    ],
    fixed: [{ name: 'stern', at: [0, -1, 0], angle: 30, relative_to: [1, 0, 0], length: 2 }],
    strokes: [{ name: 'keel', vertices: [100, 200, 300], weight: 4, radius: 0.2 }, { path: [[0, 0, 1], [0.3, 0, 0.9], [0.5, 0.1, 0.8]] }],
    edits: [{ move: 1, to: 44 }],
  };
}, async (page, hand, { report }) => {
  const names = await page.locator('.controls .name').allTextContents();
  assert.equal(names[0], 'bow × 2 · 15°');
  assert.deepEqual(names.slice(2), ['stern', 'Keel', 'Stroke 2']);
  assert.match(await page.textContent('.remarks'), /came with 1 edit .*points of space/s);
  assert.equal(await page.inputValue('[aria-label=Comment]'), 'from elsewhere');
  assert.equal(await page.textContent('[aria-label=Elsewhere] [aria-checked=true]'), 'own.ply');
  assert.match(await page.textContent('.guidance'), /642 weights, 1 to 2/);
  // Strokes along edges are drawn where they run.
  const drawn = await page.evaluate(() => alcap.strokes.pointsOf(alcap.design.strokes[0]).map((p) => [...p, ...p]));
  const seen = await page.evaluate(() => alcap.strokes.lines.total);
  assert.ok(drawn.length > 3 && seen > drawn.length, `${drawn.length} points, ${seen} segments`);
  const first = hand.design;
  await page.click('.controls .name >> nth=0');
  assert.match(await page.textContent('.numbers'), /starts from the direction 1, 0, 0/);
  await slide(page, hand, 'Strength', 'ArrowRight');
  const d = first.call(hand);
  assert.equal(d.comment, 'from elsewhere');
  assert.deepEqual(d.mesh, { vertices: 642, faces: 1280 });
  assert.equal(d.s, 0.25);
  assert.deepEqual([d.connection.detail, d.connection.length_factor, d.connection.tan_cap], [2, 'metric', 20]);
  assert.deepEqual([d.guidance.file, d.guidance.weight, d.guidance.weights.length], ['own.ply', 0.5, 642]);
  const [bow, moved] = d.singularities;
  assert.ok(bow.strength > 3);
  assert.deepEqual([bow.name, bow.count, bow.angle, bow.relative_to], ['bow', 2, 15, [1, 0, 0]]);
  assert.deepEqual([moved.face, d.edits], [44, undefined]);
  assert.deepEqual([d.fixed[0].angle, d.fixed[0].relative_to, d.fixed[0].length, d.fixed[0].name], [30, [1, 0, 0], 2, 'stern']);
  assert.deepEqual([d.strokes[0].vertices, d.strokes[0].radius, d.strokes[1].points.length], [[100, 200, 300], 0.2, 3]);
  assert.equal(report().controls.length, 5);
  // The angle can start from the face, with the same field.
  const before = await hand.state();
  await hand.editing(() => page.click('text=Start from the face'));
  const after = await hand.state();
  assert.equal(hand.design().singularities[0].relative_to, undefined);
  const off = after.arrays.branch.reduce((most, v, k) => Math.max(most, Math.abs(v - before.arrays.branch[k])), 0);
  assert.ok(off < 10, `${off}`);
  const post = (design) => request(hand.server.url, '/api/edit', {}, { method: 'POST', body: JSON.stringify(design) });
  assert.equal((await post({ ...d, guidance: { file: 'other.ply' } })).status, 400);
  assert.equal((await post({ ...d, guidance: { file: '../own.ply' } })).status, 400);
  assert.equal((await post(d)).status, 200);
}));

test('the field that is shown can be kept as what the design stays close to', () => on('keep', () => ({ n: 4, guidance: { field: 'smoothest' } }), async (page, hand, { place, report }) => {
  await hand.editing(() => page.click('[aria-label="Smoothest field"] [data-value="3"]'));
  const shown = (await hand.state()).arrays.branch;
  await hand.editing(() => page.click('text=Keep this field'));
  const { guidance } = hand.design();
  assert.deepEqual(guidance, { file: 'a.guidance-1.ply' });
  assert.ok(readFileSync(join(place, guidance.file)).length > 1000);
  // Nothing else is asked for: the field is the kept one.
  const { arrays, meta } = await hand.state();
  assert.deepEqual([meta.problem, meta.mode], ['', 0]);
  const off = arrays.branch.reduce((most, v, k) => Math.max(most, Math.abs(v - shown[k])), 0);
  assert.ok(off < 200, `${off} of 32767`);
  await hand.drop('source', 30, 20);
  assert.equal(hand.design().guidance.file, guidance.file);
  assert.equal(report().controls[0].met, true);
  // A file of crosses is no use to lines.
  await hand.editing(() => page.click('[aria-label=Symmetry] [data-value="2"]'));
  assert.equal(hand.design().guidance.field, 'smoothest');
  await hand.editing(() => page.keyboard.press('Control+z'));
  assert.equal(hand.design().guidance.file, guidance.file);
}));

test('what a design stays close to, how closely, and where: every key is within reach', () => on('guide', () => ({ n: 2, guidance: { field: 'smoothest' } }), async (page, hand, { place, report }) => {
  await hand.drop('wedge', 30, 20);
  for (const field of ['least-curvature', 'strongest-curvature', 'zero', 'smoothest']) {
    await hand.editing(() => page.click(`[aria-label=Elsewhere] [data-value=${field}]`));
    assert.equal(hand.design().guidance.field, field);
  }
  await page.click('.guidance summary');
  await hand.editing(async () => {
    await page.fill('[aria-label="t instead of Hold"]', '-3');
    await page.keyboard.press('Enter');
  });
  assert.deepEqual(hand.design().guidance, { field: 'smoothest', t: -3 });
  assert.equal(await page.isVisible('[aria-label=Hold]'), false);
  assert.equal(report().certified, true);
  await hand.editing(async () => {
    await page.fill('[aria-label="t instead of Hold"]', '');
    await page.keyboard.press('Enter');
  });
  assert.equal(hand.design().guidance.t, undefined);
  await load(page, hand, 'Weights at vertices…', place, Array.from({ length: 642 }, (_, v) => 1 + (v % 3)));
  assert.equal(hand.design().guidance.weights.length, 642);
  assert.match(await page.textContent('.guidance'), /642 weights, 1 to 3/);
  await hand.editing(() => page.click('.guidance .row .plain'));
  assert.equal(hand.design().guidance.weights, undefined);
  // Too few of them: said in words, and nothing changes.
  const text = readFileSync(hand.server.design, 'utf8');
  writeFileSync(join(place, 'few.json'), '[1, 2]');
  await page.setInputFiles('.panel input[type=file][aria-label="Weights at vertices…"]', join(place, 'few.json'));
  await page.waitForFunction(() => /weights/.test(document.querySelector('.chip').textContent));
  assert.equal(readFileSync(hand.server.design, 'utf8'), text);
  assert.equal(page.complaints.splice(0).length, 1);  // of the request that was refused
  await page.fill('[aria-label=Comment]', 'mine');
  await hand.editing(() => page.keyboard.press('Enter'));
  assert.equal(hand.design().comment, 'mine');
  // The zero here, or anywhere in the face.
  await page.click('.controls .name');
  await hand.editing(() => page.click('.numbers .toggle'));
  assert.equal(hand.design().singularities[0].pin, undefined);
  await hand.editing(() => page.click('.numbers .toggle'));
  assert.equal(hand.design().singularities[0].pin.length, 3);
}));

test('the details of connections, and one of your own to be near to', () => on('near', () => ({ n: 4, guidance: { field: 'smoothest' } }), async (page, hand, { place, report }) => {
  await hand.editing(() => page.click('[aria-label=Connection] [data-value=polar]'));
  await hand.editing(() => page.click('[data-value=polar-barycenter]'));
  assert.equal(hand.design().connection.kind, 'polar-barycenter');
  assert.equal(await page.getAttribute('[aria-label=Connection] [data-value=polar]', 'aria-checked'), 'true');
  await hand.editing(() => page.click('[aria-label=Connection] [data-value=global]'));
  await page.click('text=Weights of the deviation');
  await hand.editing(() => page.click('[data-value=per_edge]'));
  await slide(page, hand, 'Tan cap', 'ArrowRight');
  const { connection } = hand.design();
  assert.equal(connection.length_factor, 'per_edge');
  assert.ok(connection.tan_cap > 10);
  // The curvature of a ball, spread evenly over its vertices.
  await page.click('[aria-label=Connection] [data-value=metric]');
  await page.waitForFunction(() => alcap.design.connection.kind === 'metric' && !alcap.store.busy);
  await load(page, hand, 'Load a target connection…', place, { target: { vertex_curvature: Array.from({ length: 642 }, () => (4 * Math.PI) / 642) } });
  assert.equal(hand.design().connection.target.vertex_curvature.length, 642);
  assert.match(await page.textContent('.target'), /Target: 642 vertex curvatures/);
  assert.equal((await hand.state()).meta.problem, '');
  await hand.editing(() => page.click('.target .toggle'));
  assert.equal(hand.design().connection.spread, false);
  await hand.drop('source', 30, 20);
  assert.equal(hand.design().connection.target.vertex_curvature.length, 642);
  assert.equal(report().certified, true);
  await page.click('.target .row .plain');
  await page.waitForFunction(() => !alcap.design.connection.target && !alcap.store.busy);
  assert.equal(hand.design().connection.target, undefined);
}));

test('fields of any symmetry: a design of n = 3 is shown as such', () => on('three', () => ({ n: 3, guidance: { field: 'smoothest' } }), async (page, hand) => {
  assert.equal(await page.textContent('[aria-label=Symmetry] [aria-checked=true]'), '3');
  await hand.drop('source', 20, 10);
  assert.equal(hand.design().n, 3);
  await hand.editing(() => page.click('[aria-label=Symmetry] [data-value="2"]'));
  assert.equal(hand.design().n, 2);
  assert.equal(await page.isVisible('[aria-label=Symmetry] [data-value="3"]'), false);
}));

test('a clicked face says its number and is outlined', () => on('face', () => ({ n: 4, guidance: { field: 'smoothest' } }), async (page, hand) => {
  const [x, y] = await hand.middle();
  await page.mouse.click(x + 25, y + 10);
  const face = Number(/Face ([\d,]+)/.exec(await page.textContent('.card'))[1].replace(',', ''));
  const { arrays: { positions: P, faces: F } } = unpack((await request(hand.server.url, '/api/mesh')).body);
  const corners = [0, 1, 2].map((j) => [0, 1, 2].map((c) => P[3 * F[3 * face + j] + c]));
  const middles = corners.map((p, j) => p.map((v, c) => (v + corners[(j + 1) % 3][c]) / 2)).map((p) => [...p, ...p]);
  assert.deepEqual(await drawnAt(page, middles, [15, 118, 110]), [true, true, true]);
  await page.click('.card .close');
  assert.equal(await page.evaluate(() => alcap.view.picked.total), 0);
}));
