// SPDX-License-Identifier: MIT
//
// access.test.mjs: what axe knows about pages that everybody can use: names, roles, contrast, order. In light and dark,
// at a desk and on a phone, with every dialog and card open.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { after, before, test } from 'node:test';

import { alcap, folder, Hand, launch, open, request, studio } from './browser.mjs';

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const place = folder(), mesh = join(place, 'ball.ply'), file = join(place, 'ball.html');
const looks = [
  { colorScheme: 'light', viewport: { width: 1440, height: 900 } }, { colorScheme: 'dark', viewport: { width: 1440, height: 900 } },
  { colorScheme: 'light', viewport: { width: 390, height: 844 } }, { colorScheme: 'dark', viewport: { width: 390, height: 844 } },
];
let browser, server, other;

before(async () => {
  alcap('make', 'icosphere:2', '-o', mesh);
  alcap('field', mesh, '--html', file);
  server = await studio(mesh);
  alcap('make', 'torus:16,8', '-o', join(place, 'ring.ply'));
  other = await studio(join(place, 'ring.ply'));
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.kill();
  await other?.kill();
});

/** What axe finds, in one line each. */
async function complaints(page) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => window.axe.run(document, { resultTypes: ['violations'] }));
  return violations.flatMap(({ id, nodes }) => nodes.map((n) => `${id}: ${n.target.join(' ')} ${n.any[0]?.message || ''}`));
}

for (const { colorScheme, viewport } of looks) {
  const name = `${colorScheme}, ${viewport.width} pixels wide`;
  test(`axe finds nothing on the page of a field: ${name}`, async () => {
    const page = await open(browser, pathToFileURL(file).href, { viewport });
    await page.emulateMedia({ colorScheme });
    if (viewport.width < 760) await page.click('.fold');
    assert.deepEqual(await complaints(page), []);
    await page.keyboard.press('?');
    assert.deepEqual(await complaints(page), []);
    await page.context().close();
  });

  test(`axe finds nothing in the studio: ${name}`, async () => {
    const page = await open(browser, server.url, { viewport });
    await page.emulateMedia({ colorScheme });
    const hand = new Hand(page, server);
    await hand.settled();
    if (!(await hand.state()).meta.design.singularities?.length) await hand.drop('source');
    if (viewport.width < 760) await page.click('.fold');
    await page.click('.controls .name');
    assert.deepEqual(await complaints(page), []);
    await page.evaluate(() => alcap.card.tell(0));
    assert.deepEqual(await complaints(page), []);
    for (const dialog of ['exports', 'pictures', 'help']) {
      await page.evaluate((name) => (name === 'help' ? alcap.help.showModal() : alcap[name].choose()), dialog);
      assert.deepEqual(await complaints(page), [], dialog);
      await page.evaluate((name) => alcap[name].close(), dialog);
    }
    await page.context().close();
  });

  test(`axe finds nothing in the studio with cones, eigen designs, creases, strokes, directions: ${name}`, async () => {
    const page = await open(browser, other.url, { viewport });
    await page.emulateMedia({ colorScheme });
    const hand = new Hand(page, other), base = { alcap_design: 1, n: 4, guidance: { field: 'smoothest' } };
    await hand.settled();
    if (viewport.width < 760) await page.click('.fold');
    const ring = [{ vertex: 0, index: '1/4' }, { vertex: 9, index: '-1/4' }];
    for (const [what, design] of Object.entries({
      cones: { ...base, connection: { kind: 'trivial', cones: ring } },
      'cones that do not sum up': { ...base, connection: { kind: 'trivial', cones: ring.slice(1) } },
      metric: { ...base, connection: { kind: 'metric', cones: [{ vertex: 0, index: 0.3 }, { vertex: 9, index: -0.3 }] } },
      creases: { ...base, features: { angle: 10 } },
      'several zeros': { ...base, singularities: [{ face: 3, kind: 'saddle', count: 3 }] },
      'strokes and directions': { ...base, strokes: [{ vertices: [0, 9] }], fixed: [{ vertex: 40, direction: [1, 0, 0] }] },
      eigen: { alcap_design: 1, n: 4, method: 'eigen', singularities: [{ face: 3, kind: 'source' }] },
    })) {
      const { status } = await request(other.url, '/api/edit', {}, { method: 'POST', body: JSON.stringify(design) });
      assert.equal(status, 200, what);
      await hand.settled();
      await page.evaluate(() => document.querySelectorAll('details').forEach((d) => { d.open = true; }));
      for (const name of await page.locator('.controls .name').all()) {
        await name.click();
        assert.deepEqual(await complaints(page), [], what);
      }
      assert.deepEqual(await complaints(page), [], what);
    }
    await page.context().close();
  });
}
