// Figures of the session: clashes by class and by pair, the server's ticks, the way of one's own moves, the line.
import { CLASSES, rankOf, small } from '../session/words.js';
import { byId, el, seldom } from './dom.js';
import { classMark } from './icons.js';

/** @param {string} caption @param {Array<Array<string | Node>>} rows */
function table(caption, rows) {
  return el('table', {}, el('caption', {}, caption),
    el('tbody', {}, ...rows.map(([name, ...cells]) => el('tr', {}, el('th', { scope: 'row' }, name), ...cells.map((cell) => el('td', {}, cell))))));
}

/** @param {number | undefined | null} us */
const microseconds = (us) => (us === undefined || us === null ? '–' : us < 1000 ? `${us.toFixed(0)} µs` : `${(us / 1000).toFixed(2)} ms`);
const count = (/** @type {number | undefined} */ n) => (n === undefined ? '–' : n.toLocaleString('en'));

/** @param {import('../desk.js').Desk} desk @param {() => void} shown some tab */
export function makeStatistics({ session, line }, shown) {
  const panel = byId('statistics_panel');
  panel.classList.add('statistics');
  /** @type {any} */
  let pulse = null;

  function pairs() {
    /** @type {Map<string, import('../session/session.js').Clash>} */
    const worst = new Map();
    for (const clash of session.clashes.values()) {
      const key = `${session.partName(clash.a)} × ${session.partName(clash.b)}`;
      const known = worst.get(key);
      if (!known || rankOf(clash.worst_class) > rankOf(known.worst_class)) worst.set(key, clash);
    }
    const sorted = [...worst].sort(([, a], [, b]) => rankOf(b.worst_class) - rankOf(a.worst_class) || (b.worst_delta?.[1] ?? 0) - (a.worst_delta?.[1] ?? 0));
    return sorted.slice(0, 12).map(([name, clash]) => [name, `${clash.worst_class} ${small(clash.worst_delta?.[1])}`]);
  }

  function refresh() {
    if (panel.hidden) return;
    const classes = CLASSES.map((name) => [el('span', { class: 'row' }, classMark(name), name), count(pulse?.open?.[name]), count(pulse?.total?.[name])]);
    const tick = pulse?.tick_us ?? {};
    const latency = pulse?.latency_ms;
    panel.replaceChildren(
      table('Clashes: open, in all', classes),
      table('Worst of each pair', pairs().length ? pairs() : [['none yet', '']]),
      table('Server, last second', [
        ['Tick, median', microseconds(tick.p50)], ['Tick, 99th percentile', microseconds(tick.p99)], ['Tick, longest', microseconds(tick.max)],
        ['Deadlines missed', count(pulse?.missed_deadlines)], ['Moves refused', count(pulse?.refused)], ['Pairs not examined', count(pulse?.not_examined)], ['Users', count(pulse?.users)],
      ]),
      table('Your line', [
        ['Your moves, median', latency ? `${latency.p50.toFixed(1)} ms` : '–'], ['Your moves, 99th percentile', latency ? `${latency.p99.toFixed(1)} ms` : '–'],
        ['Browser to gateway and back', line.roundTrip ? `${line.roundTrip.toFixed(1)} ms` : '–'],
        ['Pose frames received', count(line.frames)], ['Frames folded for you', count(pulse?.gateway?.poses_folded)], ['Browsers', count(pulse?.gateway?.browsers)],
      ]),
    );
  }

  const soon = seldom(refresh, 200);
  session.on('pulse', (latest) => {
    pulse = latest;
    soon();
  });
  session.on('clashes', soon);

  const tabs = ['clashes', 'rules', 'statistics'];
  const show = (/** @type {string} */ name) => {
    for (const tab of tabs) {
      byId(`tab_${tab}`).setAttribute('aria-selected', String(tab === name));
      byId(`tab_${tab}`).tabIndex = tab === name ? 0 : -1;
      byId(`${tab}_panel`).hidden = tab !== name;
    }
    refresh();
    shown();
  };
  for (const tab of tabs) {
    byId(`tab_${tab}`).onclick = () => show(tab);
    byId(`tab_${tab}`).addEventListener('keydown', (event) => {
      if (event.key !== 'ArrowLeft' && event.key !== 'ArrowRight') return;
      const to = tabs[(tabs.indexOf(tab) + (event.key === 'ArrowRight' ? 1 : tabs.length - 1)) % tabs.length];
      show(to);
      byId(`tab_${to}`).focus();
      event.stopPropagation();
    });
  }
}
