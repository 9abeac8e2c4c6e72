// Everything by keys; the table is also the help.
import { byId, el } from './dom.js';

/** Axis and sign of a step in world axes. @type {Record<string, [number, number]>} */
const ARROWS = { ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowUp: [1, 1], ArrowDown: [1, -1], PageUp: [2, 1], PageDown: [2, -1] };

/** @typedef {{keys: string, text: string, is: (event: KeyboardEvent) => boolean, run: (event: KeyboardEvent) => unknown}} Binding */

/** @param {string} key */
const plainKey = (key) => (/** @type {KeyboardEvent} */ event) => event.key.toLowerCase() === key && !event.ctrlKey && !event.metaKey && !event.altKey;
/** @param {string} key @param {boolean} [shift] */
const withCtrl = (key, shift = false) => (/** @type {KeyboardEvent} */ event) => event.key.toLowerCase() === key && (event.ctrlKey || event.metaKey) && event.shiftKey === shift;

/**
 * @param {Record<'grab' | 'gather' | 'fit' | 'part' | 'section' | 'ghost' | 'ground' | 'hide' | 'isolate' | 'unhide' | 'picture' | 'undo' | 'redo' | 'cancel' | 'play' | 'nextClash' | 'lastClash', () => unknown>
 *   & {tool: (tool: 'select' | 'move' | 'rotate' | 'align' | 'measure') => void, from: (side: string) => void, step: (axis: number, sign: number, turn: boolean) => boolean,
 *      stepSize: (by: number) => void, turnView: (right: number, up: number) => void, closer: (times: number) => void}} act
 */
export function makeKeyboard(act) {
  /** @type {Binding[]} */
  const bindings = [
    { keys: 'G', text: 'Grab or release the chosen part', is: plainKey('g'), run: act.grab },
    { keys: 'M', text: 'Gather the chosen part, or leave it: gathered parts are taken in hand as one body (in list and view: Ctrl+click)', is: plainKey('m'), run: act.gather },
    { keys: '← → ↑ ↓ PgUp PgDn', text: 'Step of the part in hand along −X +X +Y −Y +Z −Z; with Shift a turn about the axis. Without a part in hand: turn the view', is: (e) => e.key in ARROWS && !e.ctrlKey && !e.altKey, run: arrow },
    { keys: '[ ]', text: 'Smaller, larger steps: 1 µm … 10 mm', is: (e) => e.key === '[' || e.key === ']', run: (e) => act.stepSize(e.key === ']' ? 1 : -1) },
    { keys: 'V T E A K', text: 'Select; move, turn by handles or the part itself; align two features; measure', is: (e) => ['v', 't', 'e', 'a', 'k'].some((key) => plainKey(key)(e)), run: tool },
    { keys: 'N Shift+N', text: 'Next, previous clash, and fly there', is: plainKey('n'), run: (e) => (e.shiftKey ? act.lastClash() : act.nextClash()) },
    { keys: 'F Z', text: 'Show everything; show the chosen part', is: (e) => plainKey('f')(e) || plainKey('z')(e), run: (e) => (e.key.toLowerCase() === 'f' ? act.fit() : act.part()) },
    { keys: '0 1 2 3', text: 'Look from: isometric, top, front, right', is: (e) => '0123'.includes(e.key) && !e.ctrlKey, run: (e) => act.from(['iso', 'top', 'front', 'right'][Number(e.key)]) },
    { keys: '+ −', text: 'Closer, farther', is: (e) => ['+', '=', '-'].includes(e.key) && !e.ctrlKey, run: (e) => act.closer(e.key === '-' ? 0.8 : 1.25) },
    { keys: 'X H', text: 'Section plane; make other parts transparent', is: (e) => plainKey('x')(e) || plainKey('h')(e), run: (e) => (e.key.toLowerCase() === 'x' ? act.section() : act.ghost()) },
    { keys: 'S', text: 'Shadow on the ground, or none', is: plainKey('s'), run: act.ground },
    { keys: 'D I U', text: 'Hide the chosen or gathered parts; show them alone; show all', is: (e) => ['d', 'i', 'u'].some((key) => plainKey(key)(e)), run: (e) => ({ d: act.hide, i: act.isolate, u: act.unhide })[/** @type {'d'} */ (e.key.toLowerCase())]() },
    { keys: 'P', text: 'Save a picture of the view', is: plainKey('p'), run: act.picture },
    { keys: 'Ctrl+Z', text: 'Undo your last move of the part', is: withCtrl('z'), run: act.undo },
    { keys: 'Ctrl+Y, Ctrl+Shift+Z', text: 'Redo', is: (e) => withCtrl('y')(e) || withCtrl('z', true)(e), run: act.redo },
    { keys: 'Space', text: 'Replay: play or pause', is: (e) => e.key === ' ', run: act.play },
    { keys: 'Esc', text: 'Nothing chosen, nothing cut', is: (e) => e.key === 'Escape', run: act.cancel },
    { keys: '?', text: 'This table', is: (e) => e.key === '?', run: showHelp },
  ];

  /** @param {KeyboardEvent} event */
  function arrow(event) {
    const [axis, sign] = ARROWS[event.key];
    if (act.step(axis, sign, event.shiftKey)) return;
    if (axis < 2) act.turnView(axis === 0 ? 0.12 * sign : 0, axis === 1 ? 0.12 * sign : 0);
  }

  /** @param {KeyboardEvent} event */
  function tool(event) {
    act.tool(/** @type {const} */ ({ v: 'select', t: 'move', e: 'rotate', a: 'align', k: 'measure' })[/** @type {'v'} */ (event.key.toLowerCase())]);
  }

  const help = /** @type {HTMLDialogElement} */ (byId('keys'));
  help.append(
    el('h2', { id: 'keys_title' }, 'Keys'),
    el('table', {}, el('tbody', {}, ...bindings.map(({ keys, text }) => el('tr', {}, el('td', {}, el('kbd', {}, keys)), el('td', {}, text))))),
    el('p', {}, 'In a list: arrows choose, Enter shows. Mouse: left turns, right shifts, wheel zooms, double click shows a part. With the tool Move, left drags a part, also one that nobody holds.'),
    el('div', { class: 'row end' },
      el('button', { id: 'connect_space_mouse', type: 'button', hidden: true, title: 'It moves the view, or the part in hand with the tools Move and Turn' }, 'Connect a 3D mouse'),
      el('button', { class: 'primary', autofocus: true, onclick: () => help.close() }, 'Close')),
  );

  function showHelp() {
    if (!help.open) help.showModal();
  }

  byId('do_help').onclick = showHelp;
  document.addEventListener('keydown', (event) => {
    const at = /** @type {Element} */ (event.target);
    // A field's keys are its own; so are the letters of a list that chooses by them.
    if (document.querySelector('dialog[open]') || (at.closest('input, textarea, select') && event.key !== 'Escape')) return;
    if (event.key === ' ' && at.closest('button')) return;
    const binding = bindings.find(({ is }) => is(event));
    if (!binding) return;
    event.preventDefault();
    binding.run(event);
  });
}
