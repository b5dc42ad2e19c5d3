// SPDX-License-Identifier: MIT
//
// story.test.mjs: a design from the first click to the file, as docs/studio.md shows it. Every step is checked by the
// pixels of the canvas and by the saved design; the pictures go to the folder STORY, where that is given.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';

import { alcap, darkAt, drawnAt, folder, Hand, judged, launch, open, pixelsAround, request, studio, unpack, vertexColumns } from './browser.mjs';

const orange = [213, 94, 0], blue = [0, 114, 178], teal = [15, 118, 110];

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
      mesh,
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
      /** Points three quarters along the straight branches of a placed singularity's pattern. */
      async branches({ face }) {
        const { arrays: { arms, singular, singular_faces: faces } } = await hand.state(), number = faces.indexOf(face);
        const length = 0.75 * 0.022 * (await page.evaluate(() => alcap.view.meta.diagonal)), at = singular.slice(8 * number, 8 * number + 6);
        return Array.from({ length: arms.length / 4 }, (_, k) => arms.slice(4 * k, 4 * k + 4)).filter(([s]) => s === number)
          .map(([, ...d]) => [...d.map((x, c) => at[c] + length * x), ...at.slice(3)]);
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

test('place a source, drag it, turn it, cancel an automatic pair, draw a stroke, reshape it, export', () => story('scan:4,0.25', 'pebble', async (page, hand, { mesh, inSpace, show, middleOf, strokeIsDrawn, branches }) => {
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
  await hand.editing(() => hand.drag([x, y], [x + 20, y - 100]));
  const moved = await placed();
  assert.notEqual(moved.face, first.face);
  assert.deepEqual(await drawnAt(page, [inSpace(first)], orange), [false]);
  await show('drag');

  const [kx, ky] = await middleOf('.knob'), [cx, cy] = await middleOf('.ring.chosen');
  const armsBefore = await branches(moved), picture = await pixelsAround(page, [cx, cy], 40);
  const drawn = async (points) => (await drawnAt(page, points, orange)).filter(Boolean).length;
  assert.equal(armsBefore.length, 3);  // of a zero of index 1/4
  assert.equal(await drawn(armsBefore), 3);
  await hand.editing(() => hand.drag([kx, ky], [cx + (kx - cx) * 0.7 + (ky - cy) * 0.7, cy + (ky - cy) * 0.7 - (kx - cx) * 0.7]));
  const turned = await placed();
  assert.ok(Math.abs(((turned.angle - moved.angle + 540) % 360) - 180 - 45) < 15, `turned from ${moved.angle} to ${turned.angle}`);
  // On the canvas: the branches of its pattern, and the curves around it.
  assert.equal(await drawn(await branches(turned)), 3);
  assert.equal(await drawn(armsBefore), 0);
  const now = await pixelsAround(page, [cx, cy], 40);
  assert.ok(now.filter((x, k) => Math.abs(x - picture[k]) > 60).length > 0.1 * now.length);
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
      const spotOf = (j) => {
        const p = at.clone().set(...singular.slice(8 * j, 8 * j + 3)).project(camera);
        return { clientX: box.left + ((p.x + 1) / 2) * box.width, clientY: box.top + ((1 - p.y) / 2) * box.height };
      };
      const seen = [k, partner].every((j) => {
        const hit = alcap.view.pick(spotOf(j));
        return hit && alcap.view.near(hit.point) === j;
      });
      const pair = [k, partner].map((j) => Array.from(singular.slice(8 * j, 8 * j + 7)));
      if (seen && apart < best) [best, found] = [apart, { ...spotOf(k), pair }];
    }
    return found;
  });
  assert.ok(spot, 'no pair is seen');
  const marks = async (color) => (await drawnAt(page, spot.pair.map((s) => s.slice(0, 6)), color)).join();
  assert.match(await marks(spot.pair[0][6] > 0 ? orange : blue), /^true/);
  assert.match(await marks(spot.pair[1][6] > 0 ? orange : blue), /true$/);
  const before = (await hand.state()).arrays.singular_faces.length;
  await page.mouse.click(spot.clientX, spot.clientY);
  await page.waitForSelector('.card .plain');
  await show('pair');
  await hand.editing(() => page.click('.card .plain'));
  await hand.settled();
  assert.equal((await hand.state()).arrays.singular_faces.length, before - 2);
  assert.deepEqual([await marks(orange), await marks(blue)], ['false,false', 'false,false']);
  const [{ name, points }] = hand.design().strokes;
  assert.equal(name, 'cancelled pair');
  assert.ok(points.length > 5);
  // The field follows the stroke: nothing in the list is red.
  assert.deepEqual((await hand.state()).meta.controls.map((c) => [c.path, c.met]), [['/singularities/0', true], ['/strokes/0', true]]);
  assert.equal(await page.locator('.controls .unmet').count(), 0);
  await show('cancelled');

  await hand.brush([-120, 95], [-50, 110], [50, 95]);
  await strokeIsDrawn(1);
  await page.click('.controls .name:has(.stroke) >> nth=1');
  const straight = hand.design().strokes[1].points, bead = await middleOf('.bead >> nth=2');
  await hand.editing(() => hand.drag(bead, [bead[0] + 10, bead[1] - 25]));
  const bent = hand.design().strokes[1].points;
  assert.equal(bent.length, straight.length);
  assert.deepEqual(bent[0], straight[0]);  // the end stays
  await strokeIsDrawn(1);
  // Where it was, besides near its ends, it is no more.
  const away = (k) => Math.hypot(...inSpace(bent[k]).slice(0, 3).map((x, c) => x - inSpace(straight[k])[c])), farthest = straight.reduce((best, _, k) => (away(k) > away(best) ? k : best), 0);
  assert.deepEqual(await drawnAt(page, [inSpace(straight[farthest])], teal), [false]);
  await hand.editing(() => page.locator('.controls .slider input[aria-label=Weight]').press('ArrowRight'));
  assert.ok(hand.design().strokes[1].weight > 10);
  assert.deepEqual([await marks(orange), await marks(blue)], ['false,false', 'false,false']);  // the pair stays away
  await show('stroke');

  await page.click('nav [title="Save the field for another program"]');
  await show('export');
  const saved = page.waitForEvent('download');
  await page.click('.exports a >> nth=0');
  const download = await saved;
  assert.equal(download.suggestedFilename(), 'pebble.field.ply');
  // It holds the field of the saved design.
  const own = join(folder(), 'own.ply');
  judged(mesh, hand.server.design, '-o', own);
  const [exported, computed] = [await download.path(), own].map((file) => vertexColumns(readFileSync(file)));
  const u = ['u_re', 'u_im'], size = Math.max(...u.flatMap((c) => computed[c].map(Math.abs)));
  for (const c of u) exported[c].forEach((x, v) => assert.ok(Math.abs(x - computed[c][v]) < 1e-6 * size, `${c} at vertex ${v}: ${x} and ${computed[c][v]}`));
}));

