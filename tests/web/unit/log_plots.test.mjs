import assert from 'node:assert/strict';
import { test } from 'node:test';
import { deepestOf, depthToShow, pieceAt, timeScale, timeText } from '../../../client/web/page/session/log_plots.js';

const depth = { clash: 3, a: 1, b: 2, top: 2, pieces: [[10, 20, 'fake', 0, 0.1, 0.2, null], [20, 40, 'real', 2, null, 0.2, 0.5], [50, 60, 'potential', 0.3, 0.4, 0.2, 0.5]] };

test('the chosen clash is plotted, or the worst', () => {
  const other = { ...depth, clash: 7 };
  assert.equal(depthToShow([depth, other], 0), depth);
  assert.equal(depthToShow([depth, other], 7), other);
  assert.equal(depthToShow([depth, other], 9), null);
  assert.equal(depthToShow([], 0), null);
});

test('at a moment stands what the last event before it said, until the clash ended', () => {
  const names = (ticks) => ticks.map((tick) => pieceAt(depth, tick)?.[2] ?? '');
  assert.deepEqual(names([9, 10, 19, 20, 39, 40, 50, 60, 61]), ['', 'fake', 'fake', 'real', 'real', '', 'potential', 'potential', '']);
  assert.deepEqual(deepestOf(depth), { mm: 2, tick: 20 });
});

test('times of ticks stand by factors of ten, between the shortest mean and the longest or the period', () => {
  const scale = timeScale([[0, 60, 10, 900], [60, 120, 200, 3000]], 16667);
  assert.deepEqual([10, 1000, 100000, 1, 1e9].map((us) => Number(scale(us).toFixed(3))), [0, 0.5, 1, 0, 1]);
  assert.deepEqual([4, 1234, 16667, 2.5e6].map(timeText), ['4 µs', '1.23 ms', '16.7 ms', '2.5 s']);
});
