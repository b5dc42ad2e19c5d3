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

import { alcap, folder, Hand, launch, open, studio } from './browser.mjs';

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const place = folder(), mesh = join(place, 'ball.ply'), file = join(place, 'ball.html');
const looks = [
  { colorScheme: 'light', viewport: { width: 1440, height: 900 } }, { colorScheme: 'dark', viewport: { width: 1440, height: 900 } },
  { colorScheme: 'light', viewport: { width: 390, height: 844 } }, { colorScheme: 'dark', viewport: { width: 390, height: 844 } },
];
let browser, server;

before(async () => {
  alcap('make', 'icosphere:2', '-o', mesh);
  alcap('field', mesh, '--html', file);
  server = await studio(mesh);
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.kill();
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
    await page.evaluate(() => alcap.exports.showModal());
    assert.deepEqual(await complaints(page), []);
    await page.context().close();
  });
}
