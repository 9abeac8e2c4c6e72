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
  if (Math.abs(mm) < 0.99995) return `${(mm * 1000).toFixed(1)} µm`;
  return `${mm.toFixed(3)} mm`;
}

/** @param {import('./session.js').Clash} clash @param {RegExp} words */
function tells(clash, words) {
  return clash.explanation === undefined || words.test(clash.explanation);
}

/** A threshold that was left open when the class was decided is only a bracket: the sentence leaves it out. @param {import('./session.js').Clash} clash */
export function knownFake(clash) {
  const told = tells(clash, /fake (up to|from a gap)/) || Math.abs(clash.fake_below) < 5e-5;
  return Number.isFinite(clash.fake_below) && told ? clash.fake_below : null;
}

/** @param {import('./session.js').Clash} clash */
export function knownReal(clash) {
  const told = tells(clash, /real (above|below a gap)/) || Math.abs(clash.real_above) < 5e-5;
  return Number.isFinite(clash.real_above) && told ? clash.real_above : null;
}

/** A bracket, once when both ends read alike. @param {[number | null, number | null]} range */
export function bracket([lo, hi]) {
  const [a, b] = [small(lo), small(hi)];
  return a === b ? a : `${a} … ${b}`;
}

/** How long something has lasted. @param {number} s */
export function span(s) {
  if (s < 60) return `${s.toFixed(0)} s`;
  const minutes = Math.floor(s / 60);
  return minutes < 60 ? `${minutes} min ${Math.floor(s % 60)} s` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
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
