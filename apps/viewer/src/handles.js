// SPDX-License-Identifier: MIT
//
// handles.js: the controls of the design as buttons over the picture: a ring where a singularity was asked for, a square
// where a direction is held, which can be dragged, and for the chosen one a knob on a line that turns it; both by the
// mouse or by the arrow keys. A ring that is put onto another one says what the two become, and merges when it is let go.
import { Raycaster, Vector2, Vector3 } from 'three';

import { h, matched } from './dom.js';
import { isNegative } from './indices.js';
import { angleOfRay, direction, dot, frame, pointIn, subtract } from './tangent.js';

const reach = 58;  // pixels from ring to knob
const stride = 12;  // pixels that an arrow key moves a ring
const onto = 14;  // pixels between a ring and another one that it is put onto

export class Handles {
  /** actions: select(k), turn(k, degrees, gesture), move(k, hit, gesture), meets(k, j): {text, refused} of two that merge, or null, merge(k, j, gesture), stop(). */
  constructor(view, actions) {
    this.view = view;
    this.actions = actions;
    this.layer = h('div', { class: 'handles' });
    this.items = [];
    this.object = { isObject3D: true };
    this.said = h('p', { class: 'meeting-said', role: 'status' });
    this.layer.append(this.said);
    this.meeting = null;  // of two rings: {k, j, text, refused}
  }

  set(singularities, selected) {
    this.singularities = singularities;
    if (this.meeting && Math.max(this.meeting.k, this.meeting.j) >= singularities.length) this.meet(null);
    this.selected = selected;
    const before = this.items;
    this.items = matched(before, singularities, () => this.makeItem());
    for (const item of before) if (!this.items.includes(item)) item.ring.remove();
    singularities.forEach((s, k) => {
      const { ring } = Object.assign(this.items[k], { k });
      const met = this.meeting?.j === k ? ` meeting${this.meeting.refused ? ' refused' : ''}` : '';
      ring.className = `ring ${s.kind === 'direction' ? 'square' : isNegative(s.kind) ? 'negative' : 'positive'}${k === selected ? ' chosen' : ''}${met}`;
      ring.setAttribute('aria-label', s.kind === 'direction' ? `direction at vertex ${s.vertex}` : `${s.kind} in face ${s.face}`);
      ring.setAttribute('aria-pressed', String(k === selected));
    });
    this.knob ??= this.makeKnob();
    this.place();
  }

  /** A ring, with the number k of what it stands for, which is another one after edits. */
  makeItem() {
    const item = { k: -1, ring: h('button', { type: 'button', class: 'ring', onclick: () => this.actions.select(item.k) }) };
    this.makeMovable(item);
    this.layer.insertBefore(item.ring, this.line ?? null);  // from the rings the next one by Tab is the knob
    return item;
  }

