// SPDX-License-Identifier: MIT
//
// controls.test.mjs: what the studio's panel asks for: directions held at vertices, zeros side by side, the boundary,
// connections with cones and turns around loops of any size. Every step by the design that is saved, and by what the
// command line makes of it.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { alcap, drawnAt, folder, Hand, judged, launch, open, request, studio, unpack } from './browser.mjs';

let browser, place;
before(async () => {
  place = folder();
  browser = await launch();
});
after(async () => { await browser?.close(); });

/** A studio on a generated shape, with a page of its own. */
async function on(shape, name, act, design = { alcap_design: 1, n: 4, guidance: { field: 'smoothest' } }) {
  const mesh = join(place, `${name}.ply`);
  alcap('make', shape, '-o', mesh, '-q');
  const server = await studio(mesh);
  try {
    const { status } = await request(server.url, '/api/edit', {}, { method: 'POST', body: JSON.stringify(design) });
    assert.equal(status, 200);
    const page = await open(browser, server.url);
    const hand = new Hand(page, server);
    await hand.settled();
    await act(page, hand, () => judged(mesh, server.design));
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  } finally {
    await server.kill();
  }
}

const apart = (a, b, period) => Math.abs(((((a - b) % period) + 1.5 * period) % period) - period / 2);

/** A slider of the panel by its keys. */
async function slide(page, hand, label, keys) {
  await page.focus(`.panel input[aria-label="${label}"]`);
  for (const key of keys) await hand.editing(() => page.keyboard.press(key));
}

test('a direction is held where one clicks, turned, moved, and removed', () => on('icosphere:3', 'ball', async (page, hand, report) => {
  const [x, y] = await hand.middle();
  await page.click('.toolbox [data-value=direction]');
  await hand.editing(() => page.mouse.click(x + 20, y - 10));
  const [first] = hand.design().fixed;
  assert.ok(Number.isInteger(first.vertex) && Math.abs(Math.hypot(...first.direction) - 1) < 1e-6);
  assert.equal(await page.getAttribute('.ring.square', 'aria-label'), `direction at vertex ${first.vertex}`);
  // The smoothest field has it already.
  assert.equal(report().controls[0].met, true);
  // Nine steps of the knob are 45 degrees, and the field follows.
  await page.focus('.knob');
  for (let k = 0; k < 8; ++k) await page.keyboard.press('ArrowLeft');
  await hand.editing(() => page.keyboard.press('ArrowLeft'));
  const [turned] = hand.design().fixed;
  const cosine = turned.direction.reduce((sum, c, k) => sum + c * first.direction[k], 0);
  assert.ok(apart((Math.acos(cosine) * 180) / Math.PI, 45, 360) < 0.01, `turned by ${Math.acos(cosine)}`);
  const { meta, arrays } = await hand.state();
  assert.equal(meta.controls[0].path, '/fixed/0');
  assert.equal(meta.controls[0].met, true);
  const surface = unpack((await request(hand.server.url, '/api/mesh')).body);
  const normal = [0, 1, 2].map((c) => surface.arrays.positions[3 * turned.vertex + c]);
  const branch = [0, 1, 2].map((c) => arrays.branch[3 * turned.vertex + c]);
  const cross = [0, 1, 2].map((c) => branch[(c + 1) % 3] * turned.direction[(c + 2) % 3] - branch[(c + 2) % 3] * turned.direction[(c + 1) % 3]);
  const angle = Math.atan2(cross.reduce((sum, c, k) => sum + c * normal[k], 0) / Math.hypot(...normal), branch.reduce((sum, c, k) => sum + c * turned.direction[k], 0));
  assert.ok(apart((angle * 180) / Math.PI, 0, 90) < 1.5, `off by ${angle}`);  // the tangent plane there is not that of the face
  // Its length is free on request.
  await hand.editing(() => page.click('.controls .toggle'));
  assert.equal(hand.design().fixed[0].length, 'free');
  await hand.editing(() => page.click('.controls .toggle'));
  assert.equal(hand.design().fixed[0].length, undefined);
  // Arrow keys move it to other vertices.
  await page.focus('.ring.square');
  await hand.editing(() => page.keyboard.press('ArrowRight'));
  assert.notEqual(hand.design().fixed[0].vertex, turned.vertex);
  assert.equal(report().controls[0].met, true);
  await hand.editing(() => page.keyboard.press('Delete'));
  assert.deepEqual(hand.design().fixed || [], []);
  assert.equal(await page.locator('.ring').count(), 0);
}));

