// SPDX-License-Identifier: MIT
//
// view.test.mjs: the page of a finished field, opened from the disk without a network.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';

import { alcap, darkPixels, folder, launch, open } from './browser.mjs';

let browser, page, place;

before(async () => {
  place = folder();
  alcap('make', 'icosphere:3', '-o', join(place, 'ball.ply'));
  alcap('field', join(place, 'ball.ply'), '-n', '4', '-o', `${place}/out`, '--html', join(place, 'ball.html'));
  browser = await launch();
  page = await open(browser, pathToFileURL(join(place, 'ball.html')).href, { offline: true });
});
after(() => browser?.close());

test('asks for nothing but itself and complains about nothing', () => {
  assert.deepEqual(page.complaints, []);
  assert.equal(page.requests.filter((r) => !/^(data|blob):/.test(r)).length, 1);
});

test('says what the report says', async () => {
  assert.equal(await page.textContent('h1'), 'ball');
  assert.match(await page.textContent('.panel'), /Certified/);
  assert.match(await page.textContent('.counts'), /Sum of indices\+2/);
  assert.match(await page.textContent('dl'), /642/);
});

test('the picture holds the field: keys switch it', async () => {
  await page.focus('#canvas');
  const curves = await darkPixels(page);
  await page.keyboard.press('3');
  const nothing = await darkPixels(page);
  await page.keyboard.press('2');
  const glyphs = await darkPixels(page);
  assert.ok(curves > 4000 && glyphs > 2000 && nothing < curves / 10 && nothing < glyphs / 10, `${curves} ${glyphs} ${nothing}`);
  assert.equal(await page.getAttribute('[data-value=glyphs]', 'aria-checked'), 'true');
});

test('colours have a legend, faces and singularities tell their numbers', async () => {
  await page.click('[data-value=dbar]');
  assert.equal(await page.isVisible('.legend .bar'), true);
  const box = await page.evaluate(() => [alcap.stage.free.width / 2, alcap.stage.free.height / 2]);
  await page.mouse.click(...box);
  assert.match(await page.textContent('.card'), /Face [\d,]+.*∂̄u/);
  assert.deepEqual(page.complaints, []);
});

test('a picture can be larger than the screen, and the screen stays as it is', async () => {
  const before = await darkPixels(page);
  await page.click('nav [title^="Save a picture"]');
  assert.deepEqual(await page.locator('.exports .item').allTextContents(), ['1000 × 700 pixels', '2000 × 1400 pixels', '4000 × 2800 pixels']);
  const saved = page.waitForEvent('download');
  await page.click('.exports .item >> nth=1');
  const png = readFileSync(await (await saved).path());
  assert.deepEqual([png.readUInt32BE(16), png.readUInt32BE(20)], [2000, 1400]);
  assert.ok(png.length > 100000);
  assert.equal(await darkPixels(page), before);
  assert.deepEqual(await page.evaluate(() => [alcap.stage.canvas.width, alcap.stage.canvas.height]), [1000, 700]);
});

test('alcap view makes the same page from the files', async () => {
  alcap('view', join(place, 'out'), '-o', join(place, 'again.html'));
  const again = await open(browser, pathToFileURL(join(place, 'again.html')).href, { offline: true, viewport: { width: 390, height: 844 } });
  assert.equal(await again.textContent('.counts'), await page.textContent('.counts'));
  assert.equal(await again.textContent('dl'), await page.textContent('dl'));
  assert.equal(await again.isVisible('.panel .scroll'), false);  // folded on a phone
  await again.click('.fold');
  assert.equal(await again.isVisible('.counts'), true);
  assert.ok((await darkPixels(again)) > 2000);
  assert.deepEqual(again.complaints, []);
});
