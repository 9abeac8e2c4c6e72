import assert from 'node:assert/strict';
import { test } from 'node:test';
import { carried, displacement, hasWay, poseOnWay, waySaid } from '../../../client/web/page/session/way_out.js';
import { placed, quaternionOf } from '../../../client/web/page/session/motion.js';

const near = (a, b, most = 1e-12) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) <= most, `${a} is not ${b}`));
const quarter = { t: [0, 0, 4], r: [0, 0, Math.PI / 2], about: [10, 0, 0] };

test('a way that turns carries a point about its reference point, and further the farther it is', () => {
  near(carried(quarter, 1, [13, 0, 0]), [10, 3, 4]);
  near(carried(quarter, 0, [13, 0, 0]), [13, 0, 0]);
  near(carried(quarter, 0.5, [12, 0, 0]), [10 + Math.SQRT2, Math.SQRT2, 2]);
  near(displacement(quarter, [10, 0, 7]), [0, 0, 4]);
  near(displacement(quarter, [10, -5, 0]), [5, 5, 4]);
});

test('where the way is small the displacement is t + r × (p - about)', () => {
  const motion = { t: [1e-6, 0, 0], r: [0, 2e-6, 0], about: [0, 0, 1] };
  near(displacement(motion, [0, 0, 4]), [1e-6 + 2e-6 * 3, 0, 0], 1e-11);
});

test('the pose of the ghost carries every point of the part as the way does', () => {
  const pose = { p: [3, -2, 8], q: quaternionOf([0.4, -0.2, 0.9]) };
  const motion = { t: [1, 2, 3], r: [0.3, -0.8, 0.5], about: [4, 4, -1] };
  for (const share of [0, 0.25, 1]) {
    for (const point of [[0, 0, 0], [5, -1, 2], [-20, 3, 7]]) {
      near(placed(poseOnWay(pose, motion, share), point), carried(motion, share, placed(pose, point)), 1e-12);
    }
  }
});

test('a way is told with its length, and what is in it', () => {
  const names = { 1: 'plate', 2: 'peg', 3: 'cover' };
  const clash = (path, more) => ({ a: 1, b: 2, gpd: [0.01, 0.0124], separation: { ...quarter, moves: 'b', way: 'along the axis', path, blocker: 0, ...more } });
  const said = (path, more) => waySaid(clash(path, more), (part) => names[part]);
  assert.equal(said('free'), 'peg comes free of plate by 12.4 µm, along the axis; the way is free');
  assert.equal(said('goes deeper', { moves: 'a' }), 'plate comes free of peg by 12.4 µm, along the axis; it goes deeper on its way');
  assert.equal(said('blocked', { blocker: 3 }), 'peg comes free of plate by 12.4 µm, along the axis; cover is in the way');
  assert.equal(said('not asked'), 'peg comes free of plate by 12.4 µm, along the axis');
  assert.ok(hasWay(clash('free', { t: [0, 0, 0] })), 'one that only turns is a way');
  assert.ok(!hasWay(clash('free', { way: 'none' })));
});
