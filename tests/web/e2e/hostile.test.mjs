// Strangers and broken clients at the gateway's door: refused, one by one, while somebody works on.
import assert from 'node:assert/strict';
import { get } from 'node:http';
import { after, before, test } from 'node:test';
import WebSocket from 'ws';
import { PEGS } from '../support/scenario.mjs';
import { LiveSession } from '../support/session.mjs';

const session = new LiveSession();
let place, token, worker, lost;

/** @param {{protocols?: string[], origin?: string, address?: string}} [how] */
function dial({ protocols = ['mortise.1', `token.${token}`], origin = place.origin, path = '/ws' } = {}) {
  const socket = new WebSocket(`ws://${place.host}${path}`, protocols, { headers: { Origin: origin } });
  socket.seen = [];
  socket.on('error', () => {});
  socket.on('message', (data, binary) => !binary && socket.seen.push(JSON.parse(data)));
  socket.ended = new Promise((done) => socket.once('close', (code) => done(code)));
  socket.refused = new Promise((done) => socket.once('unexpected-response', (_, answer) => done(answer.statusCode)));
  return socket;
}

const opened = (socket) => new Promise((done, fail) => {
  socket.once('open', done);
  socket.once('close', (code) => fail(new Error(`closed with ${code}`)));
});

/** @param {(message: any) => boolean} what */
async function heard(socket, what) {
  for (const until = Date.now() + 20_000; Date.now() < until; await new Promise((r) => setTimeout(r, 10))) {
    const found = socket.seen.find(what);
    if (found) return found;
  }
  throw new Error(`not heard; the last was ${JSON.stringify(socket.seen.at(-1))?.slice(0, 300)}`);
}

let commands = 0;
async function ask(socket, what, keys) {
  const id = ++commands;
  socket.send(JSON.stringify({ type: 'command', id, do: what, ...keys }));
  return heard(socket, (m) => m.type === 'reply' && m.id === id);
}

/** The worker's part still goes where it is sent. */
async function worksOn() {
  const block = worker.scene.parts.find((part) => part.name === 'block').id;
  assert.equal((await ask(worker, 'grab', { part: block })).done, true);
  const moved = new Promise((done) => worker.on('message', (data, binary) => binary && done(data.readUInt32LE(4))));
  worker.send(JSON.stringify({ type: 'move', part: block, t: [0, 0, 0.5] }));
  assert.ok((await moved) >= 1);
  assert.equal((await ask(worker, 'release', { part: block })).done, true);
  assert.equal(lost, undefined);
}

before(async () => {
  await session.serve(PEGS);
  const { designer } = await session.open();
  place = new URL(designer);
  token = new URLSearchParams(place.hash.slice(1)).get('token');
  worker = dial();
  await opened(worker);
  worker.once('close', (code) => (lost = code));
  worker.send(JSON.stringify({ type: 'join', name: 'worker' }));
  await heard(worker, (m) => m.type === 'joined');
  worker.scene = await heard(worker, (m) => m.type === 'scene');
}, { timeout: 240_000 });

after(async () => {
  worker?.terminate();
  await session.end();
});

for (const [what, how, status] of [
  ['a wrong token', { protocols: ['mortise.1', 'token.AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA'] }, 401],
  ['no token', { protocols: ['mortise.1'] }, 401],
  ['a page of another origin', { origin: 'http://evil.example' }, 403],
  ['another place', { path: '/other' }, 404],
]) {
  test(`${what} is refused`, async () => {
    assert.equal(await dial(how).refused, status);
    await worksOn();
  });
}

test('a mesh needs the token', async () => {
  const mesh = `http://${place.host}/mesh/${worker.scene.parts[0].mesh}.bin`;
  assert.equal((await fetch(mesh)).status, 401);
  assert.equal((await fetch(mesh, { headers: { Authorization: `Bearer ${token}` } })).status, 200);
});

test('files beside the page are not served', async () => {
  // fetch would tidy such addresses before it sends them.
  const status = (path) => new Promise((done, fail) => get({ host: place.hostname, port: place.port, path }, (answer) => done(answer.resume().statusCode)).on('error', fail));
  for (const path of ['/../protocol.md', '/..%2fprotocol.md', '/three/../../../README.md', '/three/build/../../package.json', '/.git/config', '/%00', '//etc/passwd', '/node_modules/three/package.json/../../../../README.md']) {
    assert.ok((await status(path)) >= 400, path);
  }
  assert.equal(await status('/main.js'), 200);
});

test('malformed messages are answered with a sentence, then closed', async () => {
  const stranger = dial();
  await opened(stranger);
  for (const text of ['{', '[]', '{"type":"fly"}', '{"type":"move","part":"x"}', '{"type":"move","part":1,"t":[1,2]}', `{"type":"join","name":"${'x'.repeat(500)}"}`]) stranger.send(text);
  assert.equal(await stranger.ended, 1008);
  assert.ok(stranger.seen.filter((m) => m.type === 'error').every((m) => m.text.length > 10));
  await worksOn();
});

test('bytes are no message', async () => {
  const stranger = dial();
  await opened(stranger);
  for (let i = 0; i < 8; ++i) stranger.send(Buffer.alloc(100, i));
  assert.equal(await stranger.ended, 1008);
});

test('a message that is too large closes the line', async () => {
  // Whatever is on its way when the line is closed, the reason arrives.
  for (let i = 0; i < 40; ++i) {
    const stranger = dial();
    await opened(stranger);
    stranger.send(JSON.stringify({ type: 'join', name: 'y'.repeat(1 << (17 + (i % 6))) }));
    assert.equal(await stranger.ended, 1009, `message ${i}`);
  }
  await worksOn();
});

test('a flood closes the line', async () => {
  const stranger = dial();
  await opened(stranger);
  for (let i = 0; i < 3000; ++i) stranger.send(JSON.stringify({ type: 'ping', at: i }));
  assert.equal(await stranger.ended, 1008);
  await worksOn();
});

test('deep nesting and numbers without end are malformed, no more', async () => {
  const stranger = dial();
  await opened(stranger);
  stranger.send('['.repeat(8000));
  stranger.send('{"type":"move","part":1,"t":[1e999,0,0]}');
  stranger.send('{"type":"move","part":99999999999999999999,"t":[1,0,0]}');
  await heard(stranger, (m) => m.type === 'error');
  stranger.terminate();
  await worksOn();
});
