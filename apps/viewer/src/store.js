// SPDX-License-Identifier: MIT
//
// store.js: the design as this tab knows it, and its way to the server and back. Edits go one at a time; while one is
// being solved, later ones of a gesture replace each other, so that the field follows the hand as fast as it can.
import { ask, Refused } from './api.js';

const quietTime = 120;  // ms without an edit before curves are asked for

export class Store {
  /** listeners: state(meta, arrays, mine), details(pack), status(kind, text). */
  constructor(listeners) {
    this.listeners = listeners;
    this.revision = 0;
    this.result = 0;
    this.busy = false;
    this.next = null;
  }

  async load() {
    this.take(await ask('/api/state'), false);
    this.watch();
  }

  /** Sends a design. Edits of one gesture (a drag) become one step of the history. */
  send(design, gesture = '') {
    this.design = design;
    this.next = { path: '/api/edit', body: JSON.stringify(design), gesture };
    return this.run();
  }

  step(direction) {
    if (this.busy) return null;
    this.next = { path: `/api/${direction}`, body: '' };
    return this.run();
  }

  async run() {
    if (this.busy) return;
    this.busy = true;
    clearTimeout(this.timer);
    this.listeners.status('busy', 'Solving…');
    while (this.next) {
      const { path, body, gesture } = this.next;
      this.next = null;
      const parameters = { have: this.result };
      if (path === '/api/edit') Object.assign(parameters, { base: this.revision, gesture });
      try {
        const pack = await ask(path, parameters, { body });
        if (!this.next) this.take(pack, true, '', path === '/api/edit');
        else this.follow(pack);
      } catch (error) {
        this.next = null;
        await this.failed(error);
      }
    }
    this.busy = false;
  }

  /** An answer that is out of date already: its field is shown, its design is not taken over. */
  follow(pack) {
    this.revision = pack.meta.revision;
    this.result = pack.meta.result;
    this.stale = true;
    this.listeners.follow(pack);
  }

  async failed(error) {
    if (error instanceof Refused && error.status === 409) {
      this.listeners.status('note', 'Another tab changed the design; this is its version.');
      this.take(await ask('/api/state', { have: this.result }), false);
    } else if (error instanceof Refused) {
      this.listeners.status('problem', error.message);
      this.take(await ask('/api/state', { have: this.result }), false, error.message);
    } else {
      this.listeners.status('lost', 'The studio does not answer. Nothing is lost: start alcap studio again and open its new address.');
    }
  }

  /** solved: the answer was computed for this request, not kept from before. */
  take(pack, mine, said = '', solved = false) {
    this.revision = pack.meta.revision;
    this.design = pack.meta.design;
    if (pack.meta.result !== this.result) this.stale = true;
    this.result = pack.meta.result;
    this.listeners.state(pack, mine);
    if (said) return;
    if (pack.meta.problem) this.listeners.status('problem', pack.meta.problem);
    else this.listeners.status('ready', solved ? pack.meta.seconds : 0);
    clearTimeout(this.timer);
    if (this.stale) this.timer = setTimeout(() => this.details(), mine ? quietTime : 0);
  }

  async details() {
    const result = this.result;
    try {
      const pack = await ask('/api/details', { result });
      if (result !== this.result) return;
      this.stale = false;
      this.listeners.details(pack);
    } catch (error) {
      if (!(error instanceof Refused)) this.failed(error);
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
          if (revision !== this.revision && !this.busy) this.take(await ask('/api/state', { have: this.result }), false);
          else if (this.busy) await new Promise((next) => setTimeout(next, 100));
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
