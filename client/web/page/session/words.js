// How figures, classes and states read. Colour never stands alone: a class has a letter, a word and a shape.

/** @typedef {import('./session.js').ClashClass} ClashClass */

/** Worst first. */
export const CLASSES = /** @type {const} */ (['real', 'potential', 'fake']);

/** @param {string} name */
export function letterOf(name) {
  return { real: 'R', potential: 'P', fake: 'F' }[name] ?? '–';
}

/** Worst class of the bits of a part. @param {number} bits @returns {ClashClass} */
export function worstOf(bits) {
  if (bits & 4) return 'real';
  if (bits & 2) return 'potential';
  return bits & 1 ? 'fake' : 'none';
}

/** @param {ClashClass} name */
export function rankOf(name) {
  return { real: 3, potential: 2, fake: 1, none: 0 }[name] ?? 0;
}

/** A small length: µm up to a millimetre. @param {number | null | undefined} mm */
export function small(mm) {
  if (mm === null || mm === undefined || !Number.isFinite(mm)) return '–';
  if (Math.abs(mm) < 1) return `${(mm * 1000).toFixed(1)} µm`;
  return `${mm.toFixed(3)} mm`;
}

/** A bracket, once when both ends read alike. @param {[number | null, number | null]} range */
export function bracket([lo, hi]) {
  const [a, b] = [small(lo), small(hi)];
  return a === b ? a : `${a} … ${b}`;
}

/** @param {number} mm */
export function coordinate(mm) {
  return mm.toFixed(4).replace(/^-(0\.0+)$/, '$1');
}

/** @param {number} rad */
export function degrees(rad) {
  return (rad * 180) / Math.PI;
}

/** @param {number} deg */
export function radians(deg) {
  return (deg * Math.PI) / 180;
}

/** @param {number} p */
export function percent(p) {
  return `${(100 * p).toFixed(1)} %`;
}

/** @param {string} word of the protocol, with underscores */
export function plain(word) {
  return word.replaceAll('_', ' ');
}

export const STATUSES = /** @type {const} */ (['new', 'active', 'reviewed', 'approved', 'resolved']);

export const POLICIES = /** @type {const} */ ([
  ['stop', 'Stop at a real contact'],
  ['slide', 'Slide along a real contact'],
  ['report', 'Report only'],
]);
