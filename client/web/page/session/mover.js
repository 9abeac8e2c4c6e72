// Sends the motion of held parts: what came since the last time as one increment a part, on a clock of its own, so that a
// slow picture does not make slow motion, and long motions in pieces.
import { inPieces, isNothing, sum } from './motion.js';

/** @typedef {import('./motion.js').Increment} Increment */
/** @typedef {import('./motion.js').Vec3} Vec3 */

const PERIOD_MS = 1000 / 60;
/** A long motion is a glide that is seen, a step is one increment: each costs the session a search of its own. */
const GLIDE = { most: 30, shift: 1, turn: 0.05 };
/** Below what sessions allow in one increment by default; a piece that is refused all the same is said. */
const MOST = { shift: 5, turn: 0.2 };

export class Mover {
  /** @type {Map<number, Increment>} */
  #pending = new Map();
  /** @type {Map<number, Increment[]>} */
  #glides = new Map();
  /** @type {ReturnType<typeof setInterval> | undefined} */
  #timer;

  /** @param {(part: number, increment: Increment) => boolean} send false: not sent, it stays @param {number} period */
  constructor(send, period = PERIOD_MS) {
    this.send = send;
    this.period = period;
  }

  /** By hand: goes with the next beat. @param {number} part @param {Increment} increment */
  push(part, increment) {
    const before = this.#pending.get(part);
    this.#pending.set(part, before ? sum(before, increment) : increment);
    this.#run();
  }

  /** A whole motion, over half a second or as long as the limits ask. @param {number} part @param {Increment} whole */
  glide(part, whole) {
    const queue = this.#glides.get(part) ?? [];
    const pieces = Math.ceil(Math.max(Math.hypot(...whole.t) / GLIDE.shift, Math.hypot(...whole.r) / GLIDE.turn));
    queue.push(...inPieces(whole, Math.min(pieces, GLIDE.most), MOST));
    this.#glides.set(part, queue);
    this.#run();
  }

  /** Forgets what was not sent. @param {number} part */
  drop(part) {
    this.#pending.delete(part);
    this.#glides.delete(part);
  }

  dropAll() {
    this.#pending.clear();
    this.#glides.clear();
  }

  /** @param {number} part */
  isGliding(part) {
    return this.#glides.has(part);
  }

  #run() {
    this.#timer ??= setInterval(() => this.beat(), this.period);
  }

  /** What is longer than one increment may be goes in several beats. @param {number} part @param {Increment} increment */
  #sendOne(part, increment) {
    const [first, ...rest] = inPieces(increment, 1, MOST);
    if (!this.send(part, first)) return;
    if (rest.length === 0) this.#pending.delete(part);
    else this.#pending.set(part, rest.reduce(sum));
  }

  beat() {
    for (const [part, queue] of this.#glides) {
      const piece = queue.shift();
      if (piece) this.push(part, piece);
      if (queue.length === 0) this.#glides.delete(part);
    }
    for (const [part, increment] of this.#pending) {
      if (isNothing(increment)) this.#pending.delete(part);
      else this.#sendOne(part, increment);
    }
    if (this.#pending.size === 0 && this.#glides.size === 0) {
      clearInterval(this.#timer);
      this.#timer = undefined;
    }
  }
}
