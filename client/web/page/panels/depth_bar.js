// The overlap of a clash against its two thresholds: up to the first it is fake, from the second on real, potential between.
import { scaleOf } from '../session/heat_scale.js';
import { knownFake, knownReal, small } from '../session/words.js';
import { el } from './dom.js';

/** @typedef {import('../session/session.js').Clash} Clash */

/** What the bar spans: both thresholds and the overlap, with room about them. @param {Clash} clash @returns {[number, number]} */
export function spanOf(clash) {
  const { fake, real } = scaleOf(clash);
  const marks = [fake, real, clash.delta[0], clash.delta[1]].filter((mm) => mm !== null && Number.isFinite(mm));
  const lo = Math.min(0, ...marks);
  const hi = Math.max(...marks);
  // One that has gone far beyond must not press the thresholds into one line.
  const wide = Math.max(real - Math.min(0, fake), 1e-4);
  return [Math.max(lo, -wide), Math.min(hi + 0.15 * (hi - lo || 1e-3), real + 2.5 * wide)];
}

/** @param {Clash} clash @param {(mm: number) => number} share */
function zones(clash, share) {
  const limits = scaleOf(clash);
  const [fake, real] = [share(limits.fake), share(limits.real)];
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
  bar.setAttribute('aria-label', [`overlap ${small(clash.delta[1])}`, ...limits(clash)].join(', '));
}

/** The thresholds that are known. @param {Clash} clash */
function limits(clash) {
  const [fake, real] = [knownFake(clash), knownReal(clash)];
  return [...(fake === null ? [] : [`fake up to ${small(fake)}`]), ...(real === null ? [] : [`real above ${small(real)}`])];
}

/** The figures under the bar. @param {HTMLElement} scale filled anew @param {Clash} clash */
export function fillScale(scale, clash) {
  scale.replaceChildren(...limits(clash).map((text) => el('span', {}, text)));
}
