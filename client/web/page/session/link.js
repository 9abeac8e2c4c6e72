// A place in a session as an address: which session, which clash, when, and from where one looks. It holds no token: whoever opens it comes in with an own one.

/** @typedef {import('./motion.js').Vec3} Vec3 */
/** @typedef {{session: string, clash: number, tick: number, eye: Vec3 | null, at: Vec3 | null}} Place clash 0: none; tick 0: none */

const KEPT = 'mortise.token';
const FIGURES = 3; // thousandths of a millimetre are enough to look from

/** @param {string} page address without what stands behind # @param {Place} place */
export function linkOf(page, { session, clash, tick, eye, at }) {
  const say = new URLSearchParams();
  say.set('session', session);
  if (clash) say.set('clash', `${clash}`);
  if (tick) say.set('tick', `${tick}`);
  for (const [name, point] of /** @type {Array<[string, Vec3 | null]>} */ ([['eye', eye], ['at', at]])) {
    if (point) say.set(name, point.map((x) => Number(x.toFixed(FIGURES))).join(','));
  }
  return `${page.replace(/#.*$/, '')}#${say}`;
}

/** @param {string} hash @returns {Place | null} null: no place is named */
export function placeOf(hash) {
  const said = new URLSearchParams(hash.replace(/^#/, ''));
  if (!said.has('session')) return null;
  const count = (/** @type {string} */ name) => {
    const value = Number(said.get(name) ?? 0);
    return Number.isSafeInteger(value) && value > 0 ? value : 0;
  };
  const point = (/** @type {string} */ name) => {
    const values = (said.get(name) ?? '').split(',').map(Number);
    return values.length === 3 && said.get(name) !== '' && values.every(Number.isFinite) ? /** @type {Vec3} */ (values) : null;
  };
  return { session: said.get('session') ?? '', clash: count('clash'), tick: count('tick'), eye: point('eye'), at: point('at') };
}

/** The token of the address; without one the last that this browser came in with. @param {string} inAddress may be empty @param {Storage} storage */
export function keptToken(inAddress, storage) {
  if (inAddress) storage.setItem(KEPT, inAddress);
  return inAddress || (storage.getItem(KEPT) ?? '');
}

/** It was not accepted. @param {string} token @param {Storage} storage */
export function forgetToken(token, storage) {
  if (storage.getItem(KEPT) === token) storage.removeItem(KEPT);
}
