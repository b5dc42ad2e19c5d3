// SPDX-License-Identifier: MIT
//
// story.test.mjs: a design from the first click to the file, as docs/studio.md shows it. Every step is checked by the
// pixels of the canvas and by the saved design; the pictures go to the folder STORY, where that is given.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';

import { alcap, drawnAt, folder, Hand, launch, open, studio, unpack, request } from './browser.mjs';

const orange = [213, 94, 0], teal = [15, 118, 110];

/** A closed box of squares cut in two, as OBJ: sharp edges all around. */
function box(sizes, step) {
  const number = sizes.map((s) => Math.round(s / step)), vertices = new Map(), faces = [];
  const vertex = (p) => {
    const key = p.join(' ');
    if (!vertices.has(key)) vertices.set(key, vertices.size + 1);
    return vertices.get(key);
  };
  for (let axis = 0; axis < 3; ++axis) {
    const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    for (const side of [0, number[axis]]) {
      for (let i = 0; i < number[u]; ++i) {
        for (let j = 0; j < number[v]; ++j) {
          const corner = (a, b) => {
            const p = [0, 0, 0];
            [p[axis], p[u], p[v]] = [side, i + a, j + b];
            return vertex(p);
          };
          const [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
          faces.push(...(side ? [[a, b, c], [a, c, d]] : [[a, c, b], [a, d, c]]));
        }
      }
    }
  }
  const lines = [...vertices.keys()].map((key) => `v ${key.split(' ').map((x, c) => (Number(x) - number[c] / 2) * step).join(' ')}`);
  return [...lines, ...faces.map((f) => `f ${f.join(' ')}`), ''].join('\n');
}

/** A studio on a mesh: a kind that `alcap make` knows, or the text of an OBJ file. */
async function story(kind, name, act) {
  const place = folder(), text = kind.startsWith('v '), mesh = join(place, `${name}.${text ? 'obj' : 'ply'}`);
  if (text) writeFileSync(mesh, kind);
  else alcap('make', kind, '-o', mesh);
  const server = await studio(mesh), browser = await launch();
  try {
    const page = await open(browser, server.url, { viewport: { width: 1000, height: 660 } });
    const hand = new Hand(page, server);
    await hand.settled();
    const { arrays: { positions: P, faces: F } } = unpack((await request(server.url, '/api/mesh')).body);
    const corners = (face) => [0, 1, 2].map((j) => [0, 1, 2].map((c) => P[3 * F[3 * face + j] + c]));
    const tools = {
      corners,
      /** Place and normal of a control. */
      inSpace({ face, pin, barycentric = pin }) {
        const three = corners(face);
        const [a, b] = [1, 2].map((j) => three[j].map((v, c) => v - three[0][c]));
        const normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        return [...[0, 1, 2].map((c) => barycentric.reduce((sum, w, j) => sum + w * three[j][c], 0)), ...normal];
      },
      async show(picture) {
        await page.mouse.move(5, 400);
        if (process.env.STORY) await page.screenshot({ path: join(process.env.STORY, `studio-${picture}.jpg`), type: 'jpeg', quality: 40 });
      },
      async middleOf(selector) {
        const box = await page.locator(selector).first().boundingBox();
        return [box.x + box.width / 2, box.y + box.height / 2];
      },
      async strokeIsDrawn(k) {
        const seen = await drawnAt(page, hand.design().strokes[k].points.slice(1, -1).map(tools.inSpace), teal);
        assert.ok(seen.length > 5 && seen.filter((s) => s).length > 0.85 * seen.length, `${seen}`);
      },
    };
    await act(page, hand, tools);
    assert.deepEqual(page.complaints, []);
  } finally {
    await browser.close();
    await server.kill();
  }
}

test('place a source, drag it, turn it, cancel an automatic pair, draw a stroke, reshape it, export', () => story('scan:4,0.25', 'pebble', async (page, hand, { inSpace, show, middleOf, strokeIsDrawn }) => {
  const placed = async () => {
    const [s] = hand.design().singularities;
    assert.deepEqual(await drawnAt(page, [inSpace(s)], orange), [true]);
    assert.equal((await hand.state()).meta.controls[0].met, true);
    return s;
  };
  await hand.drop('source', 60, 60);
  const first = await placed();
  await show('place');

  const [x, y] = await middleOf('.ring.chosen');
  await hand.editing(() => hand.drag([x, y], [x + 50, y - 40]));
  const moved = await placed();
  assert.notEqual(moved.face, first.face);
  await show('drag');

  const [kx, ky] = await middleOf('.knob'), [cx, cy] = await middleOf('.ring.chosen');
  await hand.editing(() => hand.drag([kx, ky], [cx + (kx - cx) * 0.7 + (ky - cy) * 0.7, cy + (ky - cy) * 0.7 - (kx - cx) * 0.7]));
  const turned = await placed();
  assert.ok(Math.abs(((turned.angle - moved.angle + 540) % 360) - 180 - 45) < 15, `turned from ${moved.angle} to ${turned.angle}`);
  await show('turn');

  // Two that the field has of its own next to each other, where they can be seen.
  const spot = await page.evaluate(() => {
    const { camera, canvas } = alcap.stage, box = canvas.getBoundingClientRect(), { singular, singular_faces: faces } = alcap.view.arrays;
    const asked = alcap.design.singularities.map((s) => s.face);
    let best = Infinity, found = null;
    for (let k = 0; k < faces.length; ++k) {
      const partner = alcap.card.partner(k);
      if (asked.includes(faces[k]) || partner < 0) continue;
      const at = camera.position.clone().set(...singular.slice(8 * k, 8 * k + 3));
      const apart = at.distanceTo(at.clone().set(...singular.slice(8 * partner, 8 * partner + 3)));
      const p = at.project(camera), spot = { clientX: box.left + ((p.x + 1) / 2) * box.width, clientY: box.top + ((1 - p.y) / 2) * box.height };
      const hit = alcap.view.pick(spot);
      if (hit && alcap.view.near(hit.point) === k && apart < best) [best, found] = [apart, spot];
    }
    return found;
  });
  assert.ok(spot, 'no pair is seen');
  const before = (await hand.state()).arrays.singular_faces.length;
  await page.mouse.click(spot.clientX, spot.clientY);
  await page.waitForSelector('.card .plain');
  await show('pair');
  await hand.editing(() => page.click('.card .plain'));
  await hand.settled();
  assert.equal((await hand.state()).arrays.singular_faces.length, before - 2);
  assert.equal(hand.design().strokes[0].name, 'cancelled pair');
  await show('cancelled');

  await hand.brush([-120, 95], [-50, 110], [50, 95]);
  await strokeIsDrawn(1);
  await page.click('.controls .name:has(.stroke) >> nth=1');
  const drawn = hand.design().strokes[1].points, bead = await middleOf('.bead >> nth=2');
  await hand.editing(() => hand.drag(bead, [bead[0] + 15, bead[1] - 40]));
  const bent = hand.design().strokes[1].points;
  assert.equal(bent.length, drawn.length);
  assert.notDeepEqual(bent[Math.floor(bent.length / 2)], drawn[Math.floor(bent.length / 2)]);
  assert.deepEqual(bent[0], drawn[0]);  // the other end stays
  await strokeIsDrawn(1);
  await hand.editing(() => page.locator('.controls .slider input[aria-label=Weight]').press('End'));
  assert.equal(hand.design().strokes[1].weight, 1000);
  await show('stroke');

  await page.click('nav [title="Save the field for another program"]');
  await show('export');
  const saved = page.waitForEvent('download');
  await page.click('.exports a >> nth=0');
  assert.equal((await saved).suggestedFilename(), 'pebble.field.ply');
}));

test('features: the field follows sharp edges from the angle on that the slider says', () => story(box([1.6, 1, 0.8], 0.1), 'box', async (page, hand, { show }) => {
  const accented = () => page.evaluate(() => alcap.creases.total);
  assert.equal(await accented(), 0);
  await hand.editing(() => page.click('.features .toggle'));
  assert.deepEqual(hand.design().features, { angle: 40 });
  assert.equal(hand.design().strokes, undefined);
  const { meta, arrays } = await hand.state();
  assert.ok(arrays.crease_offsets.length > 5);
  assert.equal(meta.controls[0].path, '/features');
  const { arrays: { positions: P } } = unpack((await request(hand.server.url, '/api/mesh')).body);
  // On the canvas: middles of edges of these lines, seen from outside.
  const points = [];
  for (let k = 0; k + 1 < arrays.crease_offsets.length; ++k) {
    for (let i = arrays.crease_offsets[k]; i + 1 < arrays.crease_offsets[k + 1]; ++i) {
      const [a, b] = [arrays.creases[i], arrays.creases[i + 1]].map((v) => P.slice(3 * v, 3 * v + 3));
      // As far as the middle of the box is away, and outwards.
      const middle = a.map((v, c) => (v + b[c]) / 2);
      points.push([...middle, ...middle]);
    }
  }
  const seen = await drawnAt(page, points, teal);
  assert.ok(seen.length >= 15 && seen.filter((s) => s).length > 0.8 * seen.length, `${seen.filter((s) => s).length} of ${seen.length}`);
  await show('features');
  // No edge folds by more than 90 degrees.
  await hand.editing(() => page.locator('.features input[aria-label=Angle]').press('End'));
  assert.equal(hand.design().features.angle, 180);
  assert.match(await page.textContent('.features p'), /No edge/);
  assert.equal(await accented(), 0);
  await hand.editing(() => page.click('.features .toggle'));
  assert.equal(hand.design().features, undefined);
}));