test('directions are mirrored, and eigen designs hold them', () => on('icosphere:3', 'ball2', async (page, hand, report) => {
  await page.waitForSelector('[aria-label=Mirror]', { state: 'visible' });
  await page.click('[aria-label=Mirror] [data-value="0"]');
  const [x, y] = await hand.middle();
  await page.click('.toolbox [data-value=direction]');
  await hand.editing(() => page.mouse.click(x + 60, y + 20));
  const { fixed } = hand.design();
  assert.equal(fixed.length, 2);
  const P = unpack((await request(hand.server.url, '/api/mesh')).body).arrays.positions;
  const point = (f) => [0, 1, 2].map((c) => P[3 * f.vertex + c]);
  const [a, b] = fixed.map(point);
  assert.ok(Math.hypot(a[0] + b[0], a[1] - b[1], a[2] - b[2]) < 0.05);
  await hand.editing(() => page.click('[data-value=eigen]'));
  assert.equal(hand.design().method, 'eigen');
  assert.ok(report().controls.every((c) => c.met));
  await hand.editing(() => page.keyboard.press('Delete'));
  assert.deepEqual(hand.design().fixed || [], []);
}));

test('strokes are mirrored: drawn, bent, weighed, erased, removed', () => on('icosphere:3', 'ball5', async (page, hand) => {
  await page.waitForSelector('[aria-label=Mirror]', { state: 'visible' });
  await page.click('[aria-label=Mirror] [data-value="0"]');
  const { arrays: { positions: P, faces: F } } = unpack((await request(hand.server.url, '/api/mesh')).body);
  const place = ({ face, barycentric }) => [0, 1, 2].map((c) => barycentric.reduce((sum, b, j) => sum + b * P[3 * F[3 * face + j] + c], 0));
  /** The two strokes are images of each other, point by point, on both sides of x = 0. */
  const mirrored = () => {
    const { strokes } = hand.design();
    assert.equal(strokes.length, 2);
    const [a, b] = strokes.map((s) => s.points.map(place));
    assert.equal(a.length, b.length);
    const off = Math.max(...a.map(([x, y, z], k) => Math.hypot(x + b[k][0], y - b[k][1], z - b[k][2])));
    assert.ok(off < 0.03, `${off}`);
    return strokes;
  };
  await hand.brush([90, -60], [110, 40]);
  const drawn = mirrored();
  const sides = drawn.map((s) => s.points.map((p) => Math.sign(place(p)[0])));
  assert.ok(sides[0].some((x, k) => x === -sides[1][k]), 'they are apart');
  await page.click('.controls .name >> nth=0');
  await hand.editing(() => page.locator('.controls .slider input[aria-label=Weight]').press('End'));
  assert.deepEqual(mirrored().map((s) => s.weight), [1000, 1000]);
  await page.locator('.bead >> nth=1').focus();
  await hand.editing(() => page.keyboard.press('ArrowLeft'));
  const bent = mirrored();
  assert.notDeepEqual(bent[0].points, drawn[0].points);
  assert.notDeepEqual(bent[1].points, drawn[1].points);
  await page.evaluate(() => alcap.select(-1));  // its beads are no longer above it
  await page.click('.toolbox [data-value=erase]');
  const end = await page.evaluate((p) => {
    const box = alcap.stage.canvas.getBoundingClientRect(), [x, y] = alcap.handles.project(alcap.view.surface.at(p.face, p.barycentric));
    return [box.left + x, box.top + y];
  }, bent[0].points.at(-1));
  await hand.editing(() => hand.drag(end, end));
  const left = mirrored();
  assert.ok(left[0].points.length < bent[0].points.length && left[0].points.length > 1, `${left[0].points.length}`);
  await page.click('.toolbox [data-value=turn]');
  await page.click('.controls .name >> nth=1');
  await page.focus('#canvas');
  await hand.editing(() => page.keyboard.press('Delete'));
  assert.deepEqual(hand.design().strokes || [], []);
}));

