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

/** Who waits longer, in consecutive pulses together, is told of. */
const TELL_S = 0.5;

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
  /** Ticks in consecutive pulses, by pair. @type {Map<string, number>} */
  #waited = new Map();
  #told = false;

  /** @param {Iterable<{id: number}>} parts */
  moved(parts) {
    for (const { id } of parts) this.#moved.add(id);
  }

  clear() {
    this.rows.clear();
    this.#moved.clear();
    this.#waited.clear();
    this.#told = false;
    this.leftOut = 0;
  }

  /** The pair that has waited longest: once, and again only after a pulse without any. @param {{unexamined?: Told[]}} pulse @param {number} tickRate @returns {Told | null} */
  news(pulse, tickRate) {
    const rows = pulse.unexamined ?? [];
    this.#waited = new Map(rows.map((row) => [`${row.a} ${row.b}`, (this.#waited.get(`${row.a} ${row.b}`) ?? 0) + row.ticks]));
    if (rows.length === 0) this.#told = false;
    const ticks = (/** @type {Told} */ row) => this.#waited.get(`${row.a} ${row.b}`) ?? 0;
    const longest = rows.reduce((/** @type {Told | null} */ most, row) => (!most || ticks(row) > ticks(most) ? row : most), null);
    if (!longest || this.#told || ticks(longest) <= TELL_S * tickRate) return null;
    this.#told = true;
    return longest;
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
