// Bores and shafts that may belong together as the parts stand: for fits that nobody has stated yet.
import { placed, rotate } from './motion.js';

/** @typedef {import('./session.js').Feature} Feature */
/** @typedef {import('./session.js').Reply} Reply */
/** @typedef {{part: number, feature: string}} End */
/** @typedef {{bore: End, shaft: End, hole: number, pin: number, clearance: number, code: string}} ProposedFit diameters and their difference, as modelled, mm; the code that this size has elsewhere, or empty */
/** @typedef {{key: string, places: [string, string], fits: ProposedFit[]}} FitGroup patterns of the paths of the two parts; at least one fit, all with the same sizes and code */
/** @typedef {{done: ProposedFit[], missed: Array<{fit: ProposedFit, why: string}>}} SetFits */

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
      const [hole, pin] = [2 * bore.feature.radius, 2 * shaft.feature.radius];
      found.push({ bore: end(bore), shaft: end(shaft), hole, pin, clearance: hole - pin, code: codeOf(hole) });
    }
  }
  return found.sort((x, y) => Number(y.code !== '') - Number(x.code !== ''));
}

/** "arm/servo_2/horn" as "arm/servo*" and its horn: siblings that are numbered are of one kind, as in `check --propose`. @param {string} path */
const patternOf = (path) => path.split('/').map((piece) => piece.replace(/^(.*)_\d+$/, '$1*')).join('/');

/** A diameter as it is written, to the micrometre. @param {number} mm */
export const sizeText = (mm) => `Ø${Number(mm.toFixed(3))}`;

/** Fits of parts of one pattern and of one size, each group where its first one stands. @param {ProposedFit[]} fits @param {(part: number) => string} nameOf @returns {FitGroup[]} */
export function fitGroups(fits, nameOf) {
  /** @type {Map<string, FitGroup>} */
  const groups = new Map();
  for (const fit of fits) {
    const places = /** @type {[string, string]} */ ([fit.bore, fit.shaft].map(({ part }) => patternOf(nameOf(part))));
    const key = [...places, sizeText(fit.hole), sizeText(fit.pin), fit.code].join('|');
    const group = groups.get(key) ?? { key, places, fits: [] };
    group.fits.push(fit);
    groups.set(key, group);
  }
  return [...groups.values()];
}

/**
 * One after the other, so that nothing is lost in a queue that is full; each that is refused is kept with the reason. Where nobody answers, the rest is not asked.
 * @param {(what: string, keys: object) => Promise<Reply>} request @param {ProposedFit[]} fits @param {(fit: ProposedFit) => string} codeOf an empty one drops the fit
 * @returns {Promise<SetFits>}
 */
export async function setFits(request, fits, codeOf) {
  /** @type {SetFits} */
  const told = { done: [], missed: [] };
  let silent = '';
  for (const fit of fits) {
    const { bore, shaft } = fit;
    const reply = silent ? null : await request('fit', { part: bore.part, feature: bore.feature, other: shaft.part, other_feature: shaft.feature, text: codeOf(fit) });
    if (reply?.done) {
      told.done.push(fit);
      continue;
    }
    const why = reply ? reply.text || `refused: ${reply.refusal}` : silent;
    told.missed.push({ fit, why });
    if (reply?.refusal === 'not_connected' || reply?.refusal === 'no_answer') silent = why;
  }
  return told;
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
