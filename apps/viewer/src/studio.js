// SPDX-License-Identifier: MIT
//
// studio.js: the page in which fields are designed: tools on the left, the surface, the design on the right.
import { address, ask } from './api.js';
import { Card } from './card.js';
import { controlsSection } from './controls_list.js';
import { fraction, h, segmented } from './dom.js';
import { Fixed, mirrored, twinOf } from './fixed.js';
import { Handles } from './handles.js';
import { indexOf, kindsOf, mostZeros, setIndex, swirls, titleOf } from './indices.js';
import { listen, onClick, viewKeys } from './keys.js';
import { Lines } from './lines.js';
import { merging, splitting } from './merging.js';
import { Mirror } from './mirror.js';
import { colorSection, makeHelp, makePanel, singularitySection } from './panel.js';
import { View } from './scene.js';
import { Store } from './store.js';
import { Strokes } from './strokes.js';
import { coneIndex, conesSection, fieldSection, memorySection, modesSection, showSection } from './studio_panel.js';
import { angleIn, direction, inside } from './tangent.js';
import { makePictures } from './view.js';

const many = 200000;  // faces: curves are drawn far apart first
const catching = 40;  // pixels from the cross: an arrow key turns by less

const studioKeys = [['V', 'Turn and select'], ['A', 'Source or wedge'], ['Z', 'Saddle or trisector'], ['D', 'Hold a direction'], ['B', 'Draw strokes'], ['E', 'Erase strokes'], ['Ctrl+Z', 'Undo'], ['Ctrl+Shift+Z', 'Redo'], ['Enter', 'At the cross: place it, begin or end a stroke, erase; with Turn, show what is there'], ['T', 'Split the selected singularity into its zeros'], ['Shift+T', 'Split it in two'], ['Del', 'Remove the selected control'], ['Esc', 'Back to turning']];

export async function startStudio(stage, ui, boot) {
  const mesh = await ask('/api/mesh');
  stage.hasty = mesh.arrays.faces.length / 3 > many;
  const app = new Studio(stage, ui, mesh, boot);
  // Large surfaces are here before their first field: to be looked at, not to be edited.
  ui.inert = true;
  app.status.textContent = 'Finding the first field…';
  document.getElementById('veil').hidden = true;
  // The server looks for the field when it is first asked for: the page has the machine until it is on the screen.
  if (stage.hasty) await stage.seen();
  app.times.opened = performance.now();
  document.documentElement.dataset.opened = Math.round(app.times.opened);
  await app.store.load();
  ui.inert = false;
  stage.hasty = false;
  stage.draw();
  return app;
}

