// What others do and what the session decides, as short sentences.
import { wordsOf } from '../session/unexamined.js';
import { plain, small } from '../session/words.js';

/** Once a second; what the tick after a decision judges is told in between. */
const PULSES_TO_JUDGE = 2;

/** What became of the clashes of a part that is another one now. @param {string} name @param {Set<number>} before @param {Set<number>} now */
export function changeSaid(name, before, now) {
  const kept = [...before].filter((clash) => now.has(clash)).length;
  const [gone, fresh] = [before.size - kept, now.size - kept];
  if (before.size + now.size === 0) return `${name}: no clashes, as before`;
  return `Clashes of ${name}: ${[kept > 0 && `${kept} as before`, gone > 0 && `${gone} gone`, fresh > 0 && `${fresh} new`].filter(Boolean).join(', ')}`;
}

/** Of a part that one held before the line was away. @param {string} part @param {string} holder empty: nobody */
export const droppedSaid = (part, holder) => `You no longer hold ${part}: ${holder ? `${holder} took it` : 'the session let it go'} while you were away`;

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
        return mine ? '' : `${who} is gone`;
      case 'liveliness lost':
        return mine ? 'The session heard nothing of your gateway for a moment: what you held is free' : `${who} is gone`;
      case 'lease end':
        return `${mine ? 'You' : who} let ${part} lie too long: it is free`;
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
      case 'add part':
        return mine ? '' : `${who} added ${d.name ?? part}`;
      case 'replace part':
        return `${who} replaced ${d.name ?? part}${d.text ? `: ${d.text}` : ''}`;
      case 'remove part':
        return mine ? '' : `${who} removed ${part}`;
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
    if (decision.kind === 'replace part') follow(decision.part);
  });

  /** Parts that were replaced, with the clashes that they had, until they are judged again. @type {Array<{part: number, name: string, before: Set<number>, pulses: number}>} */
  let replaced = [];
  /** Open at the last pulse: with a replaced part the scene as it is then may come before the decision. @type {Array<{clash: number, a: number, b: number}>} */
  let open = [];
  const clashesOf = (/** @type {number} */ part, /** @type {typeof open} */ among = session.openClashes()) => new Set(among.filter(({ a, b }) => a === part || b === part).map(({ clash }) => clash));

  /** @param {number} part */
  function follow(part) {
    const before = replaced.find((row) => row.part === part)?.before ?? clashesOf(part, open);
    replaced = [...replaced.filter((row) => row.part !== part), { part, name: session.partName(part), before, pulses: 0 }];
  }

  session.on('pulse', () => {
    for (const row of replaced) ++row.pulses;
    for (const { part, name, before } of replaced.filter(({ pulses }) => pulses >= PULSES_TO_JUDGE)) say(changeSaid(name, before, clashesOf(part)));
    replaced = replaced.filter(({ pulses }) => pulses < PULSES_TO_JUDGE);
    open = session.openClashes().map(({ clash, a, b }) => ({ clash, a, b }));
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
  session.on('dropped', (parts) => {
    for (const { id, holder } of parts) say(droppedSaid(session.partName(id), holder ? session.userName(holder) : ''), 'bad');
  });
  session.on('error', (text) => say(text, 'bad'));
}
