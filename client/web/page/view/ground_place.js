// Where the ground lies under what is shown, and how far its shadow reaches. mm, z up.

/** Room for the soft edge, as a share of the longer side; no side is shorter than this share of the other. */
const MARGIN = 0.22;
const LEAST_SIDE = 0.45;
/** Just below the lowest face, so that both are never in one plane, as a share of the whole. */
const BELOW = 0.002;

/**
 * @typedef {object} Place a rectangle about `at`, of half sides `half`
 * @property {[number, number, number]} at @property {[number, number]} half
 * @property {number} height of what stands on it @property {number} fall the height at which a shadow has a third of its darkness left
 * @property {number} soft standard deviation of its edge
 */

/** @param {{min: {x: number, y: number, z: number}, max: {x: number, y: number, z: number}}} box of all that is shown @returns {Place | null} null: nothing is shown */
export function groundUnder({ min, max }) {
  const [w, d, height] = [max.x - min.x, max.y - min.y, max.z - min.z];
  const size = Math.max(w, d, height);
  if (!(size > 0) || !Number.isFinite(size)) return null;
  const side = Math.max(w, d, 0.5 * height);
  const half = [w, d].map((x) => Math.max(x / 2 + MARGIN * side, LEAST_SIDE * side));
  return {
    at: [(min.x + max.x) / 2, (min.y + max.y) / 2, min.z - BELOW * size], half: [half[0], half[1]], height: height + 2 * BELOW * size,
    fall: 0.45 * size, soft: (MARGIN * side) / 7,
  };
}