class Studio {
  constructor(stage, ui, mesh) {
    this.stage = stage;
    this.selected = -1;  // of the singularities
    this.stroked = -1;   // of the strokes
    this.held = -1;      // of the directions
    this.tool = 'turn';
    this.view = new View(stage, mesh);
    this.title = mesh.meta.title;
    this.times = {};  // of the last edit, ms; opened: since the page was asked for
    this.mirror = new Mirror(this.view.surface, mesh.meta.diagonal);
    this.fixed = new Fixed(this.view.surface);
    // Singularities first, then directions.
    const which = (k, singularity, fixed) => {
      const number = (this.design.singularities || []).length;
      return k < number ? singularity(k) : fixed(k - number);
    };
    this.handles = new Handles(this.view, {
      select: (at) => which(at, (k) => this.select(k), (k) => this.selectFixed(k)),
      turn: (at, degrees, gesture) => which(at, (k) => this.turn(k, degrees, gesture), (k) => this.turnFixed(k, degrees, gesture)),
      move: (at, hit, gesture) => which(at, (k) => this.move(k, hit, gesture), (k) => this.moveFixed(k, hit, gesture)),
      meets: (at, other) => which(at, (k) => which(other, (j) => this.meets(k, j), () => null), () => null),
      merge: (at, other, gesture) => this.merge(at, other, gesture),
      stop: () => this.store.rest(),
    });
    this.strokes = new Strokes(this);
    this.creases = new Lines({ variable: '--accent', width: 0.003 * mesh.meta.diagonal, widths: [1.6, 3.5], lift: 0.0026, order: 3 });
    stage.add(this.creases);
    this.loops = new Lines({ variable: '--accent', width: 0.003 * mesh.meta.diagonal, widths: [1.6, 3.5], lift: 0.0026, order: 3 });
    stage.add(this.loops);
    this.loops.curves(mesh.arrays.loops || new Float32Array(0), mesh.arrays.loop_offsets || [0]);
    this.loops.show(false);
    stage.before = () => {
      this.handles.place();
      this.strokes.place();
      this.aim();
    };
    this.view.wanted = () => this.store.details();
    this.store = new Store({
      state: (pack, mine) => this.onState(pack, mine), follow: (pack) => this.onField(pack), parts: () => this.parts(),
      details: (pack, part) => this.onDetails(pack, part), complete: (result) => this.onComplete(result), status: (kind, text) => this.onStatus(kind, text),
    });
    this.status = h('span', { class: 'chip', role: 'status' }, 'Starting…');
    this.sections = { field: fieldSection(this), controls: controlsSection(this), cones: conesSection(this), modes: modesSection(this), memory: memorySection(this) };
    this.counts = singularitySection(this.view);
    this.color = colorSection(this.view);
    const header = h('header', {}, h('h1', {}, this.title), this.status);
    this.panel = makePanel(header, this.sections.controls, this.sections.cones, this.sections.field, showSection(this.view), this.color, this.counts, this.sections.modes, this.sections.memory);
    this.tools = segmented('Tool', [], this.tool, (t) => this.choose(t, this.tools.keys));
    this.help = makeHelp([...studioKeys, ...viewKeys.filter(([k]) => k !== '?')]);
    this.undoButton = h('button', { type: 'button', title: 'Undo (Ctrl+Z)', onclick: () => this.store.step('undo') }, 'Undo');
    this.redoButton = h('button', { type: 'button', title: 'Redo (Ctrl+Shift+Z)', onclick: () => this.store.step('redo') }, 'Redo');
    this.exports = makeExports(this.view);
    this.pictures = makePictures(stage, this.title);
    const file = h('input', { type: 'file', accept: '.json,application/json', hidden: true, onchange: () => this.open(file) });
    const menu = h('nav', { class: 'tools', 'aria-label': 'Design' }, this.undoButton, this.redoButton, h('i', {}),
      h('button', { type: 'button', title: 'Open a design.json', onclick: () => file.click() }, 'Open'),
      h('button', { type: 'button', title: 'Save design.json', onclick: () => { location.href = address('/api/design'); } }, 'Save'),
      h('button', { type: 'button', title: 'Save the field for another program', onclick: () => this.exports.choose() }, 'Export'),
      h('button', { type: 'button', title: 'Save a picture (P)', onclick: () => this.pictures.choose() }, 'Picture'),
      h('button', { type: 'button', title: 'Keys (?)', class: 'wide', onclick: () => this.help.showModal() }, 'Keys'), file);
    this.card = new Card(this);
    ui.append(this.handles.layer, this.panel, h('nav', { class: 'toolbox', 'aria-label': 'Tools' }, this.tools), menu, this.card.element, this.help, this.exports, this.pictures);
    stage.resize();
    stage.frame(mesh.meta.diagonal);
    onClick(stage.canvas, (event) => this.click(event));
    this.cross = h('i', { class: 'cross', 'aria-hidden': 'true', hidden: true });
    ui.append(this.cross);
    stage.canvas.addEventListener('pointermove', (event) => this.point(event));
    stage.canvas.addEventListener('pointerleave', () => this.point(null));
    const tool = (name) => () => this.choose(name, true);
    listen(stage, {
      v: tool('turn'), Escape: () => this.strokes.drop() || this.rest(), b: tool('stroke'), e: tool('erase'), d: tool('direction'), k: () => this.trivial() && this.choose('cone', true),
      a: () => this.choose(kindsOf(this.design.n)[0][0], true), z: () => this.choose(kindsOf(this.design.n).at(-1)[0], true),
      'Ctrl+z': () => this.store.step('undo'), 'Ctrl+Shift+z': () => this.store.step('redo'), 'Ctrl+y': () => this.store.step('redo'),
      Enter: () => this.act(), t: () => this.split(this.selected), 'Shift+t': () => this.split(this.selected, true),
      Delete: () => this.removeChosen(), Backspace: () => this.removeChosen(), p: () => this.pictures.choose(), '?': () => this.help.showModal(),
    });
  }

