// SPDX-License-Identifier: MIT
//
// strokes.js: strokes on the surface: drawn by the brush, erased, and the chosen one reshaped by beads along it, which
// are dragged or moved by the arrow keys and take their neighbourhood with them.
import { h } from './dom.js';
import { Lines } from './lines.js';
import { dot, frame, pointIn, subtract } from './tangent.js';

const apart = 0.006;     // of the diagonal: distance of the points of a stroke
const most = 9;          // beads
const bead = 0.05;       // of the diagonal: they are no closer
const rubber = 14;       // pixels: radius of the eraser
const stride = 12;       // pixels that an arrow key moves a bead

export class Strokes {
  constructor(app) {
    this.app = app;
    const d = app.view.meta.diagonal;
    this.lines = new Lines({ variable: '--accent', width: 0.004 * d, widths: [2.5, 5], lift: 0.003, order: 5 });
    this.chosen = new Lines({ variable: '--accent', width: 0.006 * d, widths: [4, 8], lift: 0.0032, order: 6 });
    app.stage.add(this.lines);
    app.stage.add(this.chosen);
    this.beads = [];
    this.drawn = null;  // points of the stroke that is being drawn
    this.left = null;   // strokes, of which the eraser has taken some
    this.listen(app.stage.canvas);
  }

  pointsOf(stroke) {
    if (stroke.vertices) return this.alongVertices(stroke.vertices);
    return (stroke.points || []).filter((p) => p.barycentric).map((p) => pointIn(this.app.view.surface, p.face, p.barycentric));
  }

  /** Of a stroke along edges, from a file: straight on over the surface from one vertex to the next. */
  alongVertices(vertices) {
    const { surface } = this.app.view, key = vertices.join(), step = apart * this.app.stage.diagonal;
    this.edges ??= new Map();
    if (!this.edges.has(key)) {
      const corners = vertices.map((v) => Array.from(surface.positions.subarray(3 * v, 3 * v + 3)));
      this.edges.set(key, corners.flatMap((to, k) => {
        const from = corners[k - 1];
        if (!from) return [to];
        const way = subtract(to, from), steps = Math.max(1, Math.min(200, Math.ceil(Math.hypot(...way) / (3 * step))));
        return Array.from({ length: steps }, (_, i) => (i + 1 === steps ? to : surface.nearest(from.map((x, c) => x + ((i + 1) / steps) * way[c])).point));
      }));
    }
    return this.edges.get(key);
  }

  /** The stroke that passes closest to a point of the surface, within a little; -1 for none. */
  near(point) {
    let best = 0.012 * this.app.stage.diagonal, found = -1;
    (this.app.design.strokes || []).forEach((stroke, k) => {
      for (const p of this.pointsOf(stroke)) {
        const distance = Math.hypot(...p.map((x, c) => x - point[c]));
        if (distance < best) [best, found] = [distance, k];
      }
    });
    return found;
  }

  /** Draws the strokes of a design, and one that is being drawn. */
  show(strokes = [], extra = []) {
    const lines = strokes.map((s) => this.pointsOf(s));
    draw(this.lines, [...lines, extra]);
    draw(this.chosen, [lines[this.app.stroked] || []]);
    this.setBeads(strokes[this.app.stroked]);
    this.app.stage.draw();
  }

  listen(canvas) {
    let pointer = false;
    canvas.addEventListener('pointerdown', (event) => {
      const { tool } = this.app;
      if (!['stroke', 'erase'].includes(tool) || !event.isPrimary || event.button !== 0) return;
      canvas.setPointerCapture(event.pointerId);
      this.drop();
      pointer = true;
      if (tool === 'stroke') this.begin(event);
      else this.beginRub(event);
    });
    canvas.addEventListener('pointermove', (event) => {
      if (!pointer) return;
      if (this.drawn) this.add(event);
      else if (this.left) this.rub(event);
    });
    const end = (event) => {
      if (pointer) this.finish(event.type === 'pointerup');
      pointer = false;
    };
    canvas.addEventListener('pointerup', end);
    canvas.addEventListener('pointercancel', end);
  }

  /** Enter: begins a stroke at a place on screen, and ends it there. Between the two, follow() draws. */
  pen(place) {
    if (this.drawn) return this.finish(true, true);
    this.begin(place);
    if (!this.drawn.length) this.drawn = null;  // beside the surface
  }

  /** Before each picture: the surface has turned under the place where a stroke is drawn by the keyboard. */
  follow(place) {
    if (this.drawn) this.add(place);
  }

  /** Enter: erases at a place on screen. */
  wipe(place) {
    this.beginRub(place);
    this.finish(true);
  }

  /** Forgets what is being drawn; whether there was something. */
  drop() {
    const was = Boolean(this.drawn || this.left);
    this.finish(false);
    return was;
  }

  begin(event) {
    this.drawn = [];
    this.add(event);
  }

  beginRub(event) {
    this.left = this.app.design.strokes || [];
    this.rub(event);
  }

  /** The stroke goes on to a place on screen; a long way in steps over the surface. */
  add(event) {
    const { stage, view } = this.app, step = apart * stage.diagonal;
    const hit = view.pick(event), last = this.drawn.at(-1);
    const far = hit && last ? Math.hypot(...subtract(hit.point, last.point)) : Infinity;
    if (!hit || far <= step) return;
    const steps = last ? Math.min(40, Math.ceil(far / (3 * step))) : 1;
    for (let k = 1; k < steps; ++k) this.drawn.push(view.surface.nearest(last.point.map((x, c) => x + (k / steps) * (hit.point[c] - x))));
    this.drawn.push(hit);
    this.show(this.app.design.strokes, this.drawn.map((p) => p.point));
  }

