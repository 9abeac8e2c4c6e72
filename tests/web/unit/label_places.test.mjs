import assert from 'node:assert/strict';
import { test } from 'node:test';
import { freePlace } from '../../../client/web/page/view/label_places.js';
import { numbers } from '../support/solids.mjs';

const view = { width: 400, height: 300 };
const size = { width: 100, height: 20 };
const middle = (box) => [(box.left + box.right) / 2, (box.top + box.bottom) / 2];

test('a word stands at its point, and within the view', () => {
  assert.deepEqual(middle(freePlace([], [], { x: 200, y: 100 }, size, view)), [200, 100]);
  assert.deepEqual(middle(freePlace([], [], { x: -50, y: 900 }, size, view)), [50, 290]);
});

test('what lies on the view or was said before moves it by as little as will do', () => {
  const bar = { left: 150, top: 90, right: 250, bottom: 110 };
  assert.deepEqual(middle(freePlace([], [bar], { x: 200, y: 100 }, size, view)), [200, 78]);
  // At the top nothing is above: below; beside where that is nearer.
  assert.deepEqual(middle(freePlace([{ left: 0, top: 0, right: 400, bottom: 40 }], [], { x: 200, y: 20 }, size, view)), [200, 52]);
  assert.deepEqual(middle(freePlace([{ left: 240, top: 0, right: 400, bottom: 300 }], [], { x: 200, y: 100 }, size, view)), [188, 100]);
});

test('where words leave no room, one lies on another, and not under a bar', () => {
  const bar = { left: 0, top: 0, right: 400, bottom: 200 };
  const word = { left: 0, top: 200, right: 400, bottom: 300 };
  const place = freePlace([bar], [word], { x: 200, y: 100 }, size, view);
  assert.ok(place.top >= 200, JSON.stringify(place));
  assert.deepEqual(middle(freePlace([bar, word], [], { x: 200, y: 100 }, size, view)), [200, 100], 'nothing is free');
});

test('wherever a place is free it is found', () => {
  const next = numbers(20261128);
  for (let round = 0; round < 300; ++round) {
    const taken = Array.from({ length: 6 }, () => {
      const [left, top] = [next() * 350, next() * 280];
      return { left, top, right: left + 20 + next() * 150, bottom: top + 10 + next() * 100 };
    });
    const meets = (box) => taken.some((o) => box.left < o.right && o.left < box.right && box.top < o.bottom && o.top < box.bottom);
    let isFree = false;
    for (let x = 53; x < 347 && !isFree; ++x) for (let y = 13; y < 287 && !isFree; ++y) isFree = !meets({ left: x - 53, right: x + 53, top: y - 13, bottom: y + 13 });
    const place = freePlace(taken.slice(0, 3), taken.slice(3), { x: next() * 400, y: next() * 300 }, size, view);
    assert.ok(place.left >= 0 && place.right <= 400 && place.top >= 0 && place.bottom <= 300);
    if (isFree) assert.ok(!meets(place), `round ${round}`);
  }
});