  get design() { return this.store.design; }

  /** Whether the connection has cones. */
  trivial() { return ['trivial', 'metric'].includes(this.design.connection?.kind); }

  eigen() { return this.design.method === 'eigen'; }

  /** What is looked at, and so asked for. */
  parts() {
    const { lines, separatrices, color } = this.view.state;
    const large = this.view.arrays.faces.length / 3 > many;
    return [...(lines !== 'curves' ? [] : large ? ['coarse', 'curves'] : ['curves']), ...(separatrices ? ['separatrices'] : []), ...(color ? ['colours'] : [])];
  }

  /** Edits a copy of the design and sends it. */
  change(edit, gesture = '') {
    const design = structuredClone(this.design);
    edit(design);
    this.show(design);
    return this.store.send(design, gesture);
  }

  /** Whether the tool puts something where one clicks, or where the cross is. */
  places() {
    return !['turn', 'stroke', 'erase'].includes(this.tool);
  }

  /** Enter: what the tool does, where the cross is. */
  act() {
    const brush = { stroke: (at) => this.strokes.pen(at), erase: (at) => this.strokes.wipe(at), turn: (at) => this.inspect(at) }[this.tool];
    if (brush && !this.keys) this.choose(this.tool, true);  // from now on by the keyboard: the cross appears
    else if (brush) brush(this.ahead());
    else if (this.places()) this.click(this.ahead());
  }

  /** What a click tells, for the keyboard: of the singularity nearest to the cross, with the focus on what can be done. */
  inspect(at) {
    const hit = this.view.pick(at), near = this.view.around(at, catching);
    this.card.close();
    if (near >= 0) {
      const placed = (this.design.singularities || []).findIndex((s) => s.face === this.view.arrays.singular_faces[near]);
      this.select(placed);
      if (placed >= 0) this.handles.items[placed].ring.focus();
      else this.card.tell(near, true);
      return;
    }
    const stroke = hit ? this.strokes.near(hit.point) : -1;
    if (stroke >= 0) this.selectStroke(stroke);
    else this.select(-1);
    if (stroke < 0 && hit) this.card.face(hit.face);
  }

  /** Esc: back to turning, without cross and card. */
  rest() {
    this.card.close();
    this.choose('turn');
  }

  /** The middle of what the panel leaves free, as a place of the pointer: where the keyboard puts things. */
  ahead() {
    const box = this.stage.canvas.getBoundingClientRect();
    return { clientX: box.left + this.stage.free.width / 2, clientY: box.top + this.stage.free.height / 2 };
  }

  /** The cross of the keyboard, and the face behind it. */
  aim() {
    this.cross.hidden = !this.keys;
    if (this.cross.hidden) return;
    const at = this.ahead();
    this.cross.style.transform = `translate(${at.clientX}px, ${at.clientY}px)`;
    this.strokes.follow(at);
    this.view.highlight(this.view.pick(at)?.face ?? -1);
  }

  /** The face under the pointer is outlined while something is to be put there. */
  point(event) {
    if (this.keys && this.strokes.drawn) return;  // a stroke is being drawn by the keyboard
    this.keys = false;
    const aims = event && !event.buttons && this.places();
    this.view.highlight(aims ? this.view.pick(event)?.face ?? -1 : -1);
    this.cross.hidden = true;
  }

  /** keys: by the keyboard, which puts things where the cross is. */
  choose(tool, keys = false) {
    this.strokes.drop();
    this.tool = tool;
    this.keys = keys;
    this.view.highlight(-1);
    this.stage.draw();
    this.stage.controls.enabled = tool !== 'stroke' && tool !== 'erase';
    this.stage.canvas.classList.toggle('aim', tool !== 'turn');
    this.tools.set(tool);
  }

  select(k) {
    this.selected = k;
    this.stroked = this.held = -1;
    this.show(this.design);
  }

  selectStroke(k) {
    this.selected = this.held = -1;
    this.stroked = k;
    this.show(this.design);
  }