test('features: the field follows sharp edges from the angle on that the slider says', () => story(box([1.6, 1, 0.8], 0.1), 'box', async (page, hand, { show }) => {
  const accented = () => page.evaluate(() => alcap.creases.total);
  /** Curves on the canvas near sharp edges, parallel to the nearest one or across it: middles of their segments, and how far off each is. */
  const nearEdges = async () => {
    const { meta } = await hand.state();
    const { curves: C, curve_offsets: O } = unpack((await request(hand.server.url, '/api/details', { result: meta.result, part: 'curves' })).body).arrays;
    const half = [0.8, 0.5, 0.4], points = [], off = [];
    for (let k = 0; k + 1 < O.length; ++k) {
      for (let i = O[k]; i + 1 < O[k + 1]; i += 3) {
        const [a, b] = [C.slice(3 * i, 3 * i + 3), C.slice(3 * i + 3, 3 * i + 6)], middle = a.map((x, c) => (x + b[c]) / 2), way = a.map((x, c) => b[c] - x);
        const gap = middle.map((x, c) => half[c] - Math.abs(x)), face = gap.indexOf(Math.min(...gap)), others = [0, 1, 2].filter((c) => c !== face);
        const distances = others.map((c) => gap[c]), near = Math.min(...distances);
        if (near > 0.1 || Math.max(...distances) < 0.3 || Math.hypot(...way) < 1e-4) continue;
        const normal = [0, 1, 2].map((c) => (c === face ? Math.sign(middle[c]) : 0));
        points.push([...middle, ...normal]);
        const angle = (Math.atan2(way[others[0]], way[others[1]]) * 180) / Math.PI;
        off.push(Math.abs((((angle % 90) + 135) % 90) - 45));
      }
    }
    return { points, off: off.reduce((sum, x) => sum + x, 0) / off.length };
  };
  const without = await nearEdges();
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
  // The field itself: its curves are on the canvas, along the edges or across them, as they were not before.
  const aligned = await nearEdges();
  assert.ok(aligned.off < 5 && without.off > 2 * aligned.off, `off by ${aligned.off}, before ${without.off}`);
  const ink = await darkAt(page, aligned.points);
  assert.ok(ink.length > 50 && ink.filter(Boolean).length > 0.85 * ink.length, `${ink.filter(Boolean).length} of ${ink.length}`);
  await show('features');
  // No edge folds by more than 90 degrees.
  await hand.editing(() => page.locator('.features input[aria-label=Angle]').press('End'));
  assert.equal(hand.design().features.angle, 180);
  assert.match(await page.textContent('.features p'), /No edge/);
  assert.equal(await accented(), 0);
  await hand.editing(() => page.click('.features .toggle'));
  assert.equal(hand.design().features, undefined);
}));
