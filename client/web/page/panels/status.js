// The line to the gateway, the session's server, and the tick.
import { troubleOf } from '../session/trouble.js';
import { byId, el, seldom, setText } from './dom.js';

/** What is left to wait is counted in whole seconds. */
const COUNT_MS = 250;

/** @param {import('../desk.js').Desk} desk */
export function makeStatus({ session, line, connection, say }) {
  const pill = byId('line_state');
  const banner = byId('banner');
  const title = el('strong', { role: 'status' });
  const text = el('p');
  const again = el('button', { type: 'button', onclick: () => connection.open() }, 'Try now');
  banner.append(title, text, again);
  /** @type {ReturnType<typeof setInterval> | undefined} */
  let counting;
  let lostAt = performance.now();
  let everPresent = false;

  function wordOfLine() {
    if (line.state === 'open' && session.mode === 'replay') return 'Replay';
    if (line.state === 'open' && !session.serverPresent) return 'No server';
    const looksOn = session.me === 0 && session.mode === 'live';
    return { open: looksOn ? 'Looking on' : 'Connected', connecting: 'Connecting', waiting: 'Not connected', refused: 'No access' }[line.state];
  }

  function showTrouble() {
    const { state, told } = line;
    const trouble = troubleOf({ line: state, told, mode: session.mode, serverPresent: session.serverPresent, everPresent, saidGoodbye: session.draining, lostAt }, performance.now());
    banner.hidden = trouble === null;
    banner.dataset.trouble = trouble?.kind ?? '';
    setText(title, trouble?.title ?? '');
    setText(text, trouble?.text ?? '');
    again.hidden = !trouble?.again;
    if (trouble) counting ??= setInterval(showTrouble, COUNT_MS);
    else {
      clearInterval(counting);
      counting = undefined;
    }
  }

  function refresh() {
    pill.dataset.state = line.state === 'open' && !session.serverPresent && session.mode !== 'replay' ? 'waiting' : line.state;
    setText(byId('line_text'), wordOfLine());
    const canJoin = line.state === 'open' && session.me === 0 && session.role === 'designer' && session.mode === 'live';
    pill.title = canJoin ? 'Looking on: click to join' : 'The line to the gateway';
    setText(byId('session_name'), session.name);
    setText(byId('status_server'), session.me ? `You are ${session.myName}` : session.role === 'observer' ? 'Read-only link' : 'Looking on');
    document.title = session.name ? `${session.name} – mortise` : 'mortise';
    showTrouble();
    showTick();
  }

  function showTick() {
    setText(byId('status_tick'), `Tick ${session.tick}`);
  }

  let present = session.serverPresent;
  session.on('server', () => {
    if (present === session.serverPresent) return;
    present = session.serverPresent;
    if (!present) lostAt = performance.now();
    else if (everPresent && line.state === 'open') say(`The server of the session was gone for ${((performance.now() - lostAt) / 1000).toFixed(1)} s: one leads it again, and you go on`, 'good');
    everPresent ||= present;
  });
  session.on('poses', seldom(showTick, 250));
  session.on('pulse', (pulse) => {
    showTick();
    setText(byId('status_latency'), pulse.latency_ms ? `Your moves ${pulse.latency_ms.p50.toFixed(0)} ms` : '');
  });
  session.on('draining', () => say('The server of the session ends soon; another one takes over, or the session ends', 'bad'));
  for (const what of /** @type {const} */ (['server', 'me', 'scene', 'timeline'])) session.on(what, refresh);
  line.onChange = refresh;
  refresh();
}
