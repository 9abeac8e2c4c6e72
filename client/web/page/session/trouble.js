// What is wrong with the line or the session, in words, and what to do about it. Nothing is known here but the time.

/** A server that stands by leads within two seconds; one that has said that it ends is then not replaced. */
const TAKE_OVER_S = 6;

/**
 * @typedef {object} Seen
 * @property {import('./connection.js').LineState} line @property {import('./connection.js').LineTold} told
 * @property {string} mode @property {boolean} serverPresent @property {boolean} everPresent was there a server since this page was opened?
 * @property {boolean} saidGoodbye the last server said that it ends @property {number} lostAt when it was gone, by the same clock as now
 */
/** @typedef {{kind: string, title: string, text: string, again: boolean}} Words again: one can try now */

/** @param {number} ms */
const seconds = (ms) => Math.max(0, Math.ceil(ms / 1000));

/** @param {Seen} seen @param {number} now ms @returns {Words | null} null: all is well */
export function troubleOf(seen, now) {
  if (seen.line === 'refused') return refused(seen.told.trouble);
  if (seen.line === 'waiting') return waiting(seen.told, now);
  if (seen.line !== 'open' || seen.serverPresent || seen.mode === 'replay') return null;
  return withoutServer(seen, Math.max(0, Math.floor((now - seen.lostAt) / 1000)));
}

/** @param {string} trouble @returns {Words} */
function refused(trouble) {
  if (trouble === 'no_token') {
    return { kind: 'no_token', title: 'This address has no token', again: false,
      text: 'Open the whole address that mortise web printed, with what stands behind #, once in this browser. Links of colleagues work from then on.' };
  }
  return { kind: 'token', title: 'This address is not valid, or no longer', again: true,
    text: 'Its token is wrong or has expired: a gateway that is started anew makes new ones. Ask who runs the session for the present address and open that.' };
}

/** @param {import('./connection.js').LineTold} told @param {number} now @returns {Words} */
function waiting({ trouble, why, retryAt }, now) {
  const left = seconds(retryAt - now);
  const next = left > 0 ? `Trying again in ${left} s.` : 'Trying again now.';
  if (trouble === 'full') return { kind: 'full', title: 'The gateway takes no more browsers', again: true, text: `Close the page where it is not needed. ${next}` };
  const closed = trouble === 'closed' && why !== '' ? `It said: ${why}. ` : '';
  return { kind: 'gateway', title: 'No line to the gateway', again: true,
    text: `${closed}What is shown is the last that was heard; nothing that you do is sent. What is in your hand stays yours for some seconds. ${next} If it stays away, start mortise web again.` };
}

/** @param {Seen} seen @param {number} gone s @returns {Words} */
function withoutServer({ everPresent, saidGoodbye }, gone) {
  if (!everPresent) {
    return { kind: 'no_server', title: 'No server leads this session yet', again: false,
      text: `The gateway waits for the server of the session since ${gone} s. The page goes on by itself once one is started.` };
  }
  if (saidGoodbye && gone >= TAKE_OVER_S) {
    return { kind: 'ended', title: 'The session has ended', again: false,
      text: 'Its server closed in good order and none has taken over. What is shown is the end. Its log can be watched with mortise web --replay LOG; '
        + 'a server that is started with --restore LOG goes on with it, and this page with that.' };
  }
  const after = saidGoodbye ? 'It has said that it ends.' : 'It has not said that it ends.';
  return { kind: 'take_over', title: 'The server of the session is gone', again: false,
    text: `Since ${gone} s the gateway waits for the server. ${after} One that stands by takes over within seconds, and you go on under your name; `
      + 'else start it again with --restore LOG.' };
}
