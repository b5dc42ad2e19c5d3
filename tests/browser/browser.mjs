// SPDX-License-Identifier: MIT
//
// browser.mjs: what the browser tests share: Chromium, a page whose console is watched, the program, a running studio.
import { execFileSync, spawn } from 'node:child_process';
import { once } from 'node:events';
import { mkdtempSync, readFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { chromium } from 'playwright-core';

export const patience = 120000;  // ms; software rendering on a busy machine

export function folder() {
  return mkdtempSync(join(tmpdir(), 'alcap-browser-'));
}

export function alcap(...options) {
  return execFileSync(process.env.ALCAP, options, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });
}

/** The report of the command line on a saved design, solved on the triangles of the mesh as the studio does; whether its controls are met is in the report. */
export function judged(mesh, design, ...more) {
  try {
    return JSON.parse(alcap('design', mesh, '--design', design, '--triangulation', 'extrinsic', '--json', ...more));
  } catch (error) {
    if (error.status !== 8) throw error;  // 8: a control is not met
    return JSON.parse(error.stdout);
  }
}

export function launch() {
  return chromium.launch({
    executablePath: process.env.CHROMIUM,
    args: ['--headless', '--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync',
      '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });
}

/** A page; `complaints` collects warnings and errors of its console, and whatever it threw. */
export async function open(browser, url, { offline = false, viewport = { width: 1000, height: 700 } } = {}) {
  const context = await browser.newContext({ viewport, offline });
  const page = await context.newPage();
  page.setDefaultTimeout(patience);
  page.complaints = [];
  page.requests = [];
  // Software rendering makes Chromium complain about its own speed.
  page.on('console', (m) => { if (['error', 'warning'].includes(m.type()) && !/GPU stall|GL Driver/.test(m.text())) page.complaints.push(m.text()); });
  page.on('pageerror', (e) => page.complaints.push(e.message));
  page.on('request', (r) => page.requests.push(r.url()));
  await page.goto(url);
  await page.waitForSelector('html[data-ready]');
  return page;
}

/** Pixels of the canvas as dark as the curves: a picture with a field has many, a plain surface hardly any. */
export function darkPixels(page) {
  return page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => {
    const from = document.getElementById('canvas');
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [from.width, from.height];
    const context = copy.getContext('2d');
    context.drawImage(from, 0, 0);
    const { data } = context.getImageData(0, 0, copy.width, copy.height);
    let dark = 0;
    for (let k = 0; k < data.length; k += 4) dark += data[k] + data[k + 1] + data[k + 2] < 240;
    done(dark);
  }))));
}

/** For points of space with their normals (6 numbers each) that face the viewer: which of them have a pixel of this colour, bright or shaded, within two pixels on the canvas. */
export function drawnAt(page, points, color) {
  return inkedAt(page, points, color);
}

/** The same for pixels as dark as the curves, where a plain surface is bright. */
export function darkAt(page, points) {
  return inkedAt(page, points, null);
}

function inkedAt(page, points, color) {
  return page.evaluate(({ points, color }) => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => {
    const { canvas, camera } = alcap.stage;
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const context = copy.getContext('2d');
    context.drawImage(canvas, 0, 0);
    const { data } = context.getImageData(0, 0, copy.width, copy.height);
    const times = (m, v) => [0, 1, 2, 3].map((r) => v.reduce((sum, x, c) => sum + m[4 * c + r] * x, 0));
    const like = (k) => {
      if (!color) return data[k] + data[k + 1] + data[k + 2] < 300;
      const [a, b] = [Math.hypot(...data.subarray(k, k + 3)), Math.hypot(...color)];
      return a > 60 && color.reduce((sum, x, c) => sum + x * data[k + c], 0) > 0.985 * a * b;
    };
    const found = [];
    for (const [x, y, z, ...normal] of points) {
      const towards = camera.position.toArray().map((v, c) => v - [x, y, z][c]);
      if (normal.reduce((sum, v, c) => sum + v * towards[c], 0) < 0.4 * Math.hypot(...normal) * Math.hypot(...towards)) continue;
      const clip = times(camera.projectionMatrix.elements, times(camera.matrixWorldInverse.elements, [x, y, z, 1]));
      const column = Math.round((0.5 + clip[0] / clip[3] / 2) * copy.width), row = Math.round((0.5 - clip[1] / clip[3] / 2) * copy.height);
      let seen = false;
      for (let i = -2; i <= 2; ++i) for (let j = -2; j <= 2; ++j) seen ||= like(4 * ((row + j) * copy.width + column + i));
      found.push(seen);
    }
    done(found);
  }))), { points, color });
}

/** `alcap studio MESH ...`: {url, stop()}. */
export async function studio(mesh, ...options) {
  const server = spawn(process.env.ALCAP, ['studio', mesh, '--no-open', '--json', ...options], { stdio: ['ignore', 'pipe', 'inherit'] });
  let text = '';
  for await (const piece of server.stdout) {
    text += piece;
    if (text.includes('\n')) break;
  }
  const { url, design } = JSON.parse(text);
  const kill = async () => {
    if (server.exitCode !== null || server.signalCode) return;
    server.kill('SIGKILL');
    await once(server, 'exit');
  };
  return { url, design, kill };
}