  selectFixed(k) {
    this.selected = this.stroked = -1;
    this.held = k;
    this.show(this.design);
  }

  /** Adds a singularity, and its image where designs are mirrored. */
  add(s) {
    this.stroked = this.held = -1;
    this.selected = (this.design.singularities || []).length;
    return this.change((d) => {
      const list = (d.singularities ??= []), image = this.mirror.axis >= 0 ? this.mirror.singularity(s, d.n) : null;
      list.push(s);
      if (image && !list.some((one) => one.face === image.face)) list.push(image);
    });
  }

  /** chosen: with its beads and its numbers from the start. */
  addStroke(s, chosen = false) {
    if (chosen) {
      this.selected = this.held = -1;
      this.stroked = (this.design.strokes || []).length;
    }
    return this.change((d) => {
      (d.strokes ??= []).push(s);
      if (this.mirror.axis >= 0) d.strokes.push(this.mirror.stroke(s));
    });
  }

  /** Edits singularity k, and its twin as the image of it. */
  edit(k, act, gesture) {
    return this.change((d) => {
      const twin = this.mirror.twin(d, k);
      act(d.singularities[k], d);
      if (twin < 0) return;
      const image = this.mirror.singularity(d.singularities[k], d.n);
      if (image && !d.singularities.some((s, j) => j !== twin && s.face === image.face)) d.singularities[twin] = image;
    }, gesture);
  }

  /** Holds a direction, at first the one that the field has there. */
  addFixed(hit) {
    const vertex = this.fixed.vertexAt(hit), list = this.design.fixed || [], there = list.findIndex((f) => f.vertex === vertex);
    if (there >= 0) return this.selectFixed(there);
    this.selected = this.stroked = -1;
    this.held = list.length;
    const branch = Array.from(this.view.arrays.branch.subarray(3 * vertex, 3 * vertex + 3));
    const one = { vertex, direction: this.fixed.inPlane(vertex, Math.hypot(...branch) ? branch : [1, 0, 0]) };
    return this.change((d) => {
      (d.fixed ??= []).push(one);
      const image = this.mirror.axis >= 0 && mirrored(this.mirror, this.fixed, one);
      if (image && !d.fixed.some((f) => f.vertex === image.vertex)) d.fixed.push(image);
    });
  }

  /** Edits direction k, and its twin as the image of it. */
  editFixed(k, act, gesture) {
    return this.change((d) => {
      const twin = twinOf(this.mirror, this.fixed, d.fixed, k);
      act(d.fixed[k]);
      const image = twin >= 0 && mirrored(this.mirror, this.fixed, d.fixed[k]);
      if (image && !d.fixed.some((f, j) => j !== twin && f.vertex === image.vertex)) d.fixed[twin] = image;
    }, gesture);
  }

  turnFixed(k, degrees, gesture) {
    this.editFixed(k, (f) => {
      f.direction = this.fixed.turned(f.vertex, degrees);
      delete f.angle;
      delete f.relative_to;
    }, gesture);
  }

  /** To another vertex; the direction is the same in space, as far as it can be. */
  moveFixed(k, hit, gesture) {
    const vertex = this.fixed.vertexAt(hit);
    if (this.design.fixed.some((f) => f.vertex === vertex)) return;
    this.held = k;
    const { face, angle } = this.fixed.item(this.design.fixed[k], this.view.arrays.branch);
    this.editFixed(k, (f) => {
      f.direction = this.fixed.inPlane(vertex, direction(this.view.surface, face, angle));
      f.vertex = vertex;
      delete f.angle;
      delete f.relative_to;
    }, gesture);
  }

  removeFixed(k) {
    this.selected = this.stroked = this.held = -1;
    this.change((d) => {
      const gone = [k, twinOf(this.mirror, this.fixed, d.fixed, k)];
      d.fixed = d.fixed.filter((_, j) => !gone.includes(j));
    });
  }

  editStroke(k, act, gesture) {
    return this.change((d) => {
      const twin = this.mirror.twinStroke(d, k);
      act(d.strokes[k]);
      if (twin >= 0) d.strokes[twin] = this.mirror.stroke(d.strokes[k]);
    }, gesture);
  }

