// Depth of a clash and times of ticks over the timeline of a log, on its axis.
import { deepestOf, depthToShow, pieceAt, timeScale, timeText } from '../session/log_plots.js';
import { plain, small } from '../session/words.js';
import { el, setText } from './dom.js';

const NS = 'http://www.w3.org/2000/svg';
/** Of the drawings, which are stretched to the axis. */
const [WIDTH, HEIGHT] = [1000, 100];
/** An event that is over in a tick is seen as well. */
const LEAST_WIDTH = 2;

/** @param {string} tag @param {Record<string, string | number>} set */
function shape(tag, set) {
  const made = document.createElementNS(NS, tag);
  for (const [name, value] of Object.entries(set)) made.setAttribute(name, `${value}`);
  return made;
}

/** @param {string} name */
function makePlot(name) {
  const caption = el('p');
  const svg = shape('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: 'none', 'aria-hidden': 'true' });
  const box = el('div', { class: `plot ${name}`, role: 'img' }, caption);
  box.append(svg);
  return { box, caption, svg };
}

/** @param {import('../session/session.js').Session} session @param {import('../session/choice.js').Choice} choice */
export function makeLogPlots(session, choice) {
  const depths = makePlot('depths');
  const ticks = makePlot('ticks');
  const now = el('i', { class: 'now', 'aria-hidden': 'true' });
  const box = el('div', { class: 'plots' }, depths.box, ticks.box, now);

  /** Along the axis. @param {number} tick */
  const share = (tick) => (tick - session.timeline.first_tick) / Math.max(1, session.timeline.last_tick - session.timeline.first_tick);
  /** @param {number} from @param {number} to @param {number} height 0 … 1 @param {string} name */
  const column = (from, to, height, name) => {
    const x = Math.min(WIDTH - LEAST_WIDTH, WIDTH * share(from));
    return shape('rect', { class: name, x, width: Math.max(LEAST_WIDTH, WIDTH * share(to) - x), y: HEIGHT * (1 - height), height: HEIGHT * height });
  };
  /** @param {number} from @param {number} to @param {number} height 0 … 1 @param {string} name */
  const level = (from, to, height, name) => shape('path', { class: name, d: `M${WIDTH * share(from)} ${HEIGHT * (1 - height)}H${Math.max(WIDTH * share(from) + LEAST_WIDTH, WIDTH * share(to))}` });
  const shown = () => depthToShow(session.timeline?.depths ?? [], choice.clash);

  /** @param {ReturnType<typeof makePlot>} plot @param {string} text @param {SVGElement[]} shapes */
  function fill({ box: of, caption, svg }, text, shapes) {
    setText(caption, text);
    of.setAttribute('aria-label', text);
    svg.replaceChildren(...shapes);
  }

  function drawDepth() {
    const depth = shown();
    if (!depth) return fill(depths, choice.clash ? `Depth of #${choice.clash}: not told for this clash` : 'Depth: no clash in this log', []);
    const high = (/** @type {number} */ mm) => Math.min(1, mm / depth.top);
    const deepest = deepestOf(depth);
    const seconds = ((deepest.tick - session.timeline.first_tick) / session.timeline.tick_rate_hz).toFixed(2);
    fill(depths, `Depth of #${depth.clash} ${session.partName(depth.a)} × ${session.partName(depth.b)}: at least ${small(deepest.mm)} at ${seconds} s; top ${small(depth.top)}`,
      depth.pieces.flatMap(([from, to, name, lo, hi, fake, real]) => [
        column(from, to, Math.max(0.02, high(lo)), `is-${name}`),
        ...(hi === null ? [] : [level(from, to, high(hi), `most is-${name}`)]),
        ...(fake === null ? [] : [level(from, to, high(fake), 'fake_below')]),
        ...(real === null ? [] : [level(from, to, high(real), 'real_above')]),
      ]));
  }

  function drawTicks() {
    const { tick_times: times = [], tick_rate_hz, first_tick, last_tick } = session.timeline;
    if (times.length === 0) return fill(ticks, 'Tick times: not measured in this log', []);
    const period = 1e6 / tick_rate_hz;
    const scale = timeScale(times, period);
    const longest = Math.max(...times.map((/** @type {import('../session/log_plots.js').TickTime} */ [, , , us]) => us));
    fill(ticks, `Tick times: up to ${timeText(longest)}; dashed: ${timeText(period)} from tick to tick`, [
      ...times.flatMap((/** @type {import('../session/log_plots.js').TickTime} */ [from, to, mean, most]) => [column(from, to, Math.max(0.02, scale(mean)), 'mean'), level(from, to, scale(most), 'most')]),
      level(first_tick, last_tick, scale(period), 'real_above'),
    ]);
  }

  choice.on('clash', () => session.timeline && drawDepth());
  return {
    box,
    draw() {
      drawDepth();
      drawTicks();
    },
    /** Where the page is. @param {number} tick */
    at(tick) {
      now.style.left = `${100 * share(tick)}%`;
    },
    /** What is plotted at a moment, for who does not see it. @param {number} tick */
    said(tick) {
      const depth = shown();
      const piece = depth && pieceAt(depth, tick);
      return piece ? `; #${depth.clash} ${plain(piece[2])}, at least ${small(piece[3])} deep` : '';
    },
    /** The tick below a point of the screen. @param {number} x */
    tickAt(x) {
      const { left, width } = box.getBoundingClientRect();
      const { first_tick, last_tick } = session.timeline;
      return Math.round(first_tick + Math.min(1, Math.max(0, (x - left) / Math.max(1, width))) * (last_tick - first_tick));
    },
  };
}
