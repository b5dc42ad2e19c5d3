// SPDX-License-Identifier: MIT
//
// studio.js: the page in which fields are designed: tools on the left, the surface, the design on the right.
import { address, ask } from './api.js';
import { fraction, h, segmented } from './dom.js';
import { Handles } from './handles.js';
import { listen, onClick, viewKeys } from './keys.js';
import { Lines } from './lines.js';
import { colorSection, makeHelp, makePanel, mark, singularitySection } from './panel.js';
import { View } from './scene.js';
import { Store } from './store.js';
import { coneIndex, conesSection, controlsSection, fieldSection, kindsOf, showSection, titleOf } from './studio_panel.js';
import { angleIn, barycentricIn, direction, pointIn } from './tangent.js';
import { makePictures } from './view.js';

const studioKeys = [['V', 'Turn and choose'], ['A', 'Source or wedge'], ['Z', 'Saddle or trisector'], ['B', 'Draw strokes'], ['Ctrl+Z', 'Undo'], ['Ctrl+Shift+Z', 'Redo'], ['Del', 'Remove the chosen one'], ['Esc', 'Back to turning']];

export async function startStudio(stage, ui, boot) {
  const mesh = await ask('/api/mesh');
  const app = new Studio(stage, ui, mesh, boot);
  await app.store.load();
  return app;
}

class Studio {
  constructor(stage, ui, mesh) {
    this.stage = stage;
    this.selected = -1;  // of the singularities
    this.stroked = -1;   // of the strokes
    this.tool = 'turn';
    this.view = new View(stage, mesh);
    this.title = mesh.meta.title;
    this.stroke = new Lines({ variable: '--accent', width: 0.004 * mesh.meta.diagonal, widths: [2.5, 5], lift: 0.003, order: 5 });
    stage.add(this.stroke);
    this.handles = new Handles(this.view, {
      select: (k) => this.select(k),
      turn: (k, degrees, gesture) => this.turn(k, degrees, gesture),
      move: (k, hit, gesture) => this.move(k, hit, gesture),
      stop: () => { this.store.gesture = ''; },
    });
    stage.before = () => this.handles.place();
    this.store = new Store({
      state: (pack, mine) => this.onState(pack, mine), follow: (pack) => this.onField(pack),
      details: (pack) => this.onDetails(pack), status: (kind, text) => this.onStatus(kind, text),
    });
    this.status = h('span', { class: 'chip', role: 'status' }, 'Starting…');
    this.sections = { field: fieldSection(this), controls: controlsSection(this), cones: conesSection(this) };
    this.counts = singularitySection(this.view);
    this.colors = h('div', {});
    const header = h('header', {}, h('h1', {}, this.title), this.status);
    this.panel = makePanel(header, this.sections.controls, this.sections.cones, this.sections.field, showSection(this.view), this.colors, this.counts);
    this.tools = h('nav', { class: 'toolbox', 'aria-label': 'Tools' });
    this.help = makeHelp([...studioKeys, ...viewKeys.filter(([k]) => k !== '?')]);
    this.undoButton = h('button', { type: 'button', title: 'Undo (Ctrl+Z)', onclick: () => this.store.step('undo') }, 'Undo');
    this.redoButton = h('button', { type: 'button', title: 'Redo (Ctrl+Shift+Z)', onclick: () => this.store.step('redo') }, 'Redo');
    this.exports = makeExports();
    this.pictures = makePictures(stage, this.title);
    const file = h('input', { type: 'file', accept: '.json,application/json', hidden: true, onchange: () => this.open(file) });
    const menu = h('nav', { class: 'tools', 'aria-label': 'Design' }, this.undoButton, this.redoButton, h('i', {}),
      h('button', { type: 'button', title: 'Open a design.json', onclick: () => file.click() }, 'Open'),
      h('button', { type: 'button', title: 'Save design.json', onclick: () => { location.href = address('/api/design'); } }, 'Save'),
      h('button', { type: 'button', title: 'Save the field for another program', onclick: () => this.exports.showModal() }, 'Export'),
      h('button', { type: 'button', title: 'Save a picture (P)', class: 'wide', onclick: () => this.pictures.choose() }, 'Picture'),
      h('button', { type: 'button', title: 'Keys (?)', class: 'wide', onclick: () => this.help.showModal() }, 'Keys'), file);
    this.card = h('div', { class: 'card', role: 'status', hidden: true });
    ui.append(this.handles.layer, this.panel, this.tools, menu, this.card, this.help, this.exports, this.pictures);
    stage.resize();
    stage.frame(mesh.meta.diagonal);
    onClick(stage.canvas, (event) => this.click(event));
    this.drawing(stage.canvas);
    const tool = (name) => () => this.choose(name);
    listen(stage, {
      v: tool('turn'), Escape: tool('turn'), b: tool('stroke'), k: () => this.trivial() && this.choose('cone'),
      a: () => this.choose(kindsOf(this.design.n)[0][0]), z: () => this.choose(kindsOf(this.design.n).at(-1)[0]),
      'Ctrl+z': () => this.store.step('undo'), 'Ctrl+Shift+z': () => this.store.step('redo'), 'Ctrl+y': () => this.store.step('redo'),
      Delete: () => this.removeChosen(), Backspace: () => this.removeChosen(), p: () => this.pictures.choose(), '?': () => this.help.showModal(),
    });
  }

