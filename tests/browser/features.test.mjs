// SPDX-License-Identifier: MIT
//
// features.test.mjs: what the studio's panel says about sharp edges: followed or held, along or across, with the boundary,
// joined, bridged and trimmed. Every step by the saved design and by the command line's report on it.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { folder, Hand, judged, launch, open, studio } from './browser.mjs';

let browser;
before(async () => { browser = await launch(); });
after(async () => { await browser?.close(); });

const columns = 2, across = 2 * columns + 1;  // vertices

/** A sheet of squares cut in two, folded along its middle by so many degrees at every row of vertices, as OBJ. */
function sheet(folds) {
  const vertices = folds.flatMap((fold, i) => Array.from({ length: across }, (_, j) => {
    const x = 0.15 * (j / columns - 1);
    return `v ${x} ${0.3 * i} ${-Math.abs(x) * Math.tan((fold * Math.PI) / 360)}`;
  }));
  const faces = [];
  for (let i = 0; i + 1 < folds.length; ++i) {
    for (let j = 0; j + 1 < across; ++j) {
      const a = i * across + j + 1;
      faces.push(`f ${a} ${a + 1} ${a + across + 1}`, `f ${a} ${a + across + 1} ${a + across}`);
    }
  }
  return [...vertices, ...faces, ''].join('\n');
}

/** Three sharp stretches, with a short and a long one between them where the fold fades away and comes back. */
const folds = [60, 60, 60, 60, 60, 45, 30, 15, 4, 15, 30, 45, 60, 60, 60, 60, 45, 30, 15, 4, 4, 4, 15, 30, 45, 60, 60, 60, 45, 30, 15];

async function on(design, act) {
  const place = folder(), mesh = join(place, 'sheet.obj'), file = join(place, 'a.design.json');
  writeFileSync(mesh, sheet(folds));
  writeFileSync(file, JSON.stringify({ alcap_design: 1, guidance: { field: 'smoothest' }, ...design }));
  const server = await studio(mesh, '--design', file);
  try {
    const page = await open(browser, server.url), hand = new Hand(page, server);
    await page.evaluate(() => alcap.view.set('lines', 'none'));
    await hand.settled();
    await act(page, hand, {
      features: () => hand.design().features,
      /** The command line on the saved design: it finds the same lines. */
      async alignment() {
        const { alignment } = judged(mesh, server.design);
        assert.equal(alignment.lines.length, (await hand.state()).arrays.crease_offsets.length - 1);
        return alignment;
      },
      said: () => page.textContent('.features p'),
      type: (label, text) => hand.editing(async () => {
        await page.fill(`.features [aria-label="${label}"]`, text);
        await page.keyboard.press('Enter');
      }),
      choose: (value) => hand.editing(() => page.click(`.features [data-value=${value}]`)),
    });
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  } finally {
    await server.kill();
  }
}

test('creases are followed or held exactly, along or across', () => on({ n: 2 }, async (page, hand, { features, alignment, said, choose }) => {
  await hand.editing(() => page.click('.features .toggle'));
  assert.deepEqual(features(), { angle: 40 });
  const drawn = await alignment();
  assert.deepEqual([drawn.hold, drawn.lines.length], [false, 3]);
  assert.match(await said(), /^3 lines, followed to [\d.e−]+°$/);
  await choose('hold');
  assert.deepEqual(features(), { angle: 40, hold: true });
  const held = await alignment();
  assert.equal(held.hold, true);
  assert.ok(held.all.worst_degrees < 0.5, `${held.all.worst_degrees}`);
  assert.match(await said(), /^3 lines, held to [\d.e−]+°$/);
  await choose('across');
  assert.deepEqual(features(), { angle: 40, hold: true, across: true });
  assert.ok((await alignment()).all.worst_degrees < 0.5);
  // The field itself: at every vertex of the lines it runs across them.
  const { arrays: { creases, branch } } = await hand.state();
  for (const v of creases) assert.ok(Math.abs(branch[3 * v + 1]) < 0.02 * Math.hypot(...branch.slice(3 * v, 3 * v + 3)), `vertex ${v}`);
  await choose('along');
  await choose('follow');
  assert.deepEqual(features(), { angle: 40 });
  // Of crosses both are one; a choice that the design has is shown.
  await hand.editing(() => page.click('[aria-label=Symmetry] [data-value="4"]'));
  assert.equal(await page.isVisible('.features [data-value=across]'), false);
}));

test('more options: joined from an angle on, gaps closed, spurs left out, with the boundary', () => on({ n: 4, features: { angle: 40 } }, async (page, hand, { features, alignment, said, type }) => {
  await page.click('.features summary');
  const { edges } = await alignment();
  await type('Join from °', '18');
  assert.deepEqual(features(), { angle: 40, low_angle: 18 });
  const joined = await alignment();
  assert.ok(joined.edges > edges, `${joined.edges} of ${edges}`);
  await type('Gap', '0.8');
  assert.deepEqual(features(), { angle: 40, low_angle: 18, gap: 0.8 });
  assert.equal((await alignment()).lines.length, 2);
  await type('Spur', '4');
  assert.deepEqual(features(), { angle: 40, low_angle: 18, gap: 0.8, spur: 4 });
  assert.equal((await alignment()).lines.length, 1);
  assert.match(await said(), /^1 line, /);
  await type('Spur', '10');
  assert.equal((await alignment()).lines.length, 0);
  assert.equal(await said(), 'No line is left.');
  for (const label of ['Spur', 'Gap']) await type(label, '');
  assert.deepEqual(features(), { angle: 40, low_angle: 18 });
  await hand.editing(() => page.click('.features .more .toggle'));
  assert.deepEqual(features(), { angle: 40, low_angle: 18, boundary: true });
  assert.equal((await alignment()).edges, joined.edges + 2 * (folds.length - 1) + 4 * columns);
  await type('Corner from °', '100');
  assert.equal(features().corner_angle, 100);
  // The lower angle is never above the other.
  await hand.editing(() => page.locator('.features input[aria-label=Angle]').press('Home'));
  assert.deepEqual([features().angle, features().low_angle], [1, 1]);
  await type('Join from °', '');
  assert.deepEqual(features(), { angle: 1, boundary: true, corner_angle: 100 });
}));

test('edges that a design names stay as they are, and what has no meaning for them is not offered', () => {
  const edges = Array.from({ length: 5 }, (_, i) => [3 + across * i, 3 + across * (i + 1)]);
  return on({ n: 2, features: { edges, weight: 3 } }, async (page, hand, { features, alignment, said, choose }) => {
    assert.equal((await alignment()).edges, 5);
    assert.match(await said(), /^1 line of 5 named edges, followed to/);
    await page.click('.features summary');
    for (const label of ['Angle', 'Join from °']) assert.equal(await page.isVisible(`.features [aria-label="${label}"]`), false, label);
    assert.equal(await page.isVisible('.features .more .toggle'), false);
    await choose('hold');
    assert.deepEqual(features(), { edges, weight: 3, hold: true });
    assert.ok((await alignment()).all.worst_degrees < 0.5);
  });
});
