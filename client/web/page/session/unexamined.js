// Pairs that have no verdict, and what they wait for. The session tells once a second which had none since; what waits for work is gone when it is not told again,
// what was given up stays until one of the two parts has moved.

/** @typedef {{a: number, b: number, why: string, ticks: number}} Told a row of a pulse */
/** @typedef {Told & {tick: number}} Row tick: when it was told last */

const WAITS = new Set(['waits for first contact', 'waits for depth']);

/** @type {Record<string, string>} */
const WORDS = {
  'waits for first contact': 'waits for its turn: first contact is searched when the tick has work left',
  'waits for depth': 'waits for its turn: its depth is worked out when the tick has work left',
  'given up': 'given up at the most work that one pair may have; move one of them and it is judged anew',
  'no inside': 'a mesh is open, so that what lies inside of it is not known; repair it',
};

/** @param {string} why */
export function wordsOf(why) {
  return WORDS[why] ?? why;
}

export class Unexamined {
  /** @type {Map<string, Row>} */
  rows = new Map();
  leftOut = 0;
  /** Parts that have moved since the last pulse. @type {Set<number>} */
  #moved = new Set();

  /** @param {Iterable<{id: number}>} parts */
  moved(parts) {
    for (const { id } of parts) this.#moved.add(id);
  }

  clear() {
    this.rows.clear();
    this.#moved.clear();
    this.leftOut = 0;
  }

  /** @param {{tick: number, unexamined?: Told[], unexamined_left_out?: number}} pulse @returns {boolean} is it another list? */
  take(pulse) {
    const before = this.#key();
    for (const [key, row] of this.rows) {
      if (WAITS.has(row.why) || this.#moved.has(row.a) || this.#moved.has(row.b)) this.rows.delete(key);
    }
    for (const row of pulse.unexamined ?? []) this.rows.set(`${row.a} ${row.b}`, { ...row, tick: pulse.tick });
    this.leftOut = pulse.unexamined_left_out ?? 0;
    this.#moved.clear();
    return this.#key() !== before;
  }

  /** @param {number} part @returns {Row[]} */
  of(part) {
    return [...this.rows.values()].filter(({ a, b }) => a === part || b === part);
  }

  #key() {
    return JSON.stringify([[...this.rows.values()].map(({ a, b, why, ticks }) => [a, b, why, ticks]), this.leftOut]);
  }
}
