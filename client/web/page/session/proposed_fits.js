// Bores and shafts that may belong together as the parts stand: for fits that nobody has stated yet.
import { placed, rotate } from './motion.js';

/** @typedef {import('./session.js').Feature} Feature */
/** @typedef {{bore: {part: number, feature: string}, shaft: {part: number, feature: string}, clearance: number, code: string}} ProposedFit clearance of diameters, as modelled, mm; the code that this size has elsewhere, or empty */

const LIKE_SIZES = 0.03;
const AXES = Math.cos(Math.PI / 180);
const BESIDE = 0.1; // of the bore's radius
const LIKE_NOMINAL = 0.05; // mm, of a modelled diameter and a nominal one
const HALF_TURN = 2 / Math.PI; // how far the middle of half a round is from its axis, of its radius

/**
 * Rounds of more than half a turn (less holds no shaft: a fillet, a groove), radii within 3 percent, axes within 1 degree and a tenth of the radius, of two parts of which one moves; not those that have a fit.
 * First those whose size has a declared fit elsewhere.
 * @param {import('./session.js').Session} session @returns {ProposedFit[]}
 */
export function proposedFits({ parts, features, standing }) {
  const stated = new Set(standing.filter((d) => d.kind === 'set tolerance' && d.other && d.text)
    .flatMap((d) => [`${d.part} ${d.feature ?? ''} ${d.other} ${d.other_feature ?? ''}`, `${d.other} ${d.other_feature ?? ''} ${d.part} ${d.feature ?? ''}`]));
  const round = [...parts.values()].flatMap((part) => (features.get(part.id) ?? []).filter((feature) => feature.kind === 'cylinder' && isRound(feature))
    .map((feature) => ({ part, feature, axis: rotate(part.q, feature.axis), at: placed(part, feature.point) })));
  const codeOf = declaredCodes(standing);
  const found = [];
  for (const bore of round.filter(({ feature }) => feature.inward)) {
    for (const shaft of round.filter(({ feature }) => !feature.inward)) {
      if (bore.part === shaft.part || !(bore.part.moving || shaft.part.moving)) continue;
      if (Math.abs(bore.feature.radius - shaft.feature.radius) > LIKE_SIZES * bore.feature.radius) continue;
      if (Math.abs(dot(bore.axis, shaft.axis)) < AXES) continue;
      const off = /** @type {[number, number, number]} */ (shaft.at.map((x, i) => x - bore.at[i]));
      const along = dot(off, bore.axis);
      if (Math.sqrt(Math.max(0, dot(off, off) - along * along)) > BESIDE * bore.feature.radius) continue;
      const end = (/** @type {typeof bore} */ { part, feature }) => ({ part: part.id, feature: feature.name });
      const keys = [[bore.feature.name, shaft.feature.name], ['', '']].map(([a, b]) => `${bore.part.id} ${a} ${shaft.part.id} ${b}`);
      if (keys.some((key) => stated.has(key))) continue;
      found.push({ bore: end(bore), shaft: end(shaft), clearance: 2 * (bore.feature.radius - shaft.feature.radius), code: codeOf(2 * bore.feature.radius) });
    }
  }
  return found.sort((x, y) => Number(y.code !== '') - Number(x.code !== ''));
}

/** The code that is declared for a diameter: "Ø20 H7/g6"; none where a size has several. @param {any[]} standing @returns {(diameter: number) => string} */
function declaredCodes(standing) {
  const declared = standing.filter((d) => d.kind === 'set tolerance' && d.other && /^Ø[\d.]+ \S/.test(d.text ?? ''))
    .map(({ text }) => ({ nominal: Number.parseFloat(text.slice(1)), code: /** @type {string} */ (text) }));
  return (diameter) => {
    const codes = new Set(declared.filter(({ nominal }) => Math.abs(nominal - diameter) <= LIKE_NOMINAL).map(({ code }) => code));
    return codes.size === 1 ? [...codes][0] : '';
  };
}

/** By where the middle of its facets lies: that of a whole round lies on its axis. @param {Feature} feature */
function isRound({ point, axis, middle, radius }) {
  const off = middle.map((x, i) => x - point[i]);
  const along = dot(off, axis);
  return Math.sqrt(Math.max(0, dot(off, off) - along * along)) < HALF_TURN * radius;
}

/** @param {Readonly<number[]>} a @param {Readonly<number[]>} b */
function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
