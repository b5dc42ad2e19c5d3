// SPDX-License-Identifier: MIT
//
// keys.js: the keyboard: turning and zooming, and one letter for each thing that can be switched.

export const viewKeys = [
  ['← → ↑ ↓', 'Turn'], ['+ −', 'Zoom'], ['F', 'Fit to view'], ['U', 'Change the axis that is up'], ['1 2 3', 'Curves, glyphs, neither'],
  ['S', 'Singularities'], ['O', 'Orientation of singularities'], ['X', 'Separatrices'], ['C', 'Next colour'], ['P', 'Save a picture'], ['?', 'This list'],
];

export function listen(stage, table) {
  const turn = 0.12;
  const all = {
    ArrowLeft: () => stage.turn(-turn, 0), ArrowRight: () => stage.turn(turn, 0),
    ArrowUp: () => stage.turn(0, -turn), ArrowDown: () => stage.turn(0, turn),
    '+': () => stage.zoom(0.85), '=': () => stage.zoom(0.85), '-': () => stage.zoom(1 / 0.85),
    f: () => stage.frame(stage.diagonal), u: () => stage.cycleUp(), ...table,
  };
  addEventListener('keydown', (event) => {
    if (event.target.matches?.('input:not([type=checkbox], [type=range]), select, textarea') || document.querySelector('dialog[open]')) return;
    if (event.key === 'Enter' && event.target.matches?.('button, a, summary, input') && !event.target.matches('.toolbox [aria-checked=true]')) return;
    if (event.target.matches?.('[type=range]') && /^(Arrow|Page|Home|End)/.test(event.key)) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const name = (event.ctrlKey || event.metaKey ? 'Ctrl+' : '') + (event.shiftKey && key.length === 1 && /[a-z]/.test(key) ? 'Shift+' : '') + key;
    if (!all[name] || event.altKey) return;
    all[name]();
    event.preventDefault();
  });
}

/** A click: the pointer went down and up in nearly the same place. */
export function onClick(canvas, act) {
  let down = null;
  canvas.addEventListener('pointerdown', (e) => { down = e.isPrimary && e.button === 0 ? [e.clientX, e.clientY] : null; });
  canvas.addEventListener('pointerup', (e) => {
    if (down && Math.hypot(e.clientX - down[0], e.clientY - down[1]) < 5) act(e);
    down = null;
  });
}
