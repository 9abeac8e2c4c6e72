// Replay: play, pause, go anywhere, where clashes begin, and what the log was like over time.
import { plain, rankOf } from '../session/words.js';
import { byId, el, setPressed, setText } from './dom.js';
import { classMark, icon } from './icons.js';
import { makeLogPlots } from './log_plots.js';
import { say } from './said.js';

/** Below this the plots take too much of the view, until they are asked for. */
const ROOM_FOR_PLOTS = '(min-width: 901px) and (min-height: 601px)';

/** @param {import('../desk.js').Desk} desk */
export function makeTimeline({ session, choice, send }) {
  const box = byId('timeline');
  const play = el('button', { type: 'button', class: 'small', onclick: () => toggle() });
  const slider = el('input', { type: 'range', step: '1', 'aria-label': 'Time' });
  const marks = el('div', { class: 'marks', 'aria-hidden': 'true' });
  const time = el('span', { class: 'quiet' });
  const speed = el('select', { 'aria-label': 'Speed' }, ...['0.1', '0.25', '0.5', '1', '2', '4', '8', '16'].map((value) => el('option', { value }, `× ${value}`)));
  speed.value = '1';
  const before = el('button', { type: 'button', onclick: () => jump(-1) }, '◂ Clash');
  const after = el('button', { type: 'button', onclick: () => jump(1) }, 'Clash ▸');
  const plots = makeLogPlots(session, choice);
  plots.box.hidden = !matchMedia(ROOM_FOR_PLOTS).matches;
  const withPlots = el('button', { type: 'button', onclick: () => showPlots(plots.box.hidden) }, 'Plots');
  box.append(play, before, after, el('div', { class: 'track' }, plots.box, marks, slider), time, speed, withPlots);
  const tell = (/** @type {string} */ what, keys = {}) => send({ type: 'replay', do: what, ...keys });
  let seeking = false;

  function toggle() {
    if (session.timeline) tell(session.replay?.playing ? 'pause' : 'play');
  }

  /** @param {boolean} shown */
  function showPlots(shown) {
    plots.box.hidden = !shown;
    setPressed(withPlots, shown);
  }

  /** To the beginning of the next or last clash. @param {number} way */
  function jump(way) {
    const tick = session.replay?.tick ?? session.timeline.first_tick;
    const begins = session.timeline.marks.filter((/** @type {any} */ mark) => mark.kind === 'begin').map((/** @type {any} */ mark) => mark.tick);
    const to = way > 0 ? begins.find((/** @type {number} */ t) => t > tick) : begins.filter((/** @type {number} */ t) => t < tick - 1).at(-1);
    if (to !== undefined) tell('seek', { tick: to });
  }

  function showTime() {
    const { first_tick, last_tick, tick_rate_hz } = session.timeline;
    const tick = seeking ? Number(slider.value) : (session.replay?.tick ?? first_tick);
    if (!seeking) slider.value = `${tick}`;
    const text = `${((tick - first_tick) / tick_rate_hz).toFixed(2)} s of ${((last_tick - first_tick) / tick_rate_hz).toFixed(1)} s`;
    setText(time, text);
    slider.setAttribute('aria-valuetext', text + plots.said(tick));
    plots.at(tick);
    const playing = session.replay?.playing === true;
    if (play.dataset.playing !== String(playing)) {
      play.dataset.playing = String(playing);
      play.replaceChildren(icon(playing ? 'pause' : 'play'));
      play.setAttribute('aria-label', playing ? 'Pause' : 'Play');
    }
  }

  session.on('timeline', (line) => {
    for (const note of line.notes ?? []) say(note);
    box.hidden = false;
    slider.min = `${line.first_tick}`;
    slider.max = `${line.last_tick}`;
    const begins = line.marks.filter((/** @type {any} */ mark) => mark.kind === 'begin');
    begins.sort((/** @type {any} */ a, /** @type {any} */ b) => rankOf(a.class) - rankOf(b.class));
    marks.replaceChildren(...begins.map((/** @type {any} */ mark) => {
      const drawn = classMark(mark.class);
      drawn.style.left = `${(100 * (mark.tick - line.first_tick)) / Math.max(1, line.last_tick - line.first_tick)}%`;
      const title = document.createElementNS('http://www.w3.org/2000/svg', 'title');
      title.textContent = `${plain(mark.class)}: ${session.partName(mark.a)} × ${session.partName(mark.b)}`;
      drawn.append(title);
      return drawn;
    }));
    plots.draw();
    showPlots(!plots.box.hidden);
    showTime();
  });
  session.on('replay', showTime);
  const begin = () => {
    seeking = true;
    showTime();
  };
  const end = () => {
    if (seeking) tell('seek', { tick: Number(slider.value) });
    seeking = false;
  };
  slider.oninput = begin;
  slider.onchange = end;
  // The plots are pressed and dragged as the slider is; keys are the slider's.
  const follow = (/** @type {PointerEvent} */ { clientX }) => {
    slider.value = `${plots.tickAt(clientX)}`;
    begin();
  };
  plots.box.onpointerdown = (event) => {
    plots.box.setPointerCapture(event.pointerId);
    follow(event);
  };
  plots.box.onpointermove = (event) => seeking && follow(event);
  plots.box.onpointerup = plots.box.onpointercancel = end;
  session.on('scene', () => session.timeline && plots.draw()); // names of parts
  choice.on('clash', () => session.timeline && showTime());
  speed.onchange = () => tell('speed', { speed: Number(speed.value) });
  return { toggle };
}