  remove(k) {
    this.selected = this.stroked = this.held = -1;
    this.change((d) => {
      const gone = [k, this.mirror.twin(d, k)];
      d.singularities = d.singularities.filter((_, j) => !gone.includes(j));
    });
  }

  removeStroke(k) {
    this.selected = this.stroked = this.held = -1;
    this.change((d) => {
      const gone = [k, this.mirror.twinStroke(d, k)];
      d.strokes = d.strokes.filter((_, j) => !gone.includes(j));
    });
  }

  removeChosen() {
    if (this.selected >= 0) this.remove(this.selected);
    else if (this.stroked >= 0) this.removeStroke(this.stroked);
    else if (this.held >= 0) this.removeFixed(this.held);
  }

  reshape(points, gesture) {
    this.editStroke(this.stroked, (s) => { s.points = points; }, gesture);
  }

  turn(k, degrees, gesture) {
    this.edit(k, (s) => { s.angle = ((degrees % 360) + 360) % 360; }, gesture);
  }

  /** To another place of the surface. The pattern keeps its direction in space; a swirl has none. */
  move(k, hit, gesture) {
    if (this.design.singularities.some((s, j) => j !== k && s.face === hit.face)) return;
    this.selected = k;
    this.held = -1;
    this.edit(k, (s, d) => {
      if (!swirls(s, d.n) && !s.relative_to && s.face !== hit.face) {
        s.angle = angleIn(this.view.surface, hit.face, direction(this.view.surface, s.face, s.angle || 0));
      }
      s.face = hit.face;
      if (s.pin) s.pin = inside(hit.barycentric);
    }, gesture);
  }

  /** How many zeros singularity k is, side by side. */
  setCount(k, count, gesture) {
    this.edit(k, (s, d) => setIndex(this.view.surface, s, Math.sign(indexOf(s)) * count, d.n), gesture);
  }

  /** What becomes of two singularities that are put onto each other: {text, refused}. */
  meets(k, j) {
    const { index, kind, refused, both } = merging(this.view.surface, this.mirror, this.design, k, j), count = Math.abs(index);
    const sum = fraction(index, this.design.n), sides = both ? ', on both sides' : '';
    if (refused) return { text: `Index ${sum} is more than ${mostZeros} zeros`, refused };
    return { text: index ? `Becomes ${titleOf(kind).toLowerCase()}${count > 1 ? ` × ${count}` : ''}, index ${sum}${sides}` : `Both go: their indices cancel${sides}` };
  }

  /** Singularity k becomes one with number j, in the place of that; both go where their indices cancel. */
  merge(k, j, gesture) {
    const plan = merging(this.view.surface, this.mirror, this.design, k, j);
    if (plan.refused) return;
    this.stroked = this.held = -1;
    this.change((d) => { this.selected = plan.apply(d); }, gesture);
  }

  /** Singularity k becomes as many as it has zeros, or two, around its place. */
  split(k, halves = false) {
    const { singularities: list = [] } = this.design, count = list[k]?.count || 1;
    if (count < 2) return;
    const counts = halves ? [Math.ceil(count / 2), Math.floor(count / 2)] : Array(count).fill(1);
    const made = splitting(this.view.surface, this.mirror, this.design, k, counts, this.view.meta.diagonal);
    if (!made) return this.onStatus('note', `There is no room for ${counts.length} singularities around this one.`);
    this.change(({ singularities: all }) => {
      all[k] = made.parts[0];
      if (made.twin >= 0) all[made.twin] = made.images[0];
      all.push(...made.parts.slice(1), ...made.images.slice(1));
    });
    this.handles.items[k].ring.focus();
  }

