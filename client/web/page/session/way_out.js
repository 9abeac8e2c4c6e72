// The motion that brings a clash apart: the part turns by `r` about the point `about` of it, which moves by `t`, both with constant speed. mm, rad, world axes.
import { multiply, quaternionOf, rotate } from './motion.js';
import { bracket } from './words.js';

/** @typedef {import('./motion.js').Vec3} Vec3 */
/** @typedef {import('./motion.js').Quat} Quat */
/** @typedef {{t: Vec3, r: Vec3, about: Vec3}} Motion */

/** Where a point of the part is after this share of the way. @param {Motion} motion @param {number} share 0 … 1 @param {Readonly<Vec3>} point @returns {Vec3} */
export function carried({ t, r, about }, share, point) {
  const turn = quaternionOf(/** @type {Vec3} */ (r.map((x) => share * x)));
  const arm = rotate(turn, [point[0] - about[0], point[1] - about[1], point[2] - about[2]]);
  return /** @type {Vec3} */ (arm.map((x, i) => about[i] + x + share * t[i]));
}

/** How far and where to the whole way takes a point of the part. @param {Motion} motion @param {Readonly<Vec3>} point @returns {Vec3} */
export function displacement(motion, point) {
  return /** @type {Vec3} */ (carried(motion, 1, point).map((x, i) => x - point[i]));
}

/** @param {{p: Vec3, q: Quat}} pose @param {Motion} motion @param {number} share @returns {{p: Vec3, q: Quat}} */
export function poseOnWay(pose, motion, share) {
  const turn = quaternionOf(/** @type {Vec3} */ (motion.r.map((x) => share * x)));
  return { p: carried(motion, share, pose.p), q: multiply(turn, pose.q) };
}

/** Is there a way that could be shown? @param {import('./session.js').Clash} clash */
export function hasWay({ separation: { way, t, r } }) {
  return way !== 'none' && Math.hypot(...t, ...r) > 0;
}

/** What is known of the way before its end; empty where it was not asked. @param {import('./session.js').Clash} clash @param {(part: number) => string} nameOf */
export function pathSaid({ separation: { path, blocker } }, nameOf) {
  if (path === 'free') return 'the way is free';
  if (path === 'goes deeper') return 'it goes deeper on its way';
  if (path !== 'blocked') return '';
  return blocker ? `${nameOf(blocker)} is in the way` : 'another part is in the way';
}

/** @param {import('./session.js').Clash} clash @param {(part: number) => string} nameOf */
export function waySaid(clash, nameOf) {
  const { separation, gpd } = clash;
  const [moved, other] = separation.moves === 'b' ? [clash.b, clash.a] : [clash.a, clash.b];
  const path = pathSaid(clash, nameOf);
  return `${nameOf(moved)} comes free of ${nameOf(other)} by ${bracket([gpd[1], gpd[1]])}, ${separation.way}${path && `; ${path}`}`;
}
