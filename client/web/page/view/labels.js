// Words on the picture: who holds what, and what the arrows of the chosen clash mean. They lie over the canvas as text.
import * as THREE from 'three';
import { el, keepRows, setText } from '../panels/dom.js';
import { personColour } from './looks.js';

const MOST = 24;
/** Pixels of a word above the top of its part, and from one word to the next. */
const ABOVE = 16;
const ROW = 24;

export class Labels {
  /** Further words: of the align tool, of the clash. @type {Array<() => Array<{at: THREE.Vector3, text: string}>>} */
  sources = [];

  /**
   * @param {import('./stage.js').Stage} stage @param {import('../session/session.js').Session} session
   * @param {import('./parts_view.js').PartsView} partsView @param {HTMLElement} layer
   */
  constructor(stage, session, partsView, layer) {
    this.stage = stage;
    this.session = session;
    this.partsView = partsView;
    this.layer = layer;
    stage.beforePicture(() => this.#place());
  }

  /** Who holds what changed, or a held part moved. */
  refresh() {
    this.stage.ask();
  }

  #held() {
    const words = [];
    for (const part of this.session.parts.values()) {
      if (!part.holder || words.length >= MOST) continue;
      const mine = this.session.isMine(part);
      const [box] = this.partsView.boxesOf([part]);
      if (!box) continue;
      const at = box.getCenter(new THREE.Vector3()).setZ(box.max.z);
      words.push({ key: `h${part.id}`, at, text: mine ? `${part.name} – you` : `${part.name} – ${this.session.userName(part.holder)}`,
        kind: mine ? 'held mine' : 'held', colour: personColour(part.holder) });
    }
    return words;
  }

  #place() {
    const notes = this.sources.flatMap((source) => source());
    const words = [
      ...this.#held(),
      ...notes.map((note, i) => ({ key: `n${i}`, at: note.at, text: note.text, kind: 'note', colour: '' })),
    ];
    const { width, height } = this.stage;
    /** @type {Array<{left: number, top: number, half: number}>} */
    const taken = [];
    keepRows(
      this.layer,
      words,
      (word) => word.key,
      () => el('div'),
      (row, word) => {
        const { x, y, seen } = this.stage.onScreen(word.at.clone());
        row.hidden = !seen;
        if (!seen) return;
        setText(row, word.text);
        if (row.className !== word.kind) row.className = word.kind;
        row.style.setProperty('--who', word.colour);
        // Within the view: estimated from the text, so that nothing is measured and laid out in a picture.
        const half = word.text.length * 3.4 + 10;
        const left = Math.min(width - half, Math.max(half, x));
        const wanted = Math.min(height - 14, Math.max(14, word.kind === 'note' ? y : y - ABOVE));
        const top = free(taken, left, wanted, half);
        taken.push({ left, top, half });
        row.style.transform = `translate(${Math.round(left)}px, ${Math.round(top)}px) translate(-50%, -50%)`;
      },
    );
  }
}

/**
 * As near to `wanted` as no other word is: upwards first.
 * @param {Array<{left: number, top: number, half: number}>} taken @param {number} left @param {number} wanted @param {number} half
 */
function free(taken, left, wanted, half) {
  const hit = (/** @type {number} */ top) => taken.some((other) => Math.abs(other.left - left) < other.half + half && Math.abs(other.top - top) < ROW);
  for (const row of [0, -1, 1, -2, 2, -3]) {
    const top = wanted + row * ROW;
    if (top > 12 && !hit(top)) return top;
  }
  return wanted;
}
