import assert from 'node:assert/strict';
import { test } from 'node:test';
import { fitGroups, proposedFits, setFits, sizeText } from '../../../client/web/page/session/proposed_fits.js';

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

/** As many fits as there are pairs of parts, of bores and shafts of these diameters. */
const fits = (pairs, hole = 6, pin = 5.99, code = '') => pairs.map(([a, b]) => ({ bore: { part: a, feature: 'bore' }, shaft: { part: b, feature: 'journal' }, hole, pin, clearance: hole - pin, code }));
const named = new Map([[1, 'arm/plate'], [2, 'arm/dowel_1'], [3, 'arm/dowel_2'], [4, 'arm/dowel_12'], [5, 'arm/bolt_1'], [6, 'side_2/plate']]);
const nameOf = (id) => named.get(id) ?? '';

test('numbered siblings of one size are one group, each where its first one stands', () => {
  const groups = fitGroups([...fits([[1, 2]]), ...fits([[1, 5]], 8), ...fits([[1, 3], [1, 4]]), ...fits([[1, 4]], 6, 5.98), ...fits([[6, 2]])], nameOf);
  assert.deepEqual(groups.map(({ places, fits: all }) => [places.join(' × '), sizeText(all[0].hole), all.map(({ shaft }) => shaft.part)]), [
    ['arm/plate × arm/dowel*', 'Ø6', [2, 3, 4]], ['arm/plate × arm/bolt*', 'Ø8', [5]], ['arm/plate × arm/dowel*', 'Ø6', [4]], ['side*/plate × arm/dowel*', 'Ø6', [2]]]);
  assert.equal(fitGroups([...fits([[1, 2]]), ...fits([[1, 3]], 6 + 1e-9, 5.99 - 1e-9)], nameOf).length, 1, 'what recognition makes of a size is one size');
  assert.equal(fitGroups([...fits([[1, 2]]), ...fits([[1, 3]], 6, 5.99, 'Ø6 H7/g6')], nameOf).length, 2, 'what is declared elsewhere stands apart');
});

test('all of a group are asked for one after the other, and what is refused is kept with its reason', async () => {
  const asked = [];
  let open = 0;
  const request = async (what, keys) => {
    assert.equal(++open, 1, 'one at a time');
    await null;
    --open;
    asked.push([what, keys.part, keys.feature, keys.other, keys.other_feature, keys.text]);
    return keys.other === 3 ? { id: 1, done: false, refusal: 'bad_statement', text: 'Ø6 H7/g6 does not go with Ø6.4' } : { id: 1, done: true };
  };
  const told = await setFits(request, fits([[1, 2], [1, 3], [1, 4]]), () => 'H7/g6');
  assert.deepEqual(asked, [2, 3, 4].map((pin) => ['fit', 1, 'bore', pin, 'journal', 'H7/g6']));
  assert.deepEqual(told.done.map(({ shaft }) => shaft.part), [2, 4]);
  assert.deepEqual(told.missed.map(({ fit, why }) => [fit.shaft.part, why]), [[3, 'Ø6 H7/g6 does not go with Ø6.4']]);
});

test('where nobody answers, the rest is counted and not asked', async () => {
  let asked = 0;
  const request = async () => (++asked === 1 ? { id: 1, done: true } : { id: 2, done: false, refusal: 'no_answer', text: 'The session did not answer' });
  const told = await setFits(request, fits([[1, 2], [1, 3], [1, 4]]), () => 'H7/g6');
  assert.deepEqual([asked, told.done.length, told.missed.map(({ why }) => why)], [2, 1, ['The session did not answer', 'The session did not answer']]);
});
