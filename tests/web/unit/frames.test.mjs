import assert from 'node:assert/strict';
import { test } from 'node:test';
import { readMesh, readPoseFrame } from '../../../client/web/page/session/frames.js';
import { meshBytes, poseFrame } from '../support/frames.mjs';

const pose = { part: 7, holder: 3, p: [1.5, -2.25, 1e5 + 1e-6], q: [0, 0.6, 0, 0.8], classes: 5 };

test('a pose frame is read as it was written', () => {
  const frame = readPoseFrame(poseFrame(1234, [pose, { ...pose, part: 8, holder: 0 }]));
  assert.equal(frame.tick, 1234);
  assert.equal(frame.count, 2);
  assert.deepEqual([frame.words[0], frame.words[1], frame.words[12], frame.words[16], frame.words[17]], [7, 3, 5, 8, 0]);
  assert.deepEqual([...frame.doubles.subarray(1, 4)], pose.p);
  assert.deepEqual([...frame.floats.subarray(8, 12)], pose.q.map(Math.fround));
});

test('a frame that is not what it says is nothing', () => {
  const whole = poseFrame(1, [pose]);
  for (const bytes of [0, 3, 15, 16, whole.byteLength - 1]) assert.equal(readPoseFrame(whole.slice(0, bytes)), null, `${bytes} bytes`);
  const longer = new Uint8Array(whole.byteLength + 8);
  longer.set(new Uint8Array(whole));
  assert.equal(readPoseFrame(longer.buffer), null);
  const other = whole.slice(0);
  new DataView(other).setUint32(0, 0x12345678, true);
  assert.equal(readPoseFrame(other), null);
  const many = whole.slice(0);
  new DataView(many).setUint32(4, 0xffffffff, true);
  assert.equal(readPoseFrame(many), null);
  const never = whole.slice(0);
  new DataView(never).setFloat64(8, NaN, true);
  assert.equal(readPoseFrame(never), null);
});

test('any one changed byte of a mesh is read or refused, never more than it has', () => {
  const good = meshBytes([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2]);
  assert.deepEqual([...readMesh(good).triangles], [0, 1, 2]);
  for (let at = 0; at < good.byteLength; ++at) {
    const bytes = new Uint8Array(good.slice(0));
    bytes[at] ^= 0xff;
    const mesh = readMesh(bytes.buffer);
    if (mesh) assert.ok(mesh.triangles.every((corner) => corner < mesh.points.length / 3), `byte ${at}`);
  }
  assert.equal(readMesh(good.slice(0, good.byteLength - 4)), null);
  assert.equal(readMesh(meshBytes([0, 0, 0], [0, 0, 1])), null);
});
