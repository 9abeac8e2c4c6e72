// What others do and what the session decides, as short sentences.
import { wordsOf } from '../session/unexamined.js';
import { plain, small } from '../session/words.js';

/** @param {import('../desk.js').Desk} desk */
export function makeNews({ session, say }) {
  /** @param {any} d */
  function sentence(d) {
    const who = session.userName(d.user);
    const part = d.part ? session.partName(d.part) : '';
    const mine = d.user === session.me;
    switch (d.kind) {
      case 'join':
        return mine ? '' : `${d.name ?? who} is here`;
      case 'leave':
      case 'liveliness lost':
        return mine ? '' : `${who} is gone`;
      case 'lease end':
        return `${who} let ${part} lie too long: it is free`;
      case 'ask for hand-over':
        return d.other_user === session.me ? `${who} asks you for ${part}` : mine ? `You asked ${session.userName(d.other_user)} for ${part}` : '';
      case 'hand-over':
        return `${who} gave ${part} to ${session.userName(d.other_user)}`;
      case 'decline':
        return d.other_user === session.me ? `${who} keeps ${part}${d.text ? `: ${d.text}` : ''}` : '';
      case 'ask withdrawn':
        return d.other_user === session.me ? `${who} asks no longer for ${part}` : '';
      case 'set policy':
        return `${who}: at a real contact now ${d.text}`;
      case 'set tolerance':
        return `${who} set ${part}${d.feature ? `.${d.feature}` : ''}${d.other ? ` with ${session.partName(d.other)}` : ''} to ${d.text || 'nothing'}`;
      case 'set exclusion':
        return `${who} leaves out ${part} × ${session.partName(d.other)}: ${d.text}`;
      case 'drop exclusion':
        return `${who} judges ${part} × ${session.partName(d.other)} again`;
      case 'undo':
      case 'redo':
      case 'reset':
        return mine ? '' : `${who}: ${d.kind} of ${part}`;
      default:
        return '';
    }
  }

  session.on('decision', (decision) => {
    const text = sentence(decision);
    if (text) say(text);
  });
  /** Clashes that were said to be real: said once, and again when they come back. @type {Set<number>} */
  const real = new Set();
  session.on('event', (event) => {
    const pair = `${session.partName(event.a)} × ${session.partName(event.b)}`;
    const isReal = event.class === 'real' && !event.ended;
    if (isReal && !real.has(event.clash)) say(`Real clash: ${pair}, ${small(event.delta[1])}`, 'bad');
    if (isReal) real.add(event.clash);
    else real.delete(event.clash);
    if (event.approval_lost) say(`${pair} got worse: its approval is lost`, 'bad');
  });
  session.on('waits', ({ a, b, why }) => say(`${session.partName(a)} × ${session.partName(b)} ${wordsOf(why)}. It may clash.`, 'bad'));
  session.on('refused', (increments) => {
    for (const { part, reason } of increments) say(`${session.partName(part)} did not move: ${plain(reason)}`, 'bad');
  });
  session.on('error', (text) => say(text, 'bad'));
}
