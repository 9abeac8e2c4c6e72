import assert from 'node:assert/strict';
import { test } from 'node:test';
import { groundUnder } from '../../../client/web/page/view/ground_place.js';

const box = (min, max) => Object.fromEntries(Object.entries({ min, max }).map(([name, [x, y, z]]) => [name, { x, y, z }]));

test('the ground lies just below the lowest point, about the middle, with room for a soft edge on each side', () => {
  const { at, half, height, soft } = groundUnder(box([-20, 0, 5], [180, 60, 65]));
  assert.deepEqual(at.slice(0, 2), [80, 30]);
  assert.ok(at[2] < 5 && at[2] > 4, `${at[2]}`);
  assert.ok(at[2] + height >= 65, 'what is highest throws a shadow, too');
  assert.ok(half[0] >= 100 + 2.5 * soft && half[1] >= 30 + 2.5 * soft, `${half} for an edge of ${soft}`);
});

test('a long row keeps pixels of its map that are not all too oblong, a tower room for its edge', () => {
  const row = groundUnder(box([0, 0, 0], [1000, 10, 10]));
  assert.ok(row.half[0] / row.half[1] < 2, `${row.half}`);
  const tower = groundUnder(box([-1, -1, 0], [1, 1, 300]));
  assert.ok(tower.half[0] >= 1 + 2.5 * tower.soft && tower.soft > 0);
  assert.ok(tower.fall < 300 && tower.fall > 50);
});

test('under nothing there is no ground', () => {
  assert.equal(groundUnder(box([Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity])), null);
  assert.equal(groundUnder(box([1, 2, 3], [1, 2, 3])), null);
});
