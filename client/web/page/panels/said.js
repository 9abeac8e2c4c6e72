// Short sentences about what happened, for a while; a screen reader hears them.
import { byId, el } from './dom.js';

const STAY_MS = 6000;
const MOST = 4;

/** @param {string} text @param {'bad' | 'good' | ''} [kind] */
export function say(text, kind = '') {
  const list = byId('said');
  const last = list.lastElementChild;
  if (last?.textContent === text) last.remove();
  const row = el('div', { class: kind }, text);
  list.append(row);
  while (list.children.length > MOST) list.firstElementChild?.remove();
  setTimeout(() => row.remove(), kind === 'bad' ? 1.5 * STAY_MS : STAY_MS);
}
