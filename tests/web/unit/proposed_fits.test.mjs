import assert from 'node:assert/strict';
import { test } from 'node:test';
import { proposedFits } from '../../../client/web/page/session/proposed_fits.js';

const UPRIGHT = [0, 0, 0, 1];
const ON_ITS_SIDE = [Math.SQRT1_2, 0, 0, Math.SQRT1_2];
const round = (name, radius, inward, point = [0, 0, 0], middle = point) => ({ name, kind: 'cylinder', inward, radius, point, axis: [0, 0, 1], middle });

/** A plate with a bore of radius 10 at x = 5, and a peg at `p`. */
function scene({ p = [5, 0, 40], q = UPRIGHT, radius = 9.9, moving = true, standing = [], middle = undefined } = {}) {
  const parts = [{ id: 1, p: [0, 0, 0], q: UPRIGHT, moving: false }, { id: 2, p, q, moving }];
  const features = new Map([[1, [round('bore', 10, true, [5, 0, 0]), { name: 'top', kind: 'plane' }]], [2, [round('journal', radius, false, [0, 0, 0], middle)]]]);
  return { parts: new Map(parts.map((part) => [part.id, part])), features, standing };
}

test('a bore and a shaft of like size that lie on one axis may be a fit', () => {
  const [fit, ...more] = proposedFits(scene());
  assert.deepEqual(more, []);
  assert.deepEqual([fit.bore, fit.shaft], [{ part: 1, feature: 'bore' }, { part: 2, feature: 'journal' }]);
  assert.ok(Math.abs(fit.clearance - 0.2) < 1e-12);
});

test('what lies elsewhere, is turned, of another size, or stands as the other does is none', () => {
  for (const other of [{ p: [6.1, 0, 0] }, { q: ON_ITS_SIDE }, { radius: 9.69 }, { radius: 10.31 }, { moving: false }]) assert.deepEqual(proposedFits(scene(other)), []);
  assert.equal(proposedFits(scene({ p: [5.9, 0, 0] })).length, 1, 'a tenth of the radius is borne');
});

test('a fillet on the axis of a bore is no shaft; a shaft with a flat is one', () => {
  const middleOf = (turn) => [(9.9 * Math.sin(turn / 2)) / (turn / 2), 0, 7];
  for (const turn of [Math.PI / 2, 0.99 * Math.PI]) assert.deepEqual(proposedFits(scene({ middle: middleOf(turn) })), []);
  for (const turn of [1.01 * Math.PI, 5, 2 * Math.PI]) assert.equal(proposedFits(scene({ middle: middleOf(turn) })).length, 1);
});

test('what has a fit is not proposed, however it is written', () => {
  const said = (more) => [{ kind: 'set tolerance', part: 1, feature: 'bore', other: 2, other_feature: 'journal', text: 'H7/g6', ...more }];
  assert.deepEqual(proposedFits(scene({ standing: said({}) })), []);
  assert.deepEqual(proposedFits(scene({ standing: said({ part: 2, feature: 'journal', other: 1, other_feature: 'bore' }) })), []);
  assert.deepEqual(proposedFits(scene({ standing: said({ feature: undefined, other_feature: undefined }) })), []);
  assert.equal(proposedFits(scene({ standing: said({ text: '' }) })).length, 1);
});

test('the code that is declared for the size elsewhere is proposed, and stands first; of two nothing is', () => {
  const elsewhere = (text) => ({ kind: 'set tolerance', part: 7, feature: 'bore', other: 8, other_feature: 'journal', text });
  const codes = (standing) => proposedFits(scene({ standing })).map((fit) => fit.code);
  assert.deepEqual(codes([]), ['']);
  assert.deepEqual(codes([elsewhere('Ø20 H7/g6'), elsewhere('Ø20 H7/g6'), elsewhere('Ø12 H7/p6')]), ['Ø20 H7/g6']);
  assert.deepEqual(codes([elsewhere('Ø20 H7/g6'), elsewhere('Ø20 H7/k6')]), ['']);
  assert.deepEqual(codes([elsewhere('H7/g6'), elsewhere('Ø19.9 H7/g6')]), ['']);

  const two = scene({ standing: [elsewhere('Ø20 H7/g6')] });
  two.features.get(1).unshift(round('hole', 5, true, [40, 0, 0]));
  two.parts.set(3, { id: 3, p: [40, 0, 0], q: UPRIGHT, moving: true });
  two.features.set(3, [round('pin', 4.95, false)]);
  assert.deepEqual(proposedFits(two).map(({ bore, code }) => [bore.feature, code]), [['bore', 'Ø20 H7/g6'], ['hole', '']]);
});
