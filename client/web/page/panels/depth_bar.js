// The overlap of a clash against its two thresholds: up to the first it is fake, from the second on real, potential between.
import { small } from '../session/words.js';
import { el } from './dom.js';

/** @typedef {import('../session/session.js').Clash} Clash */

/** What the bar spans: both thresholds and the overlap, with room about them. @param {Clash} clash @returns {[number, number]} */
export function spanOf(clash) {
  const marks = [clash.fake_below, clash.real_above, clash.delta[0], clash.delta[1]].filter(Number.isFinite);
  const lo = Math.min(0, ...marks);
  const hi = Math.max(...marks);
  // One that has gone far beyond must not press the thresholds into one line.
  const wide = Math.max(clash.real_above - Math.min(0, clash.fake_below), 1e-4);
  return [Math.max(lo, -wide), Math.min(hi + 0.15 * (hi - lo || 1e-3), clash.real_above + 2.5 * wide)];
}

/** @param {Clash} clash @param {(mm: number) => number} share */
function zones(clash, share) {
  const [fake, real] = [share(clash.fake_below), share(clash.real_above)];
  return /** @type {const} */ ([['fake', 0, fake], ['potential', fake, real], ['real', real, 1]]);
}

/** @param {HTMLElement} bar filled anew @param {Clash} clash */
export function fillDepthBar(bar, clash) {
  const [lo, hi] = spanOf(clash);
  const share = (/** @type {number} */ mm) => Math.min(1, Math.max(0, (mm - lo) / (hi - lo)));
  const children = zones(clash, share).filter(([, from, to]) => to > from).map(([name, from, to]) => {
    const zone = el('span', { class: `zone is-${name}` });
    zone.style.left = `${100 * from}%`;
    zone.style.width = `${100 * (to - from)}%`;
    return zone;
  });
  const at = el('span', { class: 'at' });
  const [from, to] = [share(clash.delta[0] ?? 0), share(clash.delta[1] ?? clash.delta[0] ?? 0)];
  at.style.left = `min(${100 * from}%, 100% - 3px)`;
  at.style.width = `${100 * (to - from)}%`;
  bar.replaceChildren(...children, at);
  bar.setAttribute('role', 'img');
  bar.setAttribute('aria-label', `overlap ${small(clash.delta[1])}, fake up to ${small(clash.fake_below)}, real above ${small(clash.real_above)}`);
}

/** The figures under the bar. @param {HTMLElement} scale filled anew @param {Clash} clash */
export function fillScale(scale, clash) {
  const texts = [`fake up to ${small(clash.fake_below)}`, `real above ${small(clash.real_above)}`];
  scale.replaceChildren(...texts.map((text) => el('span', {}, text)));
}