test('less detail: a connection that ignores small bumps, and a field with fewer singularities', () => on('scan:3,0.3', 'scan', async (page, hand, report) => {
  const before = report().singularities.count;
  await slide(page, hand, 'Detail', ['Home']);
  assert.equal(hand.design().connection.detail, 0.01);
  assert.ok(report().singularities.count < before);
  assert.equal((await hand.state()).arrays.singular_faces.length, report().singularities.count);
}));

test('zeros side by side: a slider says how many, and the field has them', () => on('icosphere:4', 'ball3', async (page, hand, report) => {
  await hand.drop('saddle');
  await slide(page, hand, 'Zeros', ['ArrowRight']);
  assert.equal(hand.design().singularities[0].count, 2);
  assert.match(await page.textContent('.controls .name'), /^Saddle × 2/);
  const [control] = report().controls;
  assert.equal(control.met, true);
  assert.equal((await hand.state()).meta.controls[0].met, true);
  // Wedges are single: two of them are a source of index 2/2.
  await hand.editing(() => page.click('[aria-label=Symmetry] [data-value="2"]'));
  assert.deepEqual([hand.design().singularities[0].kind, hand.design().singularities[0].count], ['saddle', 2]);
  await slide(page, hand, 'Zeros', ['ArrowLeft']);
  assert.deepEqual([hand.design().singularities[0].kind, hand.design().singularities[0].count], ['trisector', undefined]);
}));

test('the boundary: along it or across it, as heavily as one says, by either method', () => on('disk:12', 'plate', async (page, hand, report) => {
  await hand.editing(() => page.click('[aria-label=Symmetry] [data-value="2"]'));
  await hand.editing(() => page.click('[aria-label=Boundary] [data-value=tangent]'));
  await slide(page, hand, 'Weight', ['ArrowRight', 'ArrowRight']);
  const { boundary } = hand.design();
  assert.equal(boundary.align, 'tangent');
  assert.ok(boundary.weight > 1);
  assert.ok(report().controls.find((c) => c.path === '/boundary').met);
  assert.match(await page.textContent('.boundary p'), /Followed to [\d.]+°/);
  await hand.editing(() => page.click('[data-value=eigen]'));
  assert.deepEqual(hand.design().boundary, boundary);
  assert.ok(report().controls.find((c) => c.path === '/boundary').met);
  await hand.editing(() => page.click('[aria-label=Boundary] [data-value=normal]'));
  assert.equal(hand.design().boundary.align, 'normal');
  assert.ok(report().controls.find((c) => c.path === '/boundary').met);
  await hand.editing(() => page.click('[aria-label=Boundary] [data-value=none]'));
  assert.equal(hand.design().boundary, undefined);
}));

test('turns around handles: shown, drawn, set by typing, and left to the program again', () => on('torus:40,20', 'ring', async (page, hand, report) => {
  await hand.editing(() => page.click('[aria-label=Connection] [data-value=trivial]'));
  const own = (await hand.state()).meta.holonomy;
  assert.equal(own.length, 2);
  assert.equal(await page.locator('.cones input[type=number]').count(), 2);
  // The loops are drawn, in the colour of the controls.
  const { loops, loop_offsets: offsets } = unpack((await request(hand.server.url, '/api/mesh')).body).arrays;
  assert.equal(offsets.length, 3);
  assert.deepEqual(loops.slice(0, 3), loops.slice(3 * offsets[1] - 3, 3 * offsets[1]));
  assert.equal(await page.evaluate(() => alcap.loops.object.visible && alcap.loops.total), offsets.at(-1) - 2);
  const box = await page.evaluate(() => getComputedStyle(document.documentElement).getPropertyValue('--accent').trim());
  const colour = box.match(/[\da-f]{2}/gi).map((x) => parseInt(x, 16));
  const points = [];
  for (let k = 0; k + 3 <= loops.length; k += 3) {
    // Outwards from the circle in the middle of the tube.
    const [x, y, z] = loops.slice(k, k + 3), around = Math.hypot(x, y);
    points.push([x, y, z, x - x / around, y - y / around, z]);
  }
  const seen = await drawnAt(page, points, colour);
  assert.ok(seen.length > 3 && seen.filter(Boolean).length >= 0.5 * seen.length, `${seen.filter(Boolean).length} of ${seen.length}`);
  await hand.editing(async () => {
    await page.fill('.cones [aria-label="Loop 1"]', '0.25');
    await page.keyboard.press('Enter');
  });
  assert.equal(hand.design().connection.holonomy[0], 0.25);
  assert.equal((await hand.state()).meta.problem, '');
  assert.equal((await hand.state()).meta.holonomy[0], 0.25);
  assert.equal(report().ok, true);
  await hand.editing(() => page.click('text=Choose them for me'));
  assert.equal(hand.design().connection.holonomy, undefined);
  assert.deepEqual((await hand.state()).meta.holonomy, own);
}));

