// SPDX-License-Identifier: MIT
//
// story.test.mjs: a design from the first click to the file, as docs/studio.md shows it. Every step is checked by the
// pixels of the canvas and by the saved design; the pictures go to the folder STORY, where that is given.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { test } from 'node:test';

import { alcap, drawnAt, folder, Hand, launch, open, studio, unpack, request } from './browser.mjs';

const orange = [213, 94, 0], teal = [15, 118, 110];

test('place a source, drag it, turn it, hold an automatic one, draw a stroke, weigh it, export', async () => {
  const place = folder(), mesh = join(place, 'pebble.ply');
  alcap('make', 'scan:4,0.1', '-o', mesh);
  const server = await studio(mesh), browser = await launch();
  try {
    const page = await open(browser, server.url, { viewport: { width: 1000, height: 660 } });
    const hand = new Hand(page, server);
    await hand.settled();
    const { arrays: { positions: P, faces: F } } = unpack((await request(server.url, '/api/mesh')).body);
    const inSpace = ({ face, pin, barycentric = pin }) => {
      const corners = [0, 1, 2].map((j) => [0, 1, 2].map((c) => P[3 * F[3 * face + j] + c]));
      const [a, b] = [1, 2].map((j) => corners[j].map((v, c) => v - corners[0][c]));
      const normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
      return [...[0, 1, 2].map((c) => barycentric.reduce((sum, w, j) => sum + w * corners[j][c], 0)), ...normal];
    };
    const show = async (name) => {
      if (process.env.STORY) await page.screenshot({ path: join(process.env.STORY, `studio-${name}.jpg`), type: 'jpeg', quality: 64 });
    };
    const ring = async () => {
      const box = await page.locator('.ring.chosen').boundingBox();
      return [box.x + box.width / 2, box.y + box.height / 2];
    };
    const placed = async () => {
      const [s] = hand.design().singularities;
      assert.deepEqual(await drawnAt(page, [inSpace(s)], orange), [true]);
      assert.equal((await hand.state()).meta.controls[0].met, true);
      return s;
    };

    await hand.drop('source', -50, 30);
    const first = await placed();
    await show('place');

    const [x, y] = await ring();
    await hand.editing(() => hand.drag([x, y], [x + 75, y - 60]));
    const moved = await placed();
    assert.notEqual(moved.face, first.face);

    const knob = await page.locator('.knob').boundingBox();
    const [cx, cy] = await ring();
    const [kx, ky] = [knob.x + knob.width / 2, knob.y + knob.height / 2];
    await hand.editing(() => hand.drag([kx, ky], [cx + (kx - cx) * 0.7 + (ky - cy) * 0.7, cy + (ky - cy) * 0.7 - (kx - cx) * 0.7]));
    const turned = await placed();
    assert.ok(Math.abs(((turned.angle - moved.angle + 540) % 360) - 180 - 45) < 5, `turned from ${moved.angle} to ${turned.angle}`);
    await show('turn');

    // One that the field has of its own, and that can be seen.
    const { arrays } = await hand.state();
    const spot = await page.evaluate(({ singular, faces, taken }) => {
      const { camera, canvas } = alcap.stage, box = canvas.getBoundingClientRect();
      for (let k = 0; k < faces.length; ++k) {
        const at = camera.position.clone().set(...singular.slice(8 * k, 8 * k + 3));
        const normal = camera.position.clone().set(...singular.slice(8 * k + 3, 8 * k + 6));
        if (taken.includes(faces[k]) || Math.abs(singular[8 * k + 6]) !== 1) continue;
        if (normal.dot(camera.position.clone().sub(at).normalize()) < 0.5) continue;
        const p = at.project(camera);
        return { face: faces[k], x: box.left + ((p.x + 1) / 2) * box.width, y: box.top + ((1 - p.y) / 2) * box.height };
      }
      return null;
    }, { singular: arrays.singular, faces: arrays.singular_faces, taken: [turned.face] });
    assert.ok(spot);
    await page.mouse.click(spot.x, spot.y);
    await page.waitForSelector('.card .primary');
    await show('hold');
    await hand.editing(() => page.click('.card .primary'));
    assert.equal(hand.design().singularities[1].face, spot.face);

    await hand.brush([-120, 95], [-50, 110], [50, 95]);
    const points = hand.design().strokes[0].points;
    const seen = await drawnAt(page, points.slice(1, -1).map(inSpace), teal);
    assert.ok(seen.length > 10 && seen.filter((s) => s).length > 0.9 * seen.length, `${seen}`);
    await page.click('.controls .name:has(.stroke)');
    await hand.editing(() => page.locator('.slider input[aria-label=Weight]').press('End'));
    assert.equal(hand.design().strokes[0].weight, 1000);
    await show('stroke');

    await page.click('nav [title="Save the field for another program"]');
    const saved = page.waitForEvent('download');
    await page.click('.exports a >> nth=0');
    assert.equal((await saved).suggestedFilename(), 'pebble.field.ply');
    assert.deepEqual(page.complaints, []);
  } finally {
    await browser.close();
    await server.kill();
  }
});
