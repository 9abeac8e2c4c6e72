// Motions of a rigid part: increments in world axes about its reference point. mm, rad; vectors [x, y, z], quaternions [x, y, z, w].

/** @typedef {[number, number, number]} Vec3 */
/** @typedef {[number, number, number, number]} Quat */
/** @typedef {{t: Vec3, r: Vec3}} Increment */

/** @param {Vec3} r rotation vector @returns {Quat} */
export function quaternionOf(r) {
  const angle = Math.hypot(...r);
  // sin(a/2)/a by its series where the quotient would lose digits.
  const scale = angle < 1e-4 ? 0.5 - (angle * angle) / 48 : Math.sin(angle / 2) / angle;
  return [r[0] * scale, r[1] * scale, r[2] * scale, Math.cos(angle / 2)];
}

/** The shorter way, |r| <= pi. @param {Quat} q @returns {Vec3} */
export function rotationVectorOf(q) {
  const sign = q[3] < 0 ? -1 : 1;
  const sine = Math.hypot(q[0], q[1], q[2]);
  if (sine === 0) return [0, 0, 0];
  const angle = 2 * Math.atan2(sine, sign * q[3]);
  const scale = (sign * angle) / sine;
  return [q[0] * scale, q[1] * scale, q[2] * scale];
}

/** a after b. @param {Quat} a @param {Quat} b @returns {Quat} */
export function multiply(a, b) {
  return [
    a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
    a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
    a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
    a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
  ];
}

/** @param {Quat} q @returns {Quat} */
export function conjugate(q) {
  return [-q[0], -q[1], -q[2], q[3]];
}

/** @param {Quat} q @param {Readonly<Vec3>} v @returns {Vec3} */
export function rotate(q, v) {
  const [x, y, z] = v;
  const tx = 2 * (q[1] * z - q[2] * y);
  const ty = 2 * (q[2] * x - q[0] * z);
  const tz = 2 * (q[0] * y - q[1] * x);
  return [
    x + q[3] * tx + q[1] * tz - q[2] * ty,
    y + q[3] * ty + q[2] * tx - q[0] * tz,
    z + q[3] * tz + q[0] * ty - q[1] * tx,
  ];
}

/** @param {{p: Vec3, q: Quat}} pose @param {Readonly<Vec3>} point in the frame of the part @returns {Vec3} in the world */
export function placed(pose, point) {
  const turned = rotate(pose.q, point);
  return [pose.p[0] + turned[0], pose.p[1] + turned[1], pose.p[2] + turned[2]];
}

/** @param {{p: Vec3, q: Quat}} pose @param {Readonly<Vec3>} point of the world @returns {Vec3} in the frame of the part */
export function inPart(pose, point) {
  return rotate(conjugate(pose.q), [point[0] - pose.p[0], point[1] - pose.p[1], point[2] - pose.p[2]]);
}

/**
 * First `first`, then `then`, as one increment. Both turn about the same reference point, which the first carries along:
 * so shifts add, and turns are composed.
 * @param {Increment} first @param {Increment} then @returns {Increment}
 */
export function sum(first, then) {
  const still = then.r[0] === 0 && then.r[1] === 0 && then.r[2] === 0;
  return {
    t: [first.t[0] + then.t[0], first.t[1] + then.t[1], first.t[2] + then.t[2]],
    r: still ? first.r : rotationVectorOf(multiply(quaternionOf(then.r), quaternionOf(first.r))),
  };
}

/** @param {Increment} increment @returns {boolean} */
export function isNothing({ t, r }) {
  return t.every((x) => x === 0) && r.every((x) => x === 0);
}

/**
 * A motion in pieces, none longer than the limits: composed they are the whole.
 * @param {Increment} whole @param {number} pieces at least so many
 * @param {{shift: number, turn: number}} most of one piece, mm and rad
 * @returns {Increment[]}
 */
export function inPieces(whole, pieces, most) {
  const shift = Math.hypot(...whole.t) / most.shift;
  const turn = Math.hypot(...whole.r) / most.turn;
  const count = Math.max(1, pieces, Math.ceil(shift), Math.ceil(turn));
  const piece = () => ({
    t: /** @type {Vec3} */ (whole.t.map((x) => x / count)),
    r: /** @type {Vec3} */ (whole.r.map((x) => x / count)),
  });
  return Array.from({ length: count }, piece);
}