  click(event) {
    if (this.tool === 'stroke' || this.tool === 'erase' || !this.design) return;
    const hit = this.view.pick(event);
    this.card.close();
    this.view.highlight(-1);
    if (!hit) return;
    if (this.tool === 'turn') {
      const near = this.view.near(hit.point);
      const placed = near >= 0 && (this.design.singularities || []).some((s) => s.face === this.view.arrays.singular_faces[near]);
      const stroke = near < 0 ? this.strokes.near(hit.point) : -1;
      if (stroke >= 0) this.selectStroke(stroke);
      else this.select(-1);
      if (near >= 0 && !placed) this.card.tell(near);
      else if (near < 0 && stroke < 0) this.card.face(hit.face);
      return;
    }
    if (this.tool === 'cone') return this.addCone(hit);
    const { keys } = this;
    if (this.tool === 'direction') {
      this.addFixed(hit);
      this.choose('turn');
      if (keys) this.handles.items[(this.design.singularities || []).length + this.held]?.ring.focus();
      return;
    }
    const faces = (this.design.singularities || []).map((s) => s.face);
    if (faces.includes(hit.face)) return this.select(faces.indexOf(hit.face));
    this.add({ face: hit.face, kind: this.tool, angle: 0, pin: inside(hit.barycentric) });
    this.choose('turn');
    if (keys) this.handles.items[this.selected]?.ring.focus();  // on with the arrow keys
  }

  addCone(hit) {
    const vertex = this.fixed.vertexAt(hit);
    this.change((d) => {
      const cones = (d.connection.cones ??= []);
      const old = cones.find((c) => c.vertex === vertex);
      if (old) old.index = coneIndex(old.index) + 1 / d.n;
      else cones.push({ vertex, index: 1 / d.n });
    });
  }

  async open(input) {
    const [file] = input.files;
    input.value = '';
    if (!file) return;
    try {
      this.selected = this.stroked = this.held = -1;
      const design = JSON.parse(await file.text());
      delete design.$schema;
      this.store.send(design);
    } catch {
      this.onStatus('problem', 'This file is not JSON.');
    }
  }

  /** What is chosen stays the same control; where it is gone, what an undo brings back in its place, but nothing where others did it. */
  refind(design, mine) {
    for (const [which, name] of [['selected', 'singularities'], ['stroked', 'strokes'], ['held', 'fixed']]) {
      const k = this[which], old = this.shown?.[name] || [], list = design[name] || [], text = JSON.stringify(old[k]);
      if (k < 0 || JSON.stringify(list[k]) === text) continue;
      const there = list.findIndex((c) => JSON.stringify(c) === text);
      if (there >= 0 || (!mine && list.length !== old.length)) this[which] = there;
    }
  }

  /** What can be seen of a design before its field is there. */
  show(design) {
    this.shown = design;
    if (this.selected >= (design.singularities || []).length) this.selected = -1;
    if (this.stroked >= (design.strokes || []).length) this.stroked = -1;
    if (this.held >= (design.fixed || []).length) this.held = -1;
    const singularities = design.singularities || [], directions = (design.fixed || []).map((f) => this.fixed.item(f, this.view.arrays.branch));
    this.handles.set([...singularities, ...directions], this.held >= 0 ? singularities.length + this.held : this.selected);
    this.strokes.show(design.strokes);
    this.sections.controls.refresh(design, this.controls);
    this.sections.field.refresh(design, this.controls);
    this.sections.cones.refresh(design, this.view.meta.euler, !this.view.meta.boundary);
    this.sections.modes.refresh(design, this.view.meta);
    this.stage.draw();
  }

  /** The tools of this symmetry and connection. Those that stay are the buttons that they were. */
  offerTools(n) {
    const kinds = kindsOf(n).map(([kind, sign]) => [kind, h('span', {}, h('i', { class: sign > 0 ? 'mark positive' : 'mark negative' }), titleOf(kind)), `Click where the ${kind} should be`]);
    const all = [['turn', 'Turn', 'Turn the view, select things (V)'], ...kinds, ['direction', 'Direction', 'Click where the direction of the field should be held (D)'], ['stroke', 'Brush', 'Draw along the surface (B)'], ['erase', 'Eraser', 'Erase strokes (E)'], ...(this.trivial() ? [['cone', 'Cone', 'Click where the cone should be (K)']] : [])];
    this.tools.offer(all);
    if (!all.some(([tool]) => tool === this.tool)) this.choose('turn');
  }

  onField(pack) {
    this.view.update(pack);
    this.view.outdate();
    this.showCreases();
    this.time(pack);
  }

  /** How long the field of an edit took, and how much longer it was until it was drawn. */
  time({ meta }) {
    const { since } = this.store, { opened } = this.times;
    this.times = { opened, field: performance.now() - since };
    const { times } = this;
    this.stage.drawn().then((now) => { times.shown = now - since - 1000 * meta.seconds; });
  }

