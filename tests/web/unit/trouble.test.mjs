import assert from 'node:assert/strict';
import { test } from 'node:test';
import { troubleOf as troubleOfStatus } from '../../../client/web/page/session/connection.js';
import { troubleOf } from '../../../client/web/page/session/trouble.js';

const fine = { line: 'open', told: { trouble: '', why: '', retryAt: 0 }, mode: 'live', serverPresent: true, everPresent: true, saidGoodbye: false, lostAt: 0 };
const told = (trouble, why = '', retryAt = 0) => ({ trouble, why, retryAt });

test('nothing is said while all is well, and while the line is being opened', () => {
  assert.equal(troubleOf(fine, 0), null);
  assert.equal(troubleOf({ ...fine, line: 'connecting', serverPresent: false }, 0), null);
  assert.equal(troubleOf({ ...fine, serverPresent: false, mode: 'replay' }, 0), null);
});

test('a token that is wrong, and none at all, are told apart; neither counts down', () => {
  const none = troubleOf({ ...fine, line: 'refused', told: told('no_token') }, 0);
  const wrong = troubleOf({ ...fine, line: 'refused', told: told('token') }, 0);
  assert.deepEqual([none.kind, wrong.kind], ['no_token', 'token']);
  assert.match(wrong.text, /Ask who runs the session/);
  assert.doesNotMatch(none.text + wrong.text, / in \d+ s/);
});

test('seconds are counted down to the next attempt', () => {
  const at = (now) => /Trying again (in \d+ s|now)/.exec(troubleOf({ ...fine, line: 'waiting', told: told('gateway', '', 5000) }, now).text)[1];
  assert.deepEqual([0, 900, 1000, 4999, 5000, 9000].map(at), ['in 5 s', 'in 5 s', 'in 4 s', 'in 1 s', 'now', 'now']);
});

test('what the gateway said when it closed the line is repeated', () => {
  assert.match(troubleOf({ ...fine, line: 'waiting', told: told('closed', 'you took nothing for 10 s') }, 0).text, /It said: you took nothing for 10 s/);
});

test('a server that has said that it ends is waited for as long as a take-over lasts, one that has not for ever', () => {
  const gone = (saidGoodbye, s) => troubleOf({ ...fine, serverPresent: false, saidGoodbye, lostAt: 1000 }, 1000 + 1000 * s).kind;
  assert.deepEqual([gone(true, 1), gone(true, 7), gone(false, 7)], ['take_over', 'ended', 'take_over']);
  assert.equal(troubleOf({ ...fine, serverPresent: false, everPresent: false }, 0).kind, 'no_server');
});

test('why an attempt had no success is known by HTTP', () => {
  assert.deepEqual([401, 0, 200, 503].map(troubleOfStatus), ['token', 'gateway', 'full', 'full']);
});
