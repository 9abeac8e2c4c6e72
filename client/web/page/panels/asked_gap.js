// How far two parts are apart, as the gateway tells it from the session's log: asked for when both stand still.
import { gapSaid } from '../session/measure.js';

/** @typedef {import('../session/session.js').Part} Part */

/** How long both parts have to stand still before it is asked: a drag asks nothing, and who waits hardly notices. */
const STILL_MS = 400;

/** @param {import('../desk.js').Desk} desk @param {() => void} told there is something else to say */
export function makeAskedGap({ session, connection }, told) {
  /** The poses and the statements of which `said` is. */
  let key = '';
  /** @type {any[]} */
  let stated = [];
  let said = '';
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let wait;
  /** Of the last question: an answer to another one comes too late. */
  let wanted = 0;

  /** @param {number} asked @param {number} a @param {number} b */
  async function ask(asked, a, b) {
    let text;
    try {
      text = ` Gap of the parts: ${gapSaid(await connection.gap(a, b, session.mode === 'replay' ? session.tick : null))}; in brackets that of the real surfaces.`;
    } catch (error) {
      text = ` Real gap not known: ${error instanceof Error ? error.message : error}`;
    }
    if (asked !== wanted) return;
    said = text;
    told();
  }

  /** What is known of it now. @param {Part} a @param {Part} b @returns {string} */
  function between(a, b) {
    if (!session.hasReport) return ' Real gap not known: the gateway knows no log. Start it with mortise web --read-log FILE';
    const now = JSON.stringify([a, b].map(({ id, p, q }) => [id, p, q]));
    if (now === key && stated === session.standing) return said;
    key = now;
    stated = session.standing;
    said = ' The real gap is being computed.';
    clearTimeout(wait);
    const asked = ++wanted;
    wait = setTimeout(() => ask(asked, a.id, b.id), STILL_MS);
    return said;
  }

  function drop() {
    key = '';
    ++wanted;
    clearTimeout(wait);
  }

  return { between, drop };
}
