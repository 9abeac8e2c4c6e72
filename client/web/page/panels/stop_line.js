// Why the part in hand does not go where the hand would have it: in the bar of the hand and at the part.
import * as THREE from 'three';
import { placed } from '../session/motion.js';
import { el, setText } from './dom.js';

const LOOK_MS = 150;

/** @param {import('../desk.js').Desk} desk */
export function makeStopLine({ session, choice, stops, labels, stage }) {
  const line = el('p', { class: 'stop', role: 'status' });
  line.hidden = true;
  let note = '';

  function look() {
    const part = session.parts.get(choice.part);
    const why = part ? stops.why(part, session, performance.now()) : null;
    line.hidden = why === null;
    setText(line, why?.text ?? '');
    if (note === (why?.note ?? '')) return;
    note = why?.note ?? '';
    stage.ask();
  }

  labels.sources.unshift(() => { // before other words: it has its place first
    const part = session.parts.get(choice.part);
    return note && part ? [{ at: new THREE.Vector3(...placed(part, part.reference)), text: `Stop: ${note}` }] : [];
  });
  setInterval(() => (session.me !== 0 || note) && look(), LOOK_MS);
  session.on('poses', (parts) => {
    const now = performance.now();
    for (const part of parts) stops.moved(part, now);
  });
  session.on('refused', (increments) => {
    for (const { part, reason } of increments) stops.refused(part, reason, performance.now());
  });
  session.on('holder', (part) => stops.forget(part.id));
  session.on('decision', (d) => {
    if (['undo', 'redo', 'reset', 'add constraint'].includes(d.kind)) for (const id of d.parts ?? [d.part || d.constraint?.part]) stops.forget(id);
  });
  session.on('scene', () => {
    for (const id of session.parts.keys()) stops.forget(id);
  });
  choice.on('part', look);
  return line;
}
