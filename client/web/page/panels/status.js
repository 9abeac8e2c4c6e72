// The line to the gateway, the session's server, and the tick.
import { byId, seldom, setText } from './dom.js';

/** @param {import('../desk.js').Desk} desk */
export function makeStatus({ session, line }) {
  const pill = byId('line_state');
  const banner = byId('banner');

  function refresh() {
    pill.dataset.state = line.state;
    const words = { open: session.serverPresent ? session.me === 0 && session.mode === 'live' ? 'Looking on' : 'Connected' : 'No server', connecting: 'Connecting', waiting: 'Not connected', refused: 'No access' };
    setText(byId('line_text'), session.mode === 'replay' && line.state === 'open' ? 'Replay' : words[line.state]);
    pill.title = line.state === 'open' && session.me === 0 && session.role === 'designer' && session.mode === 'live' ? 'Looking on: click to join' : line.text;
    if (line.state === 'open' && !session.serverPresent) pill.dataset.state = 'waiting';
    const trouble = line.state === 'open' ? (session.serverPresent || session.mode === 'replay' ? '' : 'The gateway waits for the server of the session') : line.state === 'connecting' ? '' : line.text;
    banner.hidden = trouble === '';
    setText(banner, trouble);
    setText(byId('session_name'), session.name);
    setText(byId('status_server'), session.me ? `You are ${session.myName}` : session.role === 'observer' ? 'Read-only link' : 'Looking on');
    document.title = session.name ? `${session.name} – mortise` : 'mortise';
    showTick();
  }

  function showTick() {
    setText(byId('status_tick'), `Tick ${session.tick}`);
  }

  session.on('poses', seldom(showTick, 250));
  session.on('pulse', (pulse) => {
    session.tick = Math.max(session.tick, pulse.tick ?? 0);
    showTick();
    setText(byId('status_latency'), pulse.latency_ms ? `Your moves ${pulse.latency_ms.p50.toFixed(0)} ms` : '');
  });
  for (const what of /** @type {const} */ (['server', 'me', 'scene', 'timeline'])) session.on(what, refresh);
  line.onChange = refresh;
  refresh();
}