/** A request as the page makes it: {status, body}. */
export async function request(url, path, parameters = {}, options = {}) {
  const { origin, searchParams } = new URL(url);
  const response = await fetch(`${origin}${path}?${new URLSearchParams({ t: searchParams.get('t'), ...parameters })}`, options);
  return { status: response.status, body: Buffer.from(await response.arrayBuffer()) };
}

/** The parts of a pack (apps/alcap/page/view_pack.h), numbers as plain arrays. */
export function unpack(bytes) {
  const size = bytes.readUInt32LE(8);
  const header = JSON.parse(bytes.subarray(16, 16 + size));
  const arrays = {};
  for (const { name, type, offset, length } of header.arrays) {
    const read = { f32: ['readFloatLE', 4], u32: ['readUInt32LE', 4], i16: ['readInt16LE', 2], bf16: ['readUInt16LE', 2] }[type];
    arrays[name] = Array.from({ length }, (_, k) => bytes[read[0]](16 + size + offset + read[1] * k));
  }
  return { meta: header.meta, arrays };
}

/** The numbers that a PLY file of alcap holds per vertex, by their names. */
export function vertexColumns(bytes) {
  const mark = 'end_header\n', start = bytes.indexOf(mark) + mark.length, header = bytes.subarray(0, start).toString('latin1');
  const number = Number(header.match(/element vertex (\d+)/)[1]);
  const names = header.match(/element vertex \d+\n((?:property double \w+\n)+)element face/)[1].trim().split('\n').map((l) => l.split(' ')[2]);
  return Object.fromEntries(names.map((name, c) => [name, Array.from({ length: number }, (_, v) => bytes.readDoubleLE(start + 8 * (names.length * v + c)))]));
}

/** Every pixel of a square around a place on the canvas, brightness only. */
export function pixelsAround(page, [x, y], half) {
  return page.evaluate(async ({ x, y, half }) => {
    const { stage } = alcap, box = stage.canvas.getBoundingClientRect(), scale = stage.canvas.width / box.width;
    await stage.drawn();
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [stage.canvas.width, stage.canvas.height];
    const context = copy.getContext('2d');
    context.drawImage(stage.canvas, 0, 0);
    const { data } = context.getImageData(Math.round((x - box.left - half) * scale), Math.round((y - box.top - half) * scale), Math.round(2 * half * scale), Math.round(2 * half * scale));
    return Array.from({ length: data.length / 4 }, (_, k) => data[4 * k] + data[4 * k + 1] + data[4 * k + 2]);
  }, { x, y, half });
}

/** What a person does in a studio's page, and what the server then has. */
export class Hand {
  constructor(page, server) {
    this.page = page;
    this.server = server;
  }

  design() {
    return JSON.parse(readFileSync(this.server.design));
  }

  async state() {
    return unpack((await request(this.server.url, '/api/state')).body);
  }

  /** Waits until the page shows what the server has, curves included, and asks for nothing more. */
  async settled() {
    for (const end = Date.now() + patience; Date.now() < end;) {
      const { meta } = await this.state();
      const there = await this.page.waitForFunction(({ revision, result }) => {
        const d = document.documentElement.dataset;
        return Number(d.revision) === revision && Number(d.details) === result && !alcap.store.busy;
      }, meta, { timeout: 2000 }).catch(() => false);
      if (there && (await this.state()).meta.revision === meta.revision) return;
    }
    throw new Error('the page does not follow the server');
  }

  /** Does something that edits the design, and waits for its field. */
  async editing(act) {
    const { meta } = await this.state();
    await act();
    await this.page.waitForFunction((revision) => Number(document.documentElement.dataset.revision) > revision, meta.revision);
    await this.settled();
  }

  /** The middle of what the panel leaves free, where the surface faces the viewer. */
  middle() {
    return this.page.evaluate(() => {
      const box = alcap.stage.canvas.getBoundingClientRect();
      return [box.left + alcap.stage.free.width / 2, box.top + alcap.stage.free.height / 2];
    });
  }

  /** Places a singularity, so far from the middle. */
  async drop(kind, dx = 0, dy = 0) {
    const [x, y] = await this.middle();
    await this.page.click(`.toolbox [data-value=${kind}]`);
    await this.editing(() => this.page.mouse.click(x + dx, y + dy));
  }

  /** Presses at the first point, moves to the others in steps, releases. */
  async drag(from, ...points) {
    const { mouse } = this.page;
    await mouse.move(...from);
    await mouse.down();
    for (const to of points) {
      for (let s = 0.1; s <= 1.001; s += 0.1) await mouse.move(from[0] + s * (to[0] - from[0]), from[1] + s * (to[1] - from[1]));
      from = to;
    }
    await mouse.up();
  }

  /** Draws a stroke through points relative to the middle. */
  async brush(...points) {
    const [x, y] = await this.middle();
    await this.page.click('.toolbox [data-value=stroke]');
    await this.editing(() => this.drag(...points.map(([dx, dy]) => [x + dx, y + dy])));
    await this.page.click('.toolbox [data-value=turn]');
  }
}
