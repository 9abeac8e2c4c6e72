// Words on the picture: who holds what, and what the arrows of the chosen clash mean. They lie over the canvas as text.
import * as THREE from 'three';
import { el, keepRows, setText } from '../panels/dom.js';
import { placed } from '../session/motion.js';
import { personColour } from './looks.js';

const MOST = 24;

export class Labels {
  /** Further words: of the align tool, of the clash. @type {Array<() => Array<{at: THREE.Vector3, text: string}>>} */
  sources = [];

  /** @param {import('./stage.js').Stage} stage @param {import('../session/session.js').Session} session @param {HTMLElement} layer */
  constructor(stage, session, layer) {
    this.stage = stage;
    this.session = session;
    this.layer = layer;
    /** @type {Array<{key: string, at: THREE.Vector3, text: string, kind: string, colour: string}>} */
    this.words = [];
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
      const at = new THREE.Vector3(...placed(part, part.reference));
      at.z += part.radius * 0.75;
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
        const top = Math.min(height - 14, Math.max(14, y));
        row.style.transform = `translate(${left.toFixed(1)}px, ${top.toFixed(1)}px) translate(-50%, -50%)`;
      },
    );
  }
}
