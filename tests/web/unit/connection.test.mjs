// The line to the gateway, without a network: when the page takes it for broken.
import assert from 'node:assert/strict';
import { afterEach, test } from 'node:test';
import { Connection } from '../../../client/web/page/session/connection.js';

const all = /** @type {any} */ (globalThis);
const before = { setInterval: all.setInterval, WebSocket: all.WebSocket, location: all.location, now: performance.now };
afterEach(() => {
  performance.now = before.now;
  Object.assign(all, { setInterval: before.setInterval, WebSocket: before.WebSocket, location: before.location });
});

/** A line that is open, and what the page has done to it. */
function openLine() {
  all.location = { href: 'http://127.0.0.1:1/', protocol: 'http:' };
  /** @type {any} */
  let socket;
  all.WebSocket = class {
    static OPEN = 1;
    readyState = 1;
    sent = [];
    closed = 0;
    constructor() {
      socket = this;
    }
    send(text) {
      this.sent.push(JSON.parse(text));
    }
    close(code) {
      this.closed = code;
    }
  };
  let ping = () => {};
  all.setInterval = (/** @type {() => void} */ turn) => (ping = turn);
  const connection = new Connection('t', { message: () => {}, poses: () => {}, state: () => {}, roundTrip: () => {} });
  connection.open();
  socket.onopen();
  return { socket, ping: () => ping(), answer: () => socket.onmessage({ data: JSON.stringify({ type: 'pong', at: performance.now() }) }) };
}

test('a page that stood still for long goes on with its line: what came meanwhile has not been read yet', () => {
  const { socket, ping, answer } = openLine();
  ping();
  answer();
  performance.now = () => before.now.call(performance) + 60_000;
  ping(); // its turn comes before the messages'
  assert.equal(socket.closed, 0);
  answer();
  ping();
  assert.equal(socket.closed, 0);
});

test('a gateway that answers three pings in a row with nothing is gone', () => {
  const { socket, ping } = openLine();
  for (let pings = 0; pings < 3; ++pings) ping();
  assert.deepEqual([socket.closed, socket.sent.length], [0, 3]);
  ping();
  assert.equal(socket.closed, 4000);
});