  get design() { return this.store.design; }

  trivial() { return this.design.connection?.kind === 'trivial'; }

  /** Edits a copy of the design and sends it. */
  change(edit, gesture = '') {
    const design = structuredClone(this.design);
    edit(design);
    this.show(design);
    return this.store.send(design, gesture);
  }

  choose(tool) {
    this.tool = tool;
    this.stage.controls.enabled = tool !== 'stroke';
    this.stage.canvas.classList.toggle('aim', tool !== 'turn');
    this.tools.set?.(tool);
  }

  select(k) {
    this.selected = k;
    this.stroked = -1;
    this.show(this.design);
  }

  selectStroke(k) {
    this.selected = -1;
    this.stroked = k;
    this.show(this.design);
  }

  remove(k) {
    this.selected = this.stroked = -1;
    this.change((d) => { d.singularities.splice(k, 1); });
  }

  removeStroke(k) {
    this.selected = this.stroked = -1;
    this.change((d) => { d.strokes.splice(k, 1); });
  }

  removeChosen() {
    if (this.selected >= 0) this.remove(this.selected);
    else if (this.stroked >= 0) this.removeStroke(this.stroked);
  }

  /** The stroke that passes closest to a point of the surface, within a little; -1 for none. */
  strokeAt(point) {
    let best = 0.012 * this.stage.diagonal, found = -1;
    (this.design.strokes || []).forEach((stroke, k) => {
      for (const p of this.pointsOf(stroke)) {
        const distance = Math.hypot(...p.map((x, c) => x - point[c]));
        if (distance < best) [best, found] = [distance, k];
      }
    });
    return found;
  }

  pointsOf(stroke) {
    return (stroke.points || []).filter((p) => p.barycentric).map((p) => pointIn(this.view.surface, p.face, p.barycentric));
  }

  turn(k, degrees, gesture) {
    this.change((d) => { d.singularities[k].angle = ((degrees % 360) + 360) % 360; }, gesture);
  }

  /** To another place of the surface. The pattern keeps its direction in space; a swirl has none. */
  move(k, hit, gesture) {
    if (this.design.singularities.some((s, j) => j !== k && s.face === hit.face)) return;
    this.selected = k;
    this.change((d) => {
      const s = d.singularities[k];
      const swirls = d.n === 1 && s.kind !== 'saddle';
      if (!swirls && !s.relative_to && s.face !== hit.face) {
        s.angle = angleIn(this.view.surface, hit.face, direction(this.view.surface, s.face, s.angle || 0));
      }
      s.face = hit.face;
      if (s.pin) s.pin = inside(hit.barycentric);
    }, gesture);
  }

