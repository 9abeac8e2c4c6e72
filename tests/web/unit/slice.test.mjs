import assert from 'node:assert/strict';
import { test } from 'node:test';
import { quaternionOf, rotate } from '../../../client/web/page/session/motion.js';
import { across, chains, cross, dot, nearest, slice } from '../../../client/web/page/session/slice.js';

/** A box of these half lengths. */
function box([x, y, z]) {
  const points = [];
  for (let i = 0; i < 8; ++i) points.push(i & 1 ? x : -x, i & 2 ? y : -y, i & 4 ? z : -z);
  const faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  return { points: new Float32Array(points), triangles: new Uint32Array(faces.flatMap(([a, b, c, d]) => [a, b, c, a, c, d])) };
}

/** Signed by the sense of the loop. */
function area(loop) {
  let twice = 0;
  for (let i = 1; i < loop.length; ++i) twice += loop[i - 1][0] * loop[i][1] - loop[i - 1][1] * loop[i][0];
  return twice / 2;
}

test('a cut box is one closed loop of the right area, however box and plane are turned together', () => {
  const mesh = box([10, 20, 30]);
  for (let i = 0; i < 50; ++i) {
    const q = quaternionOf([0.1 * i, 1 - 0.07 * i, 0.3]);
    const p = [5 * i, -3, 100];
    const plane = { origin: p, u: rotate(q, [1, 0, 0]), v: rotate(q, [0, 1, 0]) };
    const loops = chains(slice(mesh, { p, q }, plane));
    assert.equal(loops.length, 1);
    assert.ok(Math.abs(Math.abs(area(loops[0])) - 800) < 1e-3, `area ${area(loops[0])}`);
    assert.ok(Math.hypot(loops[0][0][0] - loops[0].at(-1)[0], loops[0][0][1] - loops[0].at(-1)[1]) < 1e-4);
  }
});

test('a plane through corners cuts no edge twice', () => {
  const plane = { origin: [0, 0, 30], u: [1, 0, 0], v: [0, 1, 0] };
  const loops = chains(slice(box([10, 20, 30]), { p: [0, 0, 0], q: [0, 0, 0, 1] }, plane));
  assert.ok(loops.length <= 1);
  const beyond = { ...plane, origin: [0, 0, 30.001] };
  assert.equal(slice(box([10, 20, 30]), { p: [0, 0, 0], q: [0, 0, 0, 1] }, beyond).length, 0);
});

test('across is across, of length one', () => {
  for (const v of [[0, 0, 1], [1, 0, 0], [0.6, 0, 0.8], [0, -1, 0]]) {
    assert.ok(Math.abs(dot(across(v), v)) < 1e-15);
    assert.ok(Math.abs(Math.hypot(...across(v)) - 1) < 1e-15);
    assert.ok(Math.abs(Math.hypot(...cross(v, across(v))) - 1) < 1e-15);
  }
});

test('the nearest point of some segments', () => {
  const segments = [[1, -1, 1, 1], [5, 0, 6, 0], [0, 3, 0, 3]];
  assert.deepEqual(nearest(segments), { apart: 1, at: [1, 0] });
  assert.deepEqual(nearest(segments, [7, 1]), { apart: Math.SQRT2, at: [6, 0] });
  assert.deepEqual(nearest(segments, [0, 4]), { apart: 1, at: [0, 3] });
  assert.equal(nearest([]).apart, Infinity);
});
