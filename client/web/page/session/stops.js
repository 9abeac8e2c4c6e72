// How far a part in hand is behind what was asked of it, and why. What was asked is summed from where the part stood; a part that still comes nearer is on its way.
import { multiply, placed, quaternionOf, conjugate, rotate, rotationVectorOf } from './motion.js';
import { dot, unit } from './slice.js';
import { plain, small } from './words.js';
import { wordsOf } from './unexamined.js';

/** @typedef {import('./motion.js').Vec3} Vec3 */
/** @typedef {import('./session.js').Part} Part */
/** @typedef {import('./session.js').Session} Session */
/** @typedef {{at: Vec3, q: import('./motion.js').Quat, lastAt: Vec3, lastQ: number[], stillSince: number, askedAt: number}} Goal */

/** A part that has not moved for so long stands; after so long without a push the next one begins anew. */
const STANDS_MS = 350;
const ANEW_MS = 1500;
/** Below is rounding of what is shown, mm. */
const LEAST_MM = 5e-4;
const REFUSED_MS = 3000;

const minus = (/** @type {Readonly<Vec3>} */ a, /** @type {Readonly<Vec3>} */ b) => /** @type {Vec3} */ ([a[0] - b[0], a[1] - b[1], a[2] - b[2]]);

export class Stops {
  /** @type {Map<number, Goal>} */
  #goals = new Map();
  /** @type {Map<number, {reason: string, at: number}>} */
  #refused = new Map();

  /** @param {Part} part @param {import('./motion.js').Increment} by @param {number} now ms */
  asked(part, by, now) {
    let goal = this.#goals.get(part.id);
    if (!goal || now - goal.askedAt > ANEW_MS) {
      const at = placed(part, part.reference);
      goal = { at, q: [...part.q], lastAt: at, lastQ: [...part.q], stillSince: now, askedAt: now };
      this.#goals.set(part.id, goal);
    }
    goal.at = [goal.at[0] + by.t[0], goal.at[1] + by.t[1], goal.at[2] + by.t[2]];
    if (by.r.some((x) => x !== 0)) goal.q = multiply(quaternionOf(by.r), goal.q);
    goal.askedAt = now;
  }

  /** @param {Part} part @param {number} now */
  moved(part, now) {
    const goal = this.#goals.get(part.id);
    if (!goal) return;
    const at = placed(part, part.reference);
    if (at.every((x, i) => x === goal.lastAt[i]) && part.q.every((x, i) => x === goal.lastQ[i])) return;
    Object.assign(goal, { lastAt: at, lastQ: [...part.q], stillSince: now });
  }

  /** @param {number} part @param {string} reason @param {number} now */
  refused(part, reason, now) {
    this.#refused.set(part, { reason, at: now });
  }

  /** It was put somewhere else than by this hand. @param {number} part */
  forget(part) {
    this.#goals.delete(part);
  }

  /** What is missing of what was asked, once the part stands. @param {Part} part @param {number} now @returns {{t: Vec3, turn: number} | null} turn in rad */
  missing(part, now) {
    const goal = this.#goals.get(part.id);
    if (!goal || now - goal.stillSince < STANDS_MS) return null;
    const t = minus(goal.at, placed(part, part.reference));
    const turn = Math.hypot(...rotationVectorOf(multiply(goal.q, conjugate(part.q))));
    // Quaternions come with 24 bits.
    return Math.hypot(...t) < LEAST_MM && turn * part.radius < Math.max(LEAST_MM, 2e-6 * part.radius) ? null : { t, turn };
  }

  /** @param {Part} part @param {Session} session @param {number} now @returns {{text: string, note: string} | null} for the hand, and short for the picture */
  why(part, session, now) {
    const refused = this.#refused.get(part.id);
    if (refused && now - refused.at < REFUSED_MS) {
      const held = part.holder && part.holder !== session.me ? `: ${session.userName(part.holder)} holds it` : '';
      return { text: `Refused: ${plain(refused.reason)}${held}`, note: `refused: ${plain(refused.reason)}` };
    }
    const missing = session.isMine(part) ? this.missing(part, now) : null;
    if (!missing) return null;
    const much = Math.hypot(...missing.t) >= LEAST_MM ? small(Math.hypot(...missing.t)) : `${((missing.turn * 180) / Math.PI).toFixed(3)}°`;
    const { text, note } = reasonOf(part, missing, session);
    return { text: `${much} of the move is missing. ${text}`, note };
  }
}

/** @param {Part} part @param {{t: Vec3, turn: number}} missing @param {Session} session */
function reasonOf(part, missing, session) {
  const kept = session.standing.filter((d) => d.kind === 'add constraint' && d.constraint.part === part.id);
  const across = kept.find((d) => isAcross(d.constraint, missing, session));
  if (across) return constrained(across.constraint, session);
  const real = session.policy === 'report' ? undefined : worstReal(part.id, session);
  if (real) {
    const other = session.partName(real.a === part.id ? real.b : real.a);
    return { text: `Real contact with ${other}: ${small(real.delta[1])} deep where your hand would have it, ${small(real.margin)} beyond the real threshold (clash #${real.clash}).`,
      note: `real contact: ${other}, ${small(real.margin)} beyond` };
  }
  const [waits] = session.unexamined.of(part.id);
  if (waits) {
    const other = session.partName(waits.a === part.id ? waits.b : waits.a);
    return { text: `Not judged against ${other}: it ${wordsOf(waits.why)}.`, note: `waits to be judged: ${other}` };
  }
  if (kept.length > 0) return constrained(kept[0].constraint, session);
  return { text: 'The session has told no reason yet.', note: 'held back' };
}

/** @param {any} constraint @param {Session} session */
function constrained({ feature, kind, other, other_feature }, session) {
  const words = `${plain(feature)} ${plain(kind)} with ${session.partName(other)} ${plain(other_feature)}`;
  return { text: `Held by its constraint: ${words}.`, note: `held by its constraint` };
}

/** Is all that is missing what the constraint takes? @param {any} constraint @param {{t: Vec3, turn: number}} missing @param {Session} session */
function isAcross({ kind, other, other_feature }, { t }, session) {
  const part = session.parts.get(other);
  const feature = session.features.get(other)?.find((f) => f.name === other_feature);
  if (!part || !feature || Math.hypot(...t) < LEAST_MM) return false;
  const axis = unit(rotate(part.q, feature.axis));
  const along = Math.abs(dot(axis, t));
  if (kind === 'coaxial') return along < LEAST_MM;
  return kind === 'coplanar' && Math.hypot(...minus(t, /** @type {Vec3} */ (axis.map((x) => x * dot(axis, t))))) < LEAST_MM;
}

/** @param {number} id @param {Session} session */
function worstReal(id, session) {
  const real = session.openClashes().filter((clash) => clash.class === 'real' && (clash.a === id || clash.b === id));
  return real.sort((a, b) => b.margin - a.margin)[0];
}
