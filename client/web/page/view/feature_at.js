// Which known face of a part was pointed at.
import { inPart } from '../session/motion.js';
import { offSurface } from '../session/surfaces.js';

/** @typedef {import('../session/session.js').Feature} Feature */

/**
 * The feature of the part whose surface is nearest to the hit.
 * @param {import('../session/session.js').Part} part @param {readonly Feature[]} features @param {import('three').Vector3} hit
 */
export function featureAt(part, features, hit) {
  const at = inPart(part, hit.toArray());
  let best = null;
  let nearest = Math.max(0.3, part.radius * 0.02);
  for (const feature of features) {
    const h = at.reduce((s, value, i) => s + (value - feature.point[i]) * feature.axis[i], 0);
    const [lo, hi] = feature.along;
    const beyond = feature.kind === 'plane' || hi <= lo ? 0 : Math.max(0, lo - h, h - hi);
    const off = offSurface(feature, at) + beyond;
    if (off < nearest) [best, nearest] = [feature, off];
  }
  return best;
}
