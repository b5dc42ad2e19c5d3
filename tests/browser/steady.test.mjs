// SPDX-License-Identifier: MIT
//
// steady.test.mjs: what is under the hand stays there while edits of another tab arrive: a press that began before one ends
// after it, the keyboard stays where it is, and numbers are those of the design.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { alcap, folder, Hand, launch, open, request, studio } from './browser.mjs';

let browser, mesh;
before(async () => {
  mesh = join(folder(), 'ball.ply');
  alcap('make', 'icosphere:3', '-o', mesh, '-q');
  browser = await launch();
});
after(async () => { await browser?.close(); });

const strokes = [[10, 40], [100, 140], [200, 260]].map((vertices, k) => ({ name: `stroke ${'abc'[k]}`, vertices }));
const base = { alcap_design: 1, n: 4, guidance: { field: 'smoothest' } };

async function on(design, act) {
  const server = await studio(mesh, '--design', join(folder(), 'a.json'));
  try {
    const page = await open(browser, server.url), hand = new Hand(page, server);
    await page.evaluate(() => alcap.view.set('lines', 'none'));
    /** An edit by another tab, until this page shows it. */
    const elsewhere = async (next) => {
      const { status } = await request(server.url, '/api/edit', {}, { method: 'POST', body: JSON.stringify(next) });
      assert.equal(status, 200);
      await hand.settled();
    };
    await elsewhere(design);
    /** Presses, waits for what happens meanwhile, releases. */
    const pressed = async (target, meanwhile) => {
      const box = await target.boundingBox(), middle = [box.x + box.width / 2, box.y + box.height / 2];
      await page.mouse.move(...middle);
      await page.mouse.down();
      await meanwhile();
      await page.mouse.up();
    };
    await act(page, hand, { elsewhere, pressed });
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  } finally {
    await server.kill();
  }
}

const row = (page, name) => page.locator('.controls li', { hasText: name });

test('a press in the list of controls is of the control that it began on', () => on({ ...base, strokes }, async (page, hand, { elsewhere, pressed }) => {
  // Another one is there instead of the first stroke: the pressed one has another number now.
  const singularities = [{ face: 3, kind: 'saddle' }];
  await pressed(row(page, 'Stroke b').locator('.name'), () => elsewhere({ ...base, singularities, strokes: [strokes[1], { ...strokes[2], weight: 3 }] }));
  await page.waitForFunction(() => alcap.stroked === 0);
  assert.match(await page.textContent('.controls li.chosen'), /^Stroke b/);
  // One that is removed is the one that was pressed.
  await hand.editing(() => pressed(row(page, 'Stroke c').locator('.close'), () => elsewhere({ ...base, strokes: [strokes[0], strokes[1], { ...strokes[2], weight: 3 }] })));
  assert.deepEqual(hand.design().strokes.map((s) => s.name), ['stroke a', 'stroke b']);
}));

test('the keyboard stays on its button, and a slider shows the number of the design', () => on({ ...base, strokes }, async (page, hand, { elsewhere }) => {
  await row(page, 'Stroke b').locator('.name').click();
  await row(page, 'Stroke c').locator('.close').focus();
  await elsewhere({ ...base, strokes: [strokes[0], { ...strokes[1], weight: 20 }, strokes[2]], singularities: [{ face: 3, kind: 'saddle' }] });
  assert.equal(await page.evaluate(() => document.activeElement.getAttribute('aria-label')), 'Remove Stroke c');
  const weight = page.locator('.controls .slider', { hasText: 'Weight' });
  assert.equal(await weight.locator('output').textContent(), '20');
  await hand.editing(() => weight.locator('input').press('End'));
  assert.equal(await weight.locator('output').textContent(), '1000');
  await page.focus('#canvas');
  await hand.editing(() => page.keyboard.press('Control+z'));
  assert.equal(await weight.locator('output').textContent(), '20');
  assert.ok(Math.abs(Number(await weight.locator('input').inputValue()) - Math.log10(20)) < 0.02);
}));