  rub(event) {
    const hit = this.app.view.pick(event);
    if (!hit) return;
    this.left = this.rubbed(this.left, hit.point);
    const { mirror } = this.app;
    if (mirror.axis >= 0) this.left = this.rubbed(this.left, mirror.place(hit).point);
    this.show(this.left);
  }

  /** Keeps what was drawn or erased, or not. choose: the new stroke is then the chosen one. */
  finish(keep, choose = false) {
    const { drawn, left, app } = this;
    this.drawn = this.left = null;
    if (drawn?.length > 1 && keep) {
      app.addStroke({ points: drawn.map(({ face, barycentric }) => ({ face, barycentric })), weight: 10 }, choose);
    } else if (drawn) {
      this.show(app.design.strokes);
    }
    if (left && left !== app.design.strokes) {
      if (keep) {
        app.stroked = -1;
        app.change((d) => { d.strokes = left; });
      } else {
        this.show(app.design.strokes);
      }
    }
  }

  /** What is left of strokes when the eraser has been at a point; the same list where it met none. */
  rubbed(strokes, point) {
    const { stage, view } = this.app;
    const pixel = (2 * stage.camera.position.distanceTo(stage.controls.target.clone().set(...point)) * Math.tan((stage.camera.fov * Math.PI) / 360)) / stage.height;
    let met = false;
    const left = strokes.flatMap((s) => {
      if (!s.points) return [s];
      const runs = [[]];
      for (const p of s.points) {
        const gone = Math.hypot(...subtract(pointIn(view.surface, p.face, p.barycentric), point)) < rubber * pixel;
        met ||= gone;
        if (!gone) runs.at(-1).push(p);
        else if (runs.at(-1).length) runs.push([]);
      }
      return runs.filter((r) => r.length > 1).map((r) => ({ ...s, points: r }));
    });
    return met ? left : strokes;
  }

  // ---- beads

  setBeads(stroke) {
    const points = stroke?.points?.every((p) => p.barycentric) ? stroke.points : [];
    this.points = points;
    const places = this.pointsOf({ points }), arc = [0];
    for (let i = 1; i < places.length; ++i) arc.push(arc[i - 1] + Math.hypot(...subtract(places[i], places[i - 1])));
    this.arc = arc;
    const length = arc.at(-1), number = points.length < 2 ? 0 : Math.max(2, Math.min(most, points.length, 1 + Math.floor(length / (bead * this.app.stage.diagonal))));
    this.gap = length / Math.max(number - 1, 1);
    this.at = Array.from({ length: number }, (_, k) => {
      const wanted = k * this.gap;
      return arc.reduce((best, s, i) => (Math.abs(s - wanted) < Math.abs(arc[best] - wanted) ? i : best), 0);
    });
    while (this.beads.length > number) this.beads.pop().remove();
    while (this.beads.length < number) {
      const k = this.beads.length;
      const button = h('button', { type: 'button', class: 'bead', 'aria-label': `Point ${k + 1} of the stroke` });
      this.makeMovable(button, k);
      this.app.handles.layer.append(button);
      this.beads.push(button);
    }
  }

  makeMovable(button, k) {
    button.addEventListener('keydown', (event) => {
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      if (!step) return;
      event.preventDefault();
      event.stopPropagation();
      this.app.reshape(this.bent(k, stride * step[0], stride * step[1], this.points, this.arc), 'bead-keys');
    });
    button.addEventListener('pointerdown', (down) => {
      if (!down.isPrimary || down.button !== 0) return;
      button.setPointerCapture(down.pointerId);
      const gesture = `bead-${Date.now()}`, { points, arc } = this;
      const drag = (event) => this.app.reshape(this.bent(k, event.clientX - down.clientX, event.clientY - down.clientY, points, arc), gesture);
      const up = () => {
        button.removeEventListener('pointermove', drag);
        this.app.store.rest();
      };
      button.addEventListener('pointermove', drag);
      button.addEventListener('pointerup', up, { once: true });
      button.addEventListener('pointercancel', up, { once: true });
    });
  }

  /** The points of the stroke with bead k moved by so many pixels; its neighbours follow, up to the next beads. */
  bent(k, dx, dy, points, arc) {
    const { app, at, gap } = this;
    const box = app.stage.canvas.getBoundingClientRect();
    return points.map((p, i) => {
      const away = Math.abs(arc[i] - arc[at[k]]) / gap;
      if (away >= 1) return p;
      const share = Math.cos((Math.PI / 2) * away) ** 2;
      const [x, y] = app.handles.project(pointIn(app.view.surface, p.face, p.barycentric));
      const hit = app.view.pick({ clientX: box.left + x + share * dx, clientY: box.top + y + share * dy });
      return hit ? { face: hit.face, barycentric: hit.barycentric } : p;
    });
  }

  /** Where the beads are on screen; called before each picture. */
  place() {
    const { stage, surface } = { stage: this.app.stage, surface: this.app.view.surface };
    const eye = stage.camera.position.toArray();
    this.beads.forEach((button, k) => {
      const p = this.points[this.at[k]];
      const center = pointIn(surface, p.face, p.barycentric), away = subtract(center, eye), length = Math.hypot(...away);
      const hit = dot(away, frame(surface, p.face).normal) < 0 && surface.hit({ x: eye[0], y: eye[1], z: eye[2] }, { x: away[0] / length, y: away[1] / length, z: away[2] / length });
      button.hidden = !(hit && Math.hypot(...subtract(hit.point, eye)) > length * 0.995);
      const [x, y] = this.app.handles.project(center);
      button.style.transform = `translate(${x}px, ${y}px)`;
    });
  }
}

/** Lists of points as one set of curves. */
function draw(lines, curves) {
  lines.curves(new Float32Array(curves.flat(2)), curves.reduce((all, l) => [...all, all.at(-1) + l.length], [0]));
}
