// A 3D mouse (3Dconnexion SpaceMouse): what its reports say, as a motion in the frame of the eye: x right, y up, z towards the eye.

/** @typedef {import('./motion.js').Vec3} Vec3 */
/** @typedef {import('./motion.js').Increment} Increment */
/** @typedef {{shift?: Vec3, turn?: Vec3, buttons?: number}} Report deflections -1 … 1; buttons as bits */

/** Multi-axis controllers (usage 8 of the generic desktop page) of its maker, older ones under the number of Logitech. */
export const SPACE_MICE = [0x256f, 0x046d].map((vendorId) => ({ vendorId, usagePage: 1, usage: 8 }));

const FULL = 350; // counts at the stop
const DEAD = 0.06; // a hand that only rests on it moves nothing
/** It tells as long as it is pushed: silent for so long, it was pulled out or is out of reach. */
const SILENT_MS = 400;
/** A slow picture is no leap. */
const LONGEST_MS = 100;

/** Beyond the dead zone, finer near the middle. @param {number} count */
function deflection(count) {
  const size = Math.min(1, Math.max(0, (Math.abs(count) / FULL - DEAD) / (1 - DEAD)));
  return size === 0 ? 0 : Math.sign(count) * size * size;
}

/** Its axes are right, towards the user, down. @param {DataView} data @param {number} from @returns {Vec3} */
function axes(data, from) {
  const [right, near, down] = [0, 2, 4].map((i) => data.getInt16(from + i, true));
  return [deflection(right), deflection(-down), deflection(near)];
}

/** @param {number} id @param {DataView} data without the id @returns {Report | null} null: not known, or too short */
export function readReport(id, data) {
  const { byteLength } = data;
  if (id === 1 && byteLength >= 12) return { shift: axes(data, 0), turn: axes(data, 6) };
  if (id === 1 && byteLength >= 6) return { shift: axes(data, 0) };
  if (id === 2 && byteLength >= 6) return { turn: axes(data, 0) };
  if (id === 3 && byteLength >= 1) return { buttons: [0, 1, 2, 3].reduce((bits, i) => (i < byteLength ? bits + data.getUint8(i) * 256 ** i : bits), 0) };
  return null;
}

export class SpaceMouse {
  /** @type {Vec3} */ #shift = [0, 0, 0];
  /** @type {Vec3} */ #turn = [0, 0, 0];
  #buttons = 0;
  #heardAt = -Infinity;
  /** @type {number | null} until when its motion was taken; null: it stood */
  #takenAt = null;

  /** @param {number} id @param {DataView} data @param {number} now ms @returns {number} buttons that were pressed just now, as bits */
  take(id, data, now) {
    const report = readReport(id, data);
    if (!report) return 0;
    this.#heardAt = now;
    this.#shift = report.shift ?? this.#shift;
    this.#turn = report.turn ?? this.#turn;
    const pressed = (report.buttons ?? 0) & ~this.#buttons;
    this.#buttons = report.buttons ?? this.#buttons;
    return pressed;
  }

  rest() {
    this.#shift = this.#turn = [0, 0, 0];
    this.#buttons = 0;
  }

  /** What it asks for since the last time: its deflections for so many seconds. @param {number} now ms @returns {Increment | null} null: it stands */
  motion(now) {
    if (now - this.#heardAt > SILENT_MS) this.rest();
    if ([...this.#shift, ...this.#turn].every((x) => x === 0)) {
      this.#takenAt = null;
      return null;
    }
    const s = Math.max(0, Math.min(LONGEST_MS, now - (this.#takenAt ?? now))) / 1000;
    this.#takenAt = now;
    const during = (/** @type {Vec3} */ rate) => /** @type {Vec3} */ (rate.map((x) => x * s));
    return { t: during(this.#shift), r: during(this.#turn) };
  }
}
