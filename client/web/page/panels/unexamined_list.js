// Pairs that have no verdict: above the list of clashes, and at the pair itself.
import * as THREE from 'three';
import { placed } from '../session/motion.js';
import { wordsOf } from '../session/unexamined.js';
import { byId, el, keepRows, setText } from './dom.js';

/** More would hide the picture that they lie on; the list has all. */
const MOST_NOTES = 4;

/** @typedef {import('../session/unexamined.js').Row} Row */

/** @param {import('../desk.js').Desk} desk */
export function makeUnexaminedList({ session, choice, labels, stage }) {
  const box = byId('unexamined');
  const title = el('h3', {});
  const list = el('ul', { class: 'list short', 'aria-label': 'Pairs without a verdict' });
  box.append(title, list);
  const pairOf = (/** @type {Row} */ row) => `${session.partName(row.a)} × ${session.partName(row.b)}`;

  function make(/** @type {Row} */ row) {
    return el('li', { onclick: () => choice.choosePart(session.parts.get(row.a)?.moving ? row.a : row.b) }, el('b', { 'aria-hidden': 'true' }, '?'), el('span', {}, el('span'), el('span', { class: 'quiet' })));
  }

  function fill(/** @type {HTMLElement} */ li, /** @type {Row} */ row) {
    const [name, why] = [.../** @type {Element} */ (li.lastElementChild).children];
    setText(name, `${pairOf(row)} `);
    setText(why, wordsOf(row.why));
    li.title = `${row.ticks} ticks without a verdict up to tick ${row.tick}`;
  }

  function refresh() {
    const rows = [...session.unexamined.rows.values()];
    const all = rows.length + session.unexamined.leftOut;
    box.hidden = all === 0;
    setText(title, `Not examined: ${all}${session.unexamined.leftOut ? `, of which ${rows.length} are named` : ''}. They may clash.`);
    keepRows(list, rows, (row) => `${row.a} ${row.b}`, make, fill);
    stage.ask();
  }

  labels.sources.push(() => {
    const notes = [];
    for (const row of session.unexamined.rows.values()) {
      const [a, b] = [session.parts.get(row.a), session.parts.get(row.b)];
      if (!a || !b || notes.length >= MOST_NOTES) continue;
      const small = a.radius < b.radius ? a : b;
      notes.push({ at: new THREE.Vector3(...placed(small, small.reference)), text: `? ${pairOf(row)}: not examined` });
    }
    return notes;
  });
  session.on('unexamined', refresh);
  session.on('scene', refresh);
}