  /** A singularity that the field has of its own: what it is, and a button that makes it a control. */
  tell(number) {
    const { singular, singular_faces: faces } = this.view.arrays;
    const index = singular[8 * number + 6], face = faces[number], { n } = this.design;
    const hold = () => {
      this.card.hidden = true;
      this.selected = (this.design.singularities || []).length;
      const kind = kindsOf(n)[index > 0 ? 0 : kindsOf(n).length - 1][0];
      const pin = inside(barycentricIn(this.view.surface, face, singular.slice(8 * number, 8 * number + 3)));
      this.change((d) => { (d.singularities ??= []).push({ face, kind, angle: (singular[8 * number + 7] * 180) / Math.PI, pin }); });
    };
    const { euler, boundary } = this.view.meta;
    const sum = euler === undefined || boundary ? '' : ` All indices sum to ${String(euler).replace('-', '−')}, so others make up for those you place.`;
    this.card.replaceChildren(
      h('p', { class: 'head' }, mark(index), ` Singularity ${fraction(index, n)}`),
      h('button', { type: 'button', class: 'close', 'aria-label': 'Close', onclick: () => { this.card.hidden = true; } }, '×'),
      h('p', { class: 'quiet' }, `Nobody asked for it: the field needs it here.${sum}`),
      ...(Math.abs(index) === 1 ? [h('button', { type: 'button', class: 'primary', onclick: hold }, 'Hold it here')] : []));
    this.card.hidden = false;
  }

  click(event) {
    if (this.tool === 'stroke' || !this.design) return;
    const hit = this.view.pick(event);
    this.card.hidden = true;
    if (!hit) return;
    if (this.tool === 'turn') {
      const near = this.view.near(hit.point);
      const placed = near >= 0 && (this.design.singularities || []).some((s) => s.face === this.view.arrays.singular_faces[near]);
      const stroke = near < 0 ? this.strokeAt(hit.point) : -1;
      if (stroke >= 0) this.selectStroke(stroke);
      else this.select(-1);
      if (near >= 0 && !placed) this.tell(near);
      return;
    }
    if (this.tool === 'cone') return this.addCone(hit);
    const pin = inside(hit.barycentric);
    const faces = (this.design.singularities || []).map((s) => s.face);
    if (faces.includes(hit.face)) return this.select(faces.indexOf(hit.face));
    this.selected = faces.length;
    this.change((d) => { (d.singularities ??= []).push({ face: hit.face, kind: this.tool, angle: 0, pin }); });
    this.choose('turn');
  }

  addCone(hit) {
    const corner = hit.barycentric.indexOf(Math.max(...hit.barycentric));
    const vertex = this.view.surface.faces[3 * hit.face + corner];
    this.change((d) => {
      const cones = (d.connection.cones ??= []);
      const old = cones.find((c) => c.vertex === vertex);
      if (old) old.index = coneIndex(old.index) + 1 / d.n;
      else cones.push({ vertex, index: 1 / d.n });
    });
  }

  drawing(canvas) {
    let points = null;
    const spacing = () => 0.006 * this.stage.diagonal;
    const add = (event) => {
      const hit = this.view.pick(event);
      const last = points.at(-1);
      if (hit && (!last || Math.hypot(...hit.point.map((x, c) => x - last.point[c])) > spacing())) points.push(hit);
      this.preview(points);
    };
    canvas.addEventListener('pointerdown', (event) => {
      if (this.tool !== 'stroke' || !event.isPrimary || event.button !== 0) return;
      points = [];
      canvas.setPointerCapture(event.pointerId);
      add(event);
    });
    canvas.addEventListener('pointermove', (event) => { if (points) add(event); });
    canvas.addEventListener('pointerup', () => {
      if (points?.length > 1) this.change((d) => { (d.strokes ??= []).push({ points: points.map(({ face, barycentric }) => ({ face, barycentric })), weight: 10 }); });
      points = null;
    });
  }

  preview(points = []) {
    const lines = [...(this.design?.strokes || []).map((s) => this.pointsOf(s)), points.map((p) => p.point)];
    this.stroke.curves(new Float32Array(lines.flat(2)), lines.reduce((all, l) => [...all, all.at(-1) + l.length], [0]));
    this.stage.draw();
  }

