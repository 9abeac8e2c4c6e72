// What a log was like over time, as figures of a plot: how deep one clash was, what ticks took. Heights are shares of the plot, from below.

/** @typedef {[from: number, to: number, name: import('./session.js').ClashClass, lo: number, hi: number | null, fake: number | null, real: number | null]} Piece ticks; mm */
/** @typedef {{clash: number, a: number, b: number, top: number, pieces: Piece[]}} Depth */
/** @typedef {[from: number, to: number, mean: number, longest: number]} TickTime ticks; µs */

/** The chosen clash, or the worst. Null: none, or nothing was told of the chosen one. @param {Depth[]} depths worst first @param {number} chosen 0 none */
export function depthToShow(depths, chosen) {
  return (chosen ? depths.find(({ clash }) => clash === chosen) : depths[0]) ?? null;
}

/** @param {Depth} depth @param {number} tick @returns {Piece | null} */
export function pieceAt({ pieces }, tick) {
  return pieces.find(([from, to], i) => from <= tick && (tick < to || i === pieces.length - 1 && tick === to)) ?? null;
}

/** Deepest that is certain, and when it was first so. @param {Depth} depth */
export function deepestOf({ pieces }) {
  return pieces.reduce((best, [from, , , lo]) => (lo > best.mm ? { mm: lo, tick: from } : best), { mm: -1, tick: 0 });
}

/** Of a scale that goes by factors of ten, from the shortest mean to the longest tick or the period. @param {TickTime[]} times @param {number} period µs */
export function timeScale(times, period) {
  const low = Math.floor(Math.log10(Math.max(1e-3, Math.min(...times.map(([, , mean]) => mean)))));
  const high = Math.ceil(Math.log10(Math.max(period, ...times.map(([, , , longest]) => longest))));
  return (/** @type {number} */ us) => Math.min(1, Math.max(0, (Math.log10(Math.max(us, 1e-9)) - low) / Math.max(1, high - low)));
}

/** @param {number} us */
export function timeText(us) {
  if (us < 1e3) return `${us.toFixed(0)} µs`;
  return us < 1e6 ? `${Number((us / 1e3).toPrecision(3))} ms` : `${Number((us / 1e6).toPrecision(3))} s`;
}
