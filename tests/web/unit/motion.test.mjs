import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Mover } from '../../../client/web/page/session/mover.js';
import { inPieces, multiply, placed, quaternionOf, rotate, rotationVectorOf, sum } from '../../../client/web/page/session/motion.js';

/** Numbers that are the same in each run. */
function* numbers(seed) {
  for (let x = seed; ;) {
    x = (x * 1103515245 + 12345) % 2147483648;
    yield x / 1073741824 - 1;
  }
}
const draw = numbers(7);
const vector = (size) => [0, 0, 0].map(() => size * draw.next().value);
const near = (a, b, within) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) <= within, `${a} is not ${b}`));

/** The twin: what a session does with one increment, a pose turned about the point that the reference stands at. */
function applied(pose, reference, { t, r }) {
  const about = placed(pose, reference);
  const turn = quaternionOf(r);
  const arm = rotate(turn, pose.p.map((x, i) => x - about[i]));
  return { p: about.map((x, i) => x + arm[i] + t[i]), q: multiply(turn, pose.q) };
}

test('a rotation vector comes back from its quaternion', () => {
  for (const size of [1e-9, 1e-5, 1e-3, 1, 1.7]) {
    for (let i = 0; i < 200; ++i) {
      const r = vector(size);
      near(rotationVectorOf(quaternionOf(r)), r, 1e-15 + 1e-12 * size);
    }
  }
});

test('summed increments do what they do one after the other', () => {
  for (let i = 0; i < 300; ++i) {
    const pose = { p: vector(100), q: quaternionOf(vector(1.5)) };
    const reference = vector(20);
    const steps = Array.from({ length: 5 }, (_, k) => ({ t: vector(10), r: k % 2 ? [0, 0, 0] : vector(0.4) }));
    const one = applied(pose, reference, steps.reduce(sum));
    const each = steps.reduce((at, step) => applied(at, reference, step), pose);
    near(one.p, each.p, 1e-10);
    near(rotate(one.q, [1, 2, 3]), rotate(each.q, [1, 2, 3]), 1e-12);
  }
});

test('pieces are short, and together they are the whole', () => {
  for (let i = 0; i < 100; ++i) {
    const whole = { t: vector(80), r: vector(1.5) };
    const pieces = inPieces(whole, 3, { shift: 5, turn: 0.2 });
    assert.ok(pieces.length >= 3);
    for (const { t, r } of pieces) assert.ok(Math.hypot(...t) <= 5 + 1e-12 && Math.hypot(...r) <= 0.2 + 1e-12);
    const sent = pieces.reduce(sum);
    near(sent.t, whole.t, 1e-11);
    near(sent.r, whole.r, 1e-11);
  }
});

test('what was pushed between two beats goes as one, and nothing is lost while there is no line', () => {
  const sent = [];
  let line = false;
  const mover = new Mover((part, increment) => line && sent.push([part, increment]) > 0, 1e6);
  const step = (x) => ({ t: [x, 0, 0], r: [0, 0, 0] });
  for (let i = 0; i < 10; ++i) mover.push(1, step(0.001));
  mover.push(2, step(5));
  mover.beat();
  assert.deepEqual(sent, []);
  line = true;
  mover.push(1, step(1));
  mover.beat();
  assert.equal(sent.length, 2);
  near(sent.find(([part]) => part === 1)[1].t, [1.01, 0, 0], 1e-15);
  mover.glide(1, { t: [0, 0, -28], r: [0, 0, 0] });
  for (let i = 0; i < 40; ++i) mover.beat();
  near(sent.filter(([part]) => part === 1).slice(1).map(([, increment]) => increment).reduce(sum).t, [0, 0, -28], 1e-12);
  assert.equal(mover.isGliding(1), false);
});
