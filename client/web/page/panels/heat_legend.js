// What the colours on the faces mean: of the chosen clash in micrometres, of many the zones alone.
import { CLASS_COLOURS, hex } from '../session/class_colours.js';
import { scaleOf, zonesOf } from '../session/heat_scale.js';
import { bracket, small } from '../session/words.js';
import { byId, el } from './dom.js';

/** @typedef {import('../session/session.js').Clash} Clash */
/** @typedef {import('../session/heat_scale.js').HeatScale} HeatScale */

/** A lift below this share of the scale is not worth a word. */
const SAID_SHARE = 0.02;
const ALL = /** @type {const} */ ([{ name: 'fake', lo: 0, hi: 1 }, { name: 'potential', lo: 1, hi: 2 }, { name: 'real', lo: 2, hi: 3 }]);

/** @param {import('../desk.js').Desk} desk */
export function makeHeatLegend({ heat }) {
  const box = byId('heat_legend');
  const caption = el('figcaption');
  const scale = el('div', { class: 'scale', 'aria-hidden': 'true' });
  const note = el('p');
  box.append(caption, scale, note);
  let shown = '';

  /** @param {ReadonlyArray<{name: 'fake' | 'potential' | 'real', lo: number, hi: number}>} zones */
  function fillZones(zones) {
    const share = 100 / zones.length;
    scale.replaceChildren(...zones.map(({ name }, i) => {
      const zone = el('span', { class: `zone is-${name}` }, el('b', {}, name[0].toUpperCase()));
      const [light, deep] = CLASS_COLOURS[name].heat;
      zone.style.setProperty('--zone', `linear-gradient(0deg, ${hex(light)}, ${hex(deep)})`);
      zone.style.bottom = `${share * i}%`;
      zone.style.height = `${share}%`;
      return zone;
    }));
  }

  /** @param {number} bottom percent @param {string} text */
  function figure(bottom, text) {
    const label = el('span', { class: 'figure' }, text);
    label.style.bottom = `${bottom}%`;
    scale.append(label);
  }

  /** Where a depth stands on the scale, percent from below. @param {ReturnType<typeof zonesOf>} zones @param {number} mm */
  function heightOf(zones, mm) {
    const at = zones.findIndex(({ hi }) => mm <= hi);
    if (at < 0) return 100;
    const { lo, hi } = zones[at];
    return (100 * (at + Math.max(0, mm - lo) / (hi - lo))) / zones.length;
  }

  /** @param {NonNullable<typeof heat.legend>} legend */
  function showOne({ clash, deepest: found, lift }) {
    const limits = scaleOf(clash);
    const zones = zonesOf(limits);
    fillZones(zones);
    caption.textContent = 'Overlap here';
    zones.forEach(({ lo }, i) => figure((100 * i) / zones.length, small(lo)));
    figure(100, small(limits.top));
    const deepest = Math.max(clash.delta[0] ?? 0, Math.min(clash.delta[1] ?? Infinity, limits.top));
    const at = el('span', { class: 'at' });
    at.style.bottom = `${heightOf(zones, Number.isFinite(deepest) ? deepest : limits.from)}%`;
    scale.append(at);
    const held = lift > SAID_SHARE * (limits.top - limits.from) ? `Held back: ${small(lift)} added, to where the hand would have it.` : '';
    note.textContent = Number.isFinite(found) ? `As they stand ${found > 0 ? `${small(found)} deep` : `${small(-found)} apart`}. ${held}` : '';
    const words = zones.map(({ name, lo, hi }) => `${name} from ${small(lo)} to ${small(hi)}`);
    box.setAttribute('aria-label', `Heat on faces: ${words.join(', ')}; deepest ${bracket(clash.delta)}. ${note.textContent}`);
  }

  function showMany() {
    fillZones(ALL);
    caption.textContent = 'Overlap on faces';
    ['0', 'fake up to', 'real above', 'deepest'].forEach((text, i) => figure((100 * i) / 3, text));
    note.textContent = '';
    box.setAttribute('aria-label', 'Heat on faces: fake, potential and real zones of each clash; deeper is darker');
  }

  heat.onChange = () => {
    const one = heat.legend;
    const now = heat.empty ? '' : one ? `${one.clash.clash} ${one.clash.seq} ${one.deepest.toFixed(5)} ${one.lift.toFixed(5)}` : 'many';
    if (now === shown) return;
    shown = now;
    box.hidden = now === '';
    if (one) showOne(one);
    else if (now) showMany();
  };
}
