// SPDX-License-Identifier: MIT
//
// store.js: the design as this tab knows it, and its way to the server and back. Edits go one at a time; while one is
// being solved, later ones of a gesture replace each other, so that the field follows the hand as fast as it can. What
// is drawn besides the field is asked for when the hand rests, one part after the other, and no longer when the field
// is another by then.
import { ask, Refused } from './api.js';

const quietTime = 120;  // ms without an edit before curves are asked for, where nothing says that the hand rests

export class Store {
  /** listeners: state(pack, mine), follow(pack), parts(): names of what is to be drawn, details(pack, part), complete(result, ms), status(kind, text). */
  constructor(listeners) {
    this.listeners = listeners;
    this.revision = 0;
    this.result = 0;
    this.busy = false;
    this.next = null;
    this.loaded = {};  // part: the result that it belongs to
    this.since = performance.now();
  }

  async load() {
    this.take(await ask('/api/state'), false);
    this.watch();
  }

  /** Sends a design. Edits of one gesture (a drag) become one step of the history. */
  send(design, gesture = '') {
    this.design = design;
    this.resting = gesture === '';
    this.next = { path: '/api/edit', body: JSON.stringify(design), gesture };
    return this.run();
  }

  /** A gesture is over: nothing more to wait for. */
  rest() {
    this.resting = true;
    if (!this.busy) this.details();
  }

  step(direction) {
    return this.post(`/api/${direction}`);
  }

  /** Another request that answers with a state; nothing while one is on its way. */
  post(path, parameters = {}) {
    if (this.busy) return null;
    this.resting = true;
    this.next = { path, body: '', parameters };
    return this.run();
  }

  async run() {
    if (this.busy) return;
    this.busy = true;
    clearTimeout(this.timer);
    this.abort?.abort();
    this.listeners.status('busy', 'Solving…');
    while (this.next) {
      const { path, body, gesture, parameters = {} } = this.next;
      this.next = null;
      this.since = performance.now();
      const query = { have: this.result, base: this.revision, ...parameters };
      if (path === '/api/edit') query.gesture = gesture;
      try {
        const pack = await ask(path, query, { body });
        if (!this.next) this.take(pack, true, path === '/api/edit');
        else this.follow(pack);
      } catch (error) {
        this.next = null;
        // What is edited from now on is the last design that was taken, not the one that was refused.
        if (error instanceof Refused) this.design = this.taken;
        await this.failed(error);
        if (error.status === 409) this.next = null;  // it was not based on what the other tab did
      }
    }
    this.busy = false;
  }

  /** An answer that is out of date already: its field is shown, its design is not taken over. */
  follow(pack) {
    this.revision = pack.meta.revision;
    this.result = pack.meta.result;
    this.taken = pack.meta.design;
    this.listeners.follow(pack);
  }

  async failed(error) {
    if (!(error instanceof Refused)) {
      this.listeners.status('lost', 'The studio does not answer. Nothing is lost: start alcap studio again and open its new address.');
      return;
    }
    const said = error.status === 409 ? ['note', 'Another tab changed the design. This is the new version.'] : ['problem', error.message];
    this.listeners.status(...said);
    this.take(await ask('/api/state', { have: this.result }), false);
    this.listeners.status(...said);  // of the new state there is nothing as important to say
  }

  /** solved: the answer was computed for this request, not kept from before. */
  take(pack, mine, solved = false) {
    if (pack.meta.revision < this.revision) return;  // overtaken by the answer to an edit
    this.revision = pack.meta.revision;
    this.design = this.taken = pack.meta.design;
    this.result = pack.meta.result;
    this.listeners.state(pack, mine);
    if (pack.meta.problem) this.listeners.status('problem', pack.meta.problem);
    else this.listeners.status('ready', solved ? pack.meta.seconds : 0);
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.details(), mine && !this.resting ? quietTime : 0);
  }

  /** Asks for what is to be drawn and is not there yet. */
  async details() {
    clearTimeout(this.timer);
    this.abort?.abort();
    const { signal } = (this.abort = new AbortController());
    const result = this.result;
    try {
      for (const part of this.listeners.parts()) {
        if (this.loaded[part] === result) continue;
        const pack = await ask('/api/details', { result, part }, { signal });
        if (!pack || signal.aborted || result !== this.result) return;
        this.loaded[part] = result;
        this.listeners.details(pack, part);
      }
      this.listeners.complete(result, performance.now() - this.since);
    } catch (error) {
      if (!signal.aborted && !(error instanceof Refused)) this.failed(error);
    }
  }

  /** Learns what other tabs do, and whether the server is there. */
  async watch() {
    for (let pause = 500;; pause = Math.min(2 * pause, 8000)) {
      try {
        for (;;) {
          const { revision } = await ask('/api/wait', { known: this.revision });
          if (this.lost) this.listeners.status('ready', 0);
          this.lost = false;
          pause = 500;
          if (revision !== this.revision && !this.busy) {
            const pack = await ask('/api/state', { have: this.result });
            if (!this.busy) this.take(pack, false);  // otherwise there will be a newer one
          } else if (this.busy) {
            await new Promise((next) => setTimeout(next, 100));
          }
        }
      } catch (error) {
        this.lost = true;
        this.failed(error instanceof Refused ? new TypeError(error.message) : error);
        if (error instanceof Refused && error.status === 403) return;
        await new Promise((next) => setTimeout(next, pause));
      }
    }
  }
}