test('a press on a tool, a colour or a symmetry outlives an edit that offers others', () => on(base, async (page, hand, { elsewhere, pressed }) => {
  await pressed(page.locator('.toolbox [data-value=saddle]'), () => elsewhere({ ...base, n: 6, connection: { kind: 'metric', cones: [{ vertex: 0, index: 2 }] } }));
  assert.equal(await page.evaluate(() => alcap.tool), 'saddle');
  assert.equal(await page.isVisible('.toolbox [data-value=cone]'), true);
  // A tool that is no longer offered is put away.
  await page.click('.toolbox [data-value=cone]');
  await elsewhere({ ...base, n: 2 });
  assert.equal(await page.evaluate(() => alcap.tool), 'turn');
  assert.deepEqual(await page.locator('.toolbox button').allTextContents(), ['Turn', 'Wedge', 'Trisector', 'Direction', 'Brush', 'Eraser']);
  const chip = page.locator('[aria-label="Colour by"] [data-value=dbar]');
  await chip.scrollIntoViewIfNeeded();
  await pressed(chip, () => elsewhere({ ...base, n: 4 }));
  assert.equal(await page.evaluate(() => alcap.view.state.color), 'dbar');
  assert.equal(await chip.getAttribute('aria-checked'), 'true');
}));

test('a ring that is dragged, and what is chosen, stay the same control when others before it go', () => on({ ...base, singularities: [{ face: 3, kind: 'saddle' }] }, async (page, hand, { elsewhere }) => {
  await hand.drop('source', 20, 30);
  const [first, second] = hand.design().singularities, box = await page.locator('.ring.chosen').boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 10, y);
  await hand.settled();
  const dragged = hand.design().singularities[1];
  assert.equal(dragged.kind, 'source');
  await elsewhere({ ...hand.design(), singularities: [dragged] });
  assert.equal(await page.evaluate(() => alcap.selected), 0);
  await hand.editing(async () => {
    await page.mouse.move(x + 60, y - 40);
    await page.mouse.up();
  });
  const [moved, ...more] = hand.design().singularities;
  assert.deepEqual([moved.kind, more.length], ['source', 0]);
  assert.notEqual(moved.face, dragged.face);
  const spot = await page.evaluate((s) => alcap.handles.project(alcap.handles.center(s)), moved);
  assert.ok(Math.hypot(spot[0] - x - 60, spot[1] - y + 40) < 15, `${spot}`);
  // The Delete key takes what was chosen.
  await elsewhere({ ...hand.design(), singularities: [first, moved] });
  assert.equal(await page.evaluate(() => alcap.selected), 1);
  await page.focus('#canvas');
  await hand.editing(() => page.keyboard.press('Delete'));
  assert.deepEqual(hand.design().singularities.map((s) => s.kind), ['saddle']);
  // One that is gone is no longer chosen.
  await page.click('.controls .name');
  await elsewhere({ ...base, singularities: [second, moved] });
  assert.equal(await page.evaluate(() => alcap.selected), -1);
}));

test('a card holds the singularity that it told of, whatever its number is by now', () => on(base, async (page, hand, { elsewhere, pressed }) => {
  const last = await page.evaluate(() => alcap.view.arrays.singular_faces.length - 1), { face, place } = await page.evaluate((k) => alcap.card.seen(k), last);
  await page.evaluate((k) => alcap.card.tell(k), last);
  await hand.editing(() => pressed(page.locator('.card .primary'), () => elsewhere({ ...base, singularities: [{ face: 3, kind: 'saddle', strength: 5 }, { face: 600, kind: 'saddle', strength: 5 }] })));
  const held = hand.design().singularities.at(-1);
  assert.deepEqual([hand.design().singularities.length, held.face, held.kind], [3, face, 'source']);
  const spot = await page.evaluate((s) => alcap.handles.center(s), held);
  assert.ok(Math.hypot(...spot.map((x, c) => x - place[c])) < 0.03);
}));