  /** Dragging, or the arrow keys, move the singularity to what is under the pointer; on another one it waits to be merged. */
  makeMovable(item) {
    const { ring } = item;
    /** beside: of a ring that it was on before. Whether it still is. */
    const move = (place, gesture, beside = -1) => {
      const met = this.metBy(item.k, place), left = met?.j !== beside;
      this.meet(left ? met : null);
      const hit = this.meeting ? null : this.view.pick(place);
      if (hit) this.actions.move(item.k, hit, gesture);
      return !left;
    };
    ring.addEventListener('keydown', (event) => this.pressed(event, item.k, move));
    ring.addEventListener('blur', () => this.meet(null));
    ring.addEventListener('pointerdown', (down) => {
      if (!down.isPrimary || down.button !== 0) return;
      ring.setPointerCapture(down.pointerId);
      const gesture = `move-${Date.now()}`;
      let moved = false, beside = this.metBy(item.k, down)?.j ?? -1;  // to be merged it has to leave that first
      const drag = (event) => {
        moved ||= Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) > 4;
        if (moved && !move(event, gesture, beside)) beside = -1;
      };
      const up = (event) => {
        ring.removeEventListener('pointermove', drag);
        ring.removeEventListener('pointerup', up);
        ring.removeEventListener('pointercancel', up);
        if (event.type === 'pointerup') this.merge(gesture);
        this.meet(null);
        this.actions.stop();
      };
      ring.addEventListener('pointermove', drag);
      ring.addEventListener('pointerup', up);
      ring.addEventListener('pointercancel', up);
    });
  }

  /** Keys on a ring: arrows move it; where they have put it onto another one, Enter merges the two and Esc does not. */
  pressed(event, k, move) {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    const ends = this.meeting && ['Enter', 'Escape'].includes(event.key);
    if (!step && !ends) return;
    event.preventDefault();
    event.stopPropagation();
    if (ends) {
      const merged = event.key === 'Enter' && this.merge('');
      this.meet(null);
      if (merged) (this.items[this.selected]?.ring || this.view.stage.canvas).focus();
      return;
    }
    const box = this.view.stage.canvas.getBoundingClientRect();
    const s = this.singularities[k], [x, y] = this.project(this.center(s));
    // Away from a ring that it is on already it just moves. Directions sit at vertices: as far as it is to another one.
    const now = this.metBy(k, { clientX: box.left + x, clientY: box.top + y });
    for (let far = 1; far <= (s.kind === 'direction' ? 12 : 1); ++far) {
      const place = { clientX: box.left + x + far * stride * step[0], clientY: box.top + y + far * stride * step[1] };
      if (s.kind === 'direction' && this.vertexUnder(place) === s.vertex) continue;
      const next = this.metBy(k, place);
      return move(place, 'move-keys', next && now?.j === next.j && next.distance > now.distance ? next.j : -1);
    }
  }

  /** Another ring at a place on screen that ring k can be merged with, and what the two become; null for none. */
  metBy(k, place) {
    const box = this.view.stage.canvas.getBoundingClientRect(), at = [place.clientX - box.left, place.clientY - box.top];
    let best = onto, found = -1;
    this.singularities.forEach((s, j) => {
      if (j === k || this.items[j].ring.hidden) return;
      const [x, y] = this.project(this.center(s)), distance = Math.hypot(x - at[0], y - at[1]);
      if (distance < best) [best, found] = [distance, j];
    });
    const said = found < 0 ? null : this.actions.meets(k, found);
    return said && { k, j: found, distance: best, ...said };
  }

  /** Says what two rings become; nothing any more for null. */
  meet(meeting) {
    if (!meeting && !this.meeting) return;
    this.meeting = meeting;
    this.said.textContent = meeting?.text || '';
    this.said.classList.toggle('refused', Boolean(meeting?.refused));
    this.set(this.singularities, this.selected);
    this.view.stage.draw();
  }

  /** Merges the two that have met; whether they did. */
  merge(gesture) {
    const { meeting } = this;
    if (!meeting || meeting.refused) return false;
    this.actions.merge(meeting.k, meeting.j, gesture);
    return true;
  }

  /** The corner nearest to the pointer of the face under it; -1 for none. */
  vertexUnder(place) {
    const hit = this.view.pick(place);
    return hit ? this.view.surface.faces[3 * hit.face + hit.barycentric.indexOf(Math.max(...hit.barycentric))] : -1;
  }

  makeKnob() {
    const knob = h('button', { type: 'button', class: 'knob', role: 'slider', 'aria-label': 'Turn', 'aria-valuemin': '0', 'aria-valuemax': '360', onkeydown: (event) => {
      const step = { ArrowLeft: 5, ArrowUp: 5, ArrowRight: -5, ArrowDown: -5 }[event.key];
      if (!step) return;
      event.preventDefault();
      event.stopPropagation();
      this.actions.turn(this.selected, (this.singularities[this.selected].angle || 0) + step, 'keys');
    } });
    const line = h('i', { class: 'spoke', 'aria-hidden': 'true' });
    this.layer.append(line, knob);
    this.line = line;
    knob.addEventListener('pointerdown', (down) => {
      down.preventDefault();
      knob.setPointerCapture(down.pointerId);
      const gesture = `turn-${Date.now()}`;
      const start = this.angleAt(down), from = this.singularities[this.selected].angle || 0;
      const move = (event) => {
        const angle = this.angleAt(event);
        if (angle === null || start === null) return;
        this.actions.turn(this.selected, from + angle - start, gesture);
      };
      const up = () => {
        knob.removeEventListener('pointermove', move);
        this.actions.stop();
      };
      knob.addEventListener('pointermove', move);
      knob.addEventListener('pointerup', up, { once: true });
      knob.addEventListener('pointercancel', up, { once: true });
    });
    return knob;
  }

  ray(event) {
    const { stage } = this.view;
    const box = stage.canvas.getBoundingClientRect();
    const caster = new Raycaster();
    caster.setFromCamera(new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2), stage.camera);
    return caster.ray;
  }

  center(s) {
    return pointIn(this.view.surface, s.face, Array.isArray(s.pin) ? s.pin : [1 / 3, 1 / 3, 1 / 3]);
  }

  angleAt(event) {
    const s = this.singularities[this.selected];
    const { origin, direction: d } = this.ray(event);
    return angleOfRay(this.view.surface, s.face, this.center(s), origin.toArray(), d.toArray());
  }

  project(point) {
    const { stage } = this.view;
    const p = new Vector3(...point).project(stage.camera);
    return [((p.x + 1) / 2) * stage.width, ((1 - p.y) / 2) * stage.height];
  }

  /** Where everything is on screen; called before each picture. */
  place() {
    const { stage, surface } = this.view;
    const eye = stage.camera.position.toArray();
    let shown = false;
    (this.singularities || []).forEach((s, k) => {
      const center = this.center(s), { normal } = frame(surface, s.face);
      const away = subtract(center, eye), length = Math.hypot(...away);
      // Not moving: see whether something is in front.
      const hit = dot(away, normal) < 0 && surface.hit({ x: eye[0], y: eye[1], z: eye[2] }, { x: away[0] / length, y: away[1] / length, z: away[2] / length });
      const seen = hit && Math.hypot(...subtract(hit.point, eye)) > length * 0.995;
      const [x, y] = this.project(center);
      const { ring } = this.items[k];
      ring.hidden = !seen;
      ring.style.transform = `translate(${x}px, ${y}px)`;
      if (k === this.meeting?.j) this.said.style.transform = `translate(${x}px, ${y}px)`;
      if (k !== this.selected || !seen) return;
      shown = true;
      const d = direction(surface, s.face, s.angle || 0, s.relative_to);
      const step = 1e-3 * this.view.meta.diagonal;
      const [u, v] = this.project([0, 1, 2].map((c) => center[c] + step * d[c]));
      const turn = Math.atan2(v - y, u - x);
      this.knob.style.transform = `translate(${x + reach * Math.cos(turn)}px, ${y + reach * Math.sin(turn)}px)`;
      this.line.style.transform = `translate(${x}px, ${y}px) rotate(${turn}rad)`;
      this.knob.setAttribute('aria-valuenow', String(Math.round((((s.angle || 0) % 360) + 360) % 360)));
    });
    if (this.knob) this.knob.hidden = this.line.hidden = !shown;
  }
}
