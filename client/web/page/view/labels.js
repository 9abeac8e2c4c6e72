// Words on the picture: who holds what, and what the arrows of the chosen clash mean. They lie over the canvas as text.
import * as THREE from 'three';
import { el, keepRows, setText } from '../panels/dom.js';
import { freePlace } from './label_places.js';
import { personColour } from './looks.js';

const MOST = 24;
/** Pixels of a word above the top of its part, and of its height. */
const ABOVE = 16;
const HEIGHT = 22;
/** As style.css has them: the letters, and what stands beside the text of a word (padding, borders, a pixel for rounding). */
const FONT_PX = 11.5;
const BESIDE = 22;
const MOST_WIDTHS = 500;

export class Labels {
  /** Further words: of the align tool, of the clash. @type {Array<() => Array<{at: THREE.Vector3, text: string}>>} */
  sources = [];
  /** What lies on the view and would cover a word. @type {import('./label_places.js').Box[]} */
  #covers = [];
  #pen = document.createElement('canvas').getContext('2d');
  /** @type {Map<string, number>} */
  #widths = new Map();

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
    if (this.#pen) this.#pen.font = `${FONT_PX}px ${getComputedStyle(layer).fontFamily}`;
    this.#watchCovers();
  }

  /** Measured when one of them changes, so that nothing is laid out in a picture; before it is seen, words have made room. */
  #watchCovers() {
    const beside = [...(this.layer.parentElement?.children ?? [])].filter((other) => other !== this.layer && other !== this.stage.canvas);
    const measure = () => {
      const { left, top } = this.layer.getBoundingClientRect();
      this.#covers = beside.map((other) => other.getBoundingClientRect()).filter(({ width, height }) => width > 0 && height > 0)
        .map((box) => ({ left: box.left - left, top: box.top - top, right: box.right - left, bottom: box.bottom - top }));
      this.#place();
    };
    const watch = new ResizeObserver(measure);
    for (const element of [this.layer, ...beside]) watch.observe(element);
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

  /** Of the text alone: nothing is laid out in a picture. @param {string} text */
  #widthOf(text) {
    if (!this.#pen) return text.length * 7 + BESIDE;
    let width = this.#widths.get(text);
    if (width === undefined) {
      if (this.#widths.size > MOST_WIDTHS) this.#widths.clear();
      width = this.#pen.measureText(text).width + BESIDE;
      this.#widths.set(text, width);
    }
    return width;
  }

  #place() {
    const notes = this.sources.flatMap((source) => source());
    // Notes first: why a part stops stands at the part before its name does.
    const words = [
      ...notes.map((note, i) => ({ key: `n${i}`, at: note.at, text: note.text, kind: 'note', colour: '' })),
      ...this.#held(),
    ];
    const { width, height } = this.stage;
    /** @type {import('./label_places.js').Box[]} */
    const placed = [];
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
        const place = freePlace(this.#covers, placed, { x, y: word.kind === 'note' ? y : y - ABOVE }, { width: this.#widthOf(word.text), height: HEIGHT }, { width, height });
        placed.push(place);
        row.style.transform = `translate(${Math.round((place.left + place.right) / 2)}px, ${Math.round((place.top + place.bottom) / 2)}px) translate(-50%, -50%)`;
      },
    );
  }
}
