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

test('a picture can be as wide as one says, up to what the machine draws', async () => {
  await page.click('nav [title^="Save a picture"]');
  const [widest, largest] = await page.evaluate(() => {
    const gl = alcap.stage.renderer.getContext();
    return [alcap.stage.widest, gl.getParameter(gl.MAX_TEXTURE_SIZE)];
  });
  assert.ok(widest >= 4096 && widest <= largest, `${widest} of ${largest}`);
  const width = page.locator('dialog[open] input'), save = page.locator('dialog[open] .own button');
  for (const wrong of [widest + 1, 3, 100.5]) {
    await width.fill(String(wrong));
    assert.equal(await save.isDisabled(), true, `${wrong}`);
    assert.match(await page.textContent('dialog[open] .quiet'), new RegExp(`to ${widest} pixels`));
  }
  await width.fill('1234');
  assert.equal(await page.textContent('dialog[open] .quiet'), '1234 × 863 pixels');
  const saved = page.waitForEvent('download');
  await save.click();
  const png = readFileSync(await (await saved).path());
  assert.deepEqual([png.readUInt32BE(16), png.readUInt32BE(20)], [1234, 863]);
  assert.deepEqual(await page.evaluate(() => [alcap.stage.canvas.width, alcap.stage.canvas.height]), [1000, 700]);
  // Sizes that the machine does not draw are not offered.
  await page.evaluate(() => Object.defineProperty(alcap.stage, 'widest', { value: 2100, configurable: true }));
  await page.click('nav [title^="Save a picture"]');
  assert.deepEqual(await page.locator('.exports .item').allTextContents(), ['1000 × 700 pixels', '2000 × 1400 pixels']);
  await page.click('dialog[open] form .plain');
  await page.evaluate(() => delete alcap.stage.widest);
});

test('a picture of the command line looks like the page: the same ground, and the same light on the same clay', async () => {
  const file = join(place, 'field.png');
  alcap('field', join(place, 'ball.ply'), '--png', file, '--png-size', '1000,700', '--curve-spacing', '1', '-q');
  const own = await open(browser, pathToFileURL(join(place, 'ball.html')).href, { offline: true });
  await own.focus('#canvas');
  await own.keyboard.press('3');
  await own.keyboard.press('s');
  /** Of both: a corner, and the middle of the ball, which faces the viewer, as medians of their surroundings. */
  const [page, picture] = await own.evaluate(async (bytes) => {
    const { stage } = alcap;
    await stage.drawn();
    const image = await createImageBitmap(new Blob([Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0))]));
    return [[stage.canvas, stage.free.width / 2, stage.free.height / 2], [image, image.width / 2, image.height / 2]].map(([from, x, y]) => {
      const copy = document.createElement('canvas');
      [copy.width, copy.height] = [from.width, from.height];
      const context = copy.getContext('2d');
      context.drawImage(from, 0, 0);
      const median = (left, top) => {
        const { data } = context.getImageData(Math.round(left), Math.round(top), 30, 30);
        return [0, 1, 2].map((c) => Array.from({ length: data.length / 4 }, (_, k) => data[4 * k + c]).sort((a, b) => a - b)[450]);
      };
      return { corner: median(2, 2), middle: median(x - 15, y - 15) };
    });
  }, readFileSync(file).toString('base64'));
  assert.deepEqual(picture.corner, page.corner);
  const style = await own.evaluate(() => getComputedStyle(document.documentElement).getPropertyValue('--canvas').trim());
  assert.deepEqual(picture.corner, style.match(/[\da-f]{2}/gi).map((x) => parseInt(x, 16)));
  const off = Math.max(...picture.middle.map((x, c) => Math.abs(x - page.middle[c])));
  assert.ok(off <= 3, `${picture.middle} and ${page.middle}`);
  assert.notDeepEqual(picture.middle, picture.corner);
  await own.context().close();
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

test('the coarse surface that is drawn while a large one turns has the outline and the shading of the full one', async () => {
  alcap('make', 'icosphere:7', '-o', join(place, 'fine.ply'), '-q');
  alcap('field', join(place, 'fine.ply'), '-n', '1', '-o', `${place}/fine`, '--html', join(place, 'fine.html'), '-q');
  const fine = await open(browser, pathToFileURL(join(place, 'fine.html')).href, { offline: true });
  await fine.focus('#canvas');
  await fine.keyboard.press('3');  // the surface alone
  await fine.keyboard.press('s');
  const [made, full, coarse] = await fine.evaluate(async () => {
    const { surface } = alcap.view, { stage } = alcap;
    /** Brightness of every pixel of the canvas. */
    const picture = async () => {
      await stage.drawn();
      const copy = document.createElement('canvas');
      [copy.width, copy.height] = [stage.canvas.width, stage.canvas.height];
      const context = copy.getContext('2d');
      context.drawImage(stage.canvas, 0, 0);
      const { data } = context.getImageData(0, 0, copy.width, copy.height);
      return Array.from({ length: data.length / 4 }, (_, k) => data[4 * k] + data[4 * k + 1] + data[4 * k + 2]);
    };
    const whole = await picture();
    stage.hasty = true;
    const roughly = await picture(), P = surface.object.geometry.attributes.position.array;
    let [least, most] = [Infinity, 0];
    for (let k = 0; k < P.length; k += 3) {
      const radius = Math.hypot(P[k], P[k + 1], P[k + 2]);
      [least, most] = [Math.min(least, radius), Math.max(most, radius)];
    }
    const made = { faces: P.length / 9, of: surface.faces.length / 3, least, most, reach: surface.reach };
    return [made, whole, roughly];
  });
  assert.ok(made.faces > 500 && made.faces < made.of / 4, JSON.stringify(made));
  // Vertices of the sphere: none has left it.
  assert.ok(made.least > 0.97 * made.reach && made.most < 1.001 * made.reach, JSON.stringify(made));
  const ground = full[0];
  const on = (pixels) => pixels.filter((x) => Math.abs(x - ground) > 20).length;
  assert.ok(Math.abs(on(coarse) - on(full)) < 0.02 * on(full), `${on(coarse)} of ${on(full)} pixels`);
  const off = full.reduce((sum, x, k) => sum + Math.abs(x - coarse[k]), 0) / on(full);
  assert.ok(off > 0 && off < 12, `${off} of 765 on average`);
  await fine.close();
});