  async open(input) {
    const [file] = input.files;
    input.value = '';
    if (!file) return;
    try {
      this.selected = -1;
      const design = JSON.parse(await file.text());
      delete design.$schema;
      this.store.send(design);
    } catch {
      this.onStatus('problem', 'This file is not JSON.');
    }
  }

  /** What can be seen of a design before its field is there. */
  show(design) {
    if (this.selected >= (design.singularities || []).length) this.selected = -1;
    if (this.stroked >= (design.strokes || []).length) this.stroked = -1;
    this.handles.set(design.singularities || [], this.selected);
    this.sections.controls.refresh(design, this.controls);
    this.sections.field.refresh(design);
    this.sections.cones.refresh(design, this.view.meta.euler, !this.view.meta.boundary);
    this.stage.draw();
  }

  makeTools(n) {
    if (this.toolsFor === `${n}${this.trivial()}`) return;
    this.toolsFor = `${n}${this.trivial()}`;
    const kinds = kindsOf(n).map(([kind, sign]) => [kind, h('span', {}, h('i', { class: sign > 0 ? 'mark positive' : 'mark negative' }), titleOf(kind)), `Click where the ${kind} shall be`]);
    const bar = segmented('Tool', [['turn', 'Turn', 'Turn the view, choose what is there (V)'], ...kinds, ['stroke', 'Brush', 'Draw along the surface (B)'], ...(this.trivial() ? [['cone', 'Cone', 'Click where the cone shall be (K)']] : [])], this.tool, (t) => this.choose(t));
    this.tools.replaceChildren(bar);
    this.tools.set = bar.set;
  }

  onField(pack) {
    this.view.update(pack);
    this.view.stale = true;
    this.view.apply();
  }

  onState(pack) {
    this.controls = pack.meta.controls;
    const changed = 'branch' in pack.arrays;
    this.view.update(pack);
    if (changed) this.view.stale = true;
    this.view.apply();
    this.makeTools(this.design.n);
    this.show(this.design);
    this.preview();
    this.counts.refresh();
    this.undoButton.disabled = !pack.meta.undo;
    this.redoButton.disabled = !pack.meta.redo;
    document.documentElement.dataset.revision = pack.meta.revision;
  }

  onDetails(pack) {
    this.view.stale = false;
    this.view.update(pack);
    if (!this.colored) {
      this.colored = true;
      this.colors.append(colorSection(this.view));
    }
    this.view.apply();
    document.documentElement.dataset.details = pack.meta.result;
  }

  onStatus(kind, text) {
    // Cones that do not sum up yet are work in progress; their section says how many are missing.
    if (kind === 'problem' && this.sections.cones.missing) [kind, text] = ['note', this.sections.cones.missing];
    this.status.className = `chip ${{ ready: 'good', problem: 'bad', lost: 'bad', note: '' }[kind] ?? ''}`;
    this.status.textContent = kind === 'ready' ? (text ? `Solved in ${Math.max(1, Math.round(text * 1000))} ms · saved` : 'Saved') : text;
  }
}

/** The files that the field can be saved as: see docs/file-formats.md. */
function makeExports() {
  const save = (format, part, text) => h('li', {}, h('a', { href: address('/api/export', { format, part }), onclick: () => dialog.close() }, text));
  const dialog = h('dialog', { class: 'exports', 'aria-label': 'Export' }, h('h2', {}, 'Save the field as'),
    h('ul', {},
      save('ply', 0, 'PLY: mesh and field, read again by alcap'),
      save('vtp', 0, 'VTP: mesh and field, for ParaView'), save('vtp', 1, 'VTP: its singularities'),
      save('rawfield', 0, 'rawfield: vectors per vertex, for Directional'), save('rawfield', 1, 'sings: its singularities'),
      save('rosy', 0, 'rosy: one direction per face, for QuadWild')),
    h('form', { method: 'dialog' }, h('button', { class: 'plain' }, 'Close')));
  dialog.addEventListener('click', (event) => { if (event.target === dialog) dialog.close(); });
  return dialog;
}

/** A zero on an edge belongs to neither face: a little inside. */
function inside(barycentric) {
  return barycentric.map((b) => 0.08 / 1.24 + Math.min(Math.max(b, 0), 1) / 1.24);
}
