// The scale of heat of one clash: fake up to the one threshold, potential between, real above the other. Each zone is drawn equally tall, whatever its width.

import { knownFake, knownReal } from './words.js';

/** @typedef {import('./session.js').Clash} Clash */
/**
 * @typedef {object} HeatScale mm
 * @property {number} from where colour begins: no overlap, or less where less may be an interference already
 * @property {number} fake up to here @property {number} real from here @property {number} top the deepest colour
 */

/** A zone without a width is drawn in no colour, but real needs one to deepen in. */
const LEAST_REAL_MM = 0.005;

/** @param {Clash} clash @returns {HeatScale} */
export function scaleOf(clash) {
  const known = knownReal(clash);
  const real = known ?? Math.max(0, knownFake(clash) ?? 0, clash.class === 'real' ? 0 : (clash.delta[0] ?? 0));
  const fake = Math.min(knownFake(clash) ?? 0, real);
  const from = Math.min(0, fake);
  const deepest = clash.delta.reduce((/** @type {number} */ most, d) => Math.max(most, d ?? 0), 0);
  return { from, fake: Math.max(fake, from), real, top: Math.max(real + Math.max(LEAST_REAL_MM, 0.5 * (real - from)), deepest) };
}

/** Zones that have a width, from below. @param {HeatScale} scale @returns {Array<{name: 'fake' | 'potential' | 'real', lo: number, hi: number}>} */
export function zonesOf({ from, fake, real, top }) {
  const zones = /** @type {const} */ ([['fake', from, fake], ['potential', fake, real], ['real', real, top]]);
  return zones.filter(([, lo, hi]) => hi > lo).map(([name, lo, hi]) => ({ name, lo, hi }));
}

/**
 * What is to be added to the field of the parts as they stand, so that its deepest point is as deep as the session says: a part that was held
 * back stands in contact, while the clash tells where the hand would have had it.
 * @param {Clash} clash @param {number} deepest of the field
 */
export function liftOf(clash, deepest) {
  const least = Math.min(clash.delta[0] ?? 0, clash.delta[1] ?? Infinity);
  return Number.isFinite(deepest) && clash.class !== 'fake' ? Math.max(0, least - deepest) : 0;
}