test('metric connections: cones of any size, typed; a sum says what is missing', () => on('icosphere:3', 'ball4', async (page, hand, report) => {
  await page.click('[aria-label=Connection] [data-value=metric]');
  await page.waitForFunction(() => /Place \+2 more/.test(document.querySelector('.cones').textContent));
  const [x, y] = await hand.middle();
  await page.keyboard.press('k');
  await page.mouse.click(x - 40, y);
  await page.waitForFunction(() => alcap.design.connection.cones?.length === 1);
  await page.keyboard.press('k');
  await page.mouse.click(x + 40, y);
  await page.waitForFunction(() => alcap.design.connection.cones?.length === 2);
  for (const [k, size] of [[0, '0.7'], [1, '1.3']]) {
    await page.locator('.cones input[type=number]').nth(k).fill(size);
    await page.keyboard.press('Enter');
    await page.waitForFunction(({ k, size }) => alcap.design.connection.cones[k].index === Number(size), { k, size });
  }
  await page.waitForFunction(() => /of 2 needed2 ✓/.test(document.querySelector('.cones').textContent));
  await hand.settled();
  assert.equal((await hand.state()).meta.problem, '');
  assert.deepEqual(hand.design().connection.cones.map((c) => c.index), [0.7, 1.3]);
  assert.equal(hand.design().connection.kind, 'metric');
  assert.equal(report().ok, true);
  // Of the kind that n-fields can be parallel to, sizes are multiples of 1/n.
  await page.click('[aria-label=Connection] [data-value=trivial]');
  await page.waitForFunction(() => alcap.design.connection.kind === 'trivial');
  assert.deepEqual(await page.evaluate(() => alcap.design.connection.cones.map((c) => c.index)), [0.75, 1.25]);
}));

test('what is typed stays under the hand while edits arrive; what is no number changes nothing', () => on('icosphere:3', 'ball5', async (page, hand) => {
  const cones = [{ vertex: 0, index: 0.5 }, { vertex: 12, index: 1.5 }];
  const elsewhere = async (more) => {  // an edit by somebody else, until the page shows it
    const { status } = await request(hand.server.url, '/api/edit', {}, { method: 'POST', body: JSON.stringify({ ...hand.design(), ...more }) });
    assert.equal(status, 200);
    await hand.settled();
  };
  await elsewhere({ connection: { kind: 'metric', cones } });
  const input = page.locator('.cones input[type=number]').first(), indices = () => hand.design().connection.cones.map((c) => c.index);
  // Between the press that selects the number and the first digit, and between two digits.
  await input.focus();
  await page.keyboard.press('Control+a');
  await elsewhere({ comment: 'one' });
  await page.keyboard.type('0.');
  await elsewhere({ comment: 'two' });
  await page.keyboard.type('7');
  await hand.editing(() => page.keyboard.press('Enter'));
  assert.deepEqual(indices(), [0.7, 1.5]);
  for (const text of ['', 'e', '-']) {
    await input.focus();
    await page.keyboard.press('Control+a');
    await page.keyboard.press('Delete');
    await page.keyboard.type(text);
    await page.keyboard.press('Enter');
    assert.equal(await input.inputValue(), '0.7');
  }
  await page.keyboard.press('Tab');
  await hand.settled();
  assert.deepEqual(indices(), [0.7, 1.5]);
  // A press on a button that edits arrive under is still a click.
  await elsewhere({ connection: { kind: 'trivial', cones } });
  const box = await page.locator('.cones .stepper button').last().boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await elsewhere({ comment: 'three' });
  await page.mouse.up();
  await page.waitForFunction(() => alcap.design.connection.cones[1].index === 1.75);
}));