  onState(pack, mine) {
    this.controls = pack.meta.controls;
    const changed = 'branch' in pack.arrays;
    this.view.update(pack);
    if (changed) {
      this.view.outdate();
      this.showCreases();
      this.time(pack);
    }
    this.offerTools(this.design.n);
    this.refind(this.design, mine);
    this.show(this.design);
    this.counts.refresh();
    if (this.colored !== this.view.meta.n) {
      this.colored = this.view.meta.n;
      if (!this.view.meta.offered.some((s) => s.name === this.view.state.color)) this.view.set('color', '');
      this.color.offer();
    }
    this.undoButton.disabled = !pack.meta.undo;
    this.redoButton.disabled = !pack.meta.redo;
    document.documentElement.dataset.revision = pack.meta.revision;
  }

  /** The lines of sharp edges that the design follows. */
  showCreases() {
    const { creases = [], crease_offsets: offsets = [0] } = this.view.arrays, { positions: P } = this.view.surface;
    const points = new Float32Array(3 * creases.length);
    creases.forEach((v, k) => points.set(P.subarray(3 * v, 3 * v + 3), 3 * k));
    this.creases.curves(points, offsets);
  }

  onDetails(pack, part) {
    this.view.update(pack);
    if (part === 'colours') this.color.refresh();
    this.view.apply();
    const { since } = this.store, { times } = this;
    this.stage.drawn().then((now) => {
      times[part] = now - since;
      this.sections.memory.refresh(this.view, times);
    });
  }

  onComplete(result) {
    const { since } = this.store, { times } = this;
    this.stage.drawn().then((now) => {
      times.all = now - since;
      this.sections.memory.refresh(this.view, times);
    });
    document.documentElement.dataset.details = result;
  }

  onStatus(kind, text) {
    // Cones that do not sum up yet are work in progress; their section says how many are missing.
    if (kind === 'problem' && this.sections.cones.missing) [kind, text] = ['note', this.sections.cones.missing];
    this.status.className = `chip ${{ ready: 'good', problem: 'bad', lost: 'bad', note: '' }[kind] ?? ''}`;
    const mode = this.view.meta.mode;
    if (kind === 'ready' && mode) this.status.textContent = `Smoothest field number ${mode}, not part of the design`;
    else this.status.textContent = kind === 'ready' ? (text ? `Solved in ${Math.max(1, Math.round(text * 1000))} ms · saved` : 'Saved') : text;
  }
}

/** The files that the field can be saved as, all that the command line writes: see docs/file-formats.md. */
function makeExports(view) {
  const save = (format, part, text) => h('li', {}, h('a', { href: address('/api/export', { format, part }), onclick: () => dialog.close() }, text));
  const table = (format, text) => [save(format, 0, `${format}: table per face${text}`), save(`vertex.${format}`, 0, `vertex.${format}: table per vertex${text}`)];
  const rosy = save('rosy', 0, 'rosy: one direction per face, for QuadWild');
  const dialog = h('dialog', { class: 'exports', 'aria-label': 'Export' }, h('h2', {}, 'Save the field as'),
    h('ul', {},
      save('ply', 0, 'PLY: mesh and field, which alcap can read'),
      save('vtp', 0, 'VTP: mesh and field, for ParaView'), save('vtp', 1, 'VTP: its singularities'),
      save('rawfield', 0, 'rawfield: vectors per face, for Directional'), save('rawfield', 1, 'sings: its singular vertices'),
      save('vertex.rawfield', 0, 'vertex.rawfield: vectors per vertex, for Directional'), save('vertex.rawfield', 1, 'vertex.sings: its singular faces'),
      rosy, ...table('csv', ', for spreadsheets'), ...table('npy', ', for NumPy'), ...table('dmat', ', for libigl')),
    h('form', { method: 'dialog' }, h('button', { class: 'plain' }, 'Close')));
  dialog.addEventListener('click', (event) => { if (event.target === dialog) dialog.close(); });
  dialog.choose = () => {
    rosy.hidden = view.meta.n !== 4;  // it holds crosses only
    dialog.showModal();
  };
  return dialog;
}
