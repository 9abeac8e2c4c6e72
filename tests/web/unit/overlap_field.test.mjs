import assert from 'node:assert/strict';
import { test } from 'node:test';
import { liftOf, scaleOf, zonesOf } from '../../../client/web/page/session/heat_scale.js';
import { SurfaceTree, fieldOver, nearestOn } from '../../../client/web/page/session/overlap_field.js';
import { facetsOf } from '../../../client/web/page/session/surfaces.js';
import { box, boxDistance, numbers, prism } from '../support/solids.mjs';

const SIZE = [20, 12, 6];
const HOW = { bend: 1e-3, finest: 0.02, coarsest: 3, most: 50_000 };

test('the distance to a box is the closed form, inside and outside, at faces, edges and corners', () => {
  const tree = new SurfaceTree(box(SIZE));
  const number = numbers(7);
  for (let i = 0; i < 4000; ++i) {
    const x = SIZE.map((size) => (number() - 0.5) * 1.6 * size);
    if (i % 4 === 1) x[0] = 10; // in the plane of a face
    if (i % 4 === 2) [x[0], x[1]] = [10 + number(), 6 + number()]; // nearest to an edge
    if (i % 4 === 3) for (let k = 0; k < 3; ++k) x[k] = SIZE[k] / 2 + number(); // to a corner
    const truth = boxDistance(SIZE, x);
    assert.ok(Math.abs(tree.signedDistance(x, 100) - truth) < 1e-9, `${x}: ${tree.signedDistance(x, 100)}, ${truth}`);
  }
  assert.equal(tree.signedDistance([100, 0, 0], 5), 5);
});

test('which side one is on is right beyond sharp edges, where a facet alone says the wrong one', () => {
  // A wedge of 11 degrees: next to its edge one is behind the plane of one facet and still outside.
  const wedge = { points: new Float32Array([0, -5, 0, 0, 5, 0, 10, -5, -1, 10, 5, -1, 10, -5, 1, 10, 5, 1]),
    triangles: new Uint32Array([0, 1, 3, 0, 3, 2, 0, 5, 1, 0, 4, 5, 2, 5, 4, 2, 3, 5, 0, 2, 4, 1, 5, 3]) };
  const tree = new SurfaceTree(wedge);
  const number = numbers(5);
  for (let i = 0; i < 4000; ++i) {
    const x = [14 * number() - 2, 14 * number() - 7, 3 * (number() - 0.5)];
    const inside = x[0] < 10 && Math.abs(x[1]) < 5 && Math.abs(x[2]) < x[0] / 10;
    assert.equal(tree.signedDistance(x, 100) < 0, inside, `${x}`);
  }
});

test('the tree finds what looking at all facets finds', () => {
  const { mesh } = prism(64, 10, 30);
  const tree = new SurfaceTree(mesh);
  const number = numbers(11);
  const corner = (k, i) => [0, 1, 2].map((axis) => mesh.points[3 * mesh.triangles[k + i] + axis]);
  for (let i = 0; i < 300; ++i) {
    const x = [30 * (number() - 0.5), 30 * (number() - 0.5), 40 * number() - 5];
    let least = Infinity;
    for (let k = 0; k < mesh.triangles.length; k += 3) {
      const on = nearestOn(x, corner(k, 0), corner(k, 1), corner(k, 2));
      least = Math.min(least, Math.hypot(...x.map((value, axis) => value - on[axis])));
    }
    assert.ok(Math.abs(Math.abs(tree.signedDistance(x, 100)) - least) < 1e-9);
  }
});

test('a peg in its bore half a facet out of phase: each corner is deep, each facet is clear', () => {
  const sides = 32;
  const [peg, hole] = [prism(sides, 10, 30), prism(sides, 10, 30)];
  const tree = new SurfaceTree(hole.mesh); // the air of the bore: outside of it is the material
  const turn = Math.PI / sides;
  const overlap = ([x, y, z]) => tree.signedDistance([x * Math.cos(turn) - y * Math.sin(turn), x * Math.sin(turn) + y * Math.cos(turn), Math.min(25, Math.max(5, z))], 5);
  const side = facetsOf(peg.mesh, { name: 'f', origin: 'declared', kind: 'cylinder', inward: false, point: [0, 0, 0], axis: [0, 0, 1], radius: 10, tube_radius: 0, half_angle: 0, along: [0, 30], middle: [0, 0, 0] });
  const field = fieldOver(peg.mesh, side, overlap, { ...HOW, bend: 2e-4, finest: 0.01 });
  const sag = 10 * (1 - Math.cos(Math.PI / sides));
  assert.ok(Math.abs(field.deepest - sag) < 1e-5, `${field.deepest}, ${sag}`);
  assert.ok(!field.cut && field.triangles.length / 3 > 4 * side.length, `${field.triangles.length / 3} of ${side.length}`);
  // Linear between its points: everywhere the field is what the closed form says.
  let worst = 0;
  for (let k = 0; k < field.triangles.length; k += 3) {
    const middle = [0, 1, 2].map((axis) => [0, 1, 2].reduce((sum, i) => sum + field.points[3 * field.triangles[k + i] + axis] / 3, 0));
    const shown = [0, 1, 2].reduce((sum, i) => sum + field.overlap[field.triangles[k + i]] / 3, 0);
    if (shown > -sag) worst = Math.max(worst, Math.abs(shown - overlap(middle)));
  }
  assert.ok(worst < 2e-3, `off by ${worst}`);
});

test('what is cut finer stays whole: as much surface, every inner edge between two triangles', () => {
  const sheet = box([30, 30, 2]);
  const tree = new SurfaceTree(box([8, 8, 8]));
  const top = Array.from({ length: sheet.triangles.length / 3 }, (_, k) => 3 * k).filter((k) => [0, 1, 2].every((i) => sheet.points[3 * sheet.triangles[k + i] + 2] > 0));
  const field = fieldOver(sheet, top, (x) => -tree.signedDistance(x, 20), HOW);
  const at = (i) => [field.points[3 * i], field.points[3 * i + 1]];
  let area = 0;
  const edges = new Map();
  for (let k = 0; k < field.triangles.length; k += 3) {
    const [a, b, c] = [0, 1, 2].map((i) => field.triangles[k + i]);
    const [[x0, y0], [x1, y1], [x2, y2]] = [at(a), at(b), at(c)];
    area += ((x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)) / 2;
    for (const [i, j] of [[a, b], [b, c], [c, a]]) edges.set(`${Math.min(i, j)} ${Math.max(i, j)}`, (edges.get(`${Math.min(i, j)} ${Math.max(i, j)}`) ?? 0) + 1);
  }
  assert.ok(Math.abs(area - 900) < 1e-3, `${area}`);
  const open = [...edges].filter(([, count]) => count !== 2).map(([key]) => key.split(' ').map(Number).map(at));
  assert.ok(open.every((ends) => [0, 1].some((axis) => ends.every((end) => Math.abs(Math.abs(end[axis]) - 15) < 1e-5))), 'an edge inside has one triangle');
  assert.ok(Math.abs(field.deepest - 3) < 1e-6); // the top is 3 mm below that of the cube
  assert.ok(fieldOver(sheet, top, (x) => -tree.signedDistance(x, 20), { ...HOW, most: 40 }).cut);
});

test('the scale follows the thresholds, whatever their order about nothing', () => {
  const clash = (fake_below, real_above, delta, of = 'potential') => ({ fake_below, real_above, delta, class: of });
  const names = (c) => zonesOf(scaleOf(c)).map(({ name }) => name);
  assert.deepEqual(names(clash(0.04, 0.06, [0.05, 0.05])), ['fake', 'potential', 'real']);
  assert.deepEqual(names(clash(-0.01, 0.03, [0.01, 0.02])), ['potential', 'real']);
  assert.deepEqual(names(clash(0, 0, [1, 2], 'real')), ['real']);
  assert.equal(scaleOf(clash(-0.01, 0.03, [0.01, 0.02])).from, -0.01);
  assert.equal(scaleOf(clash(0, 0.02, [0, 3], 'real')).top, 3);
  assert.ok(zonesOf(scaleOf(clash(null, null, [null, null]))).every(({ lo, hi }) => hi > lo));
});

test('a part that was held back is shown as deep as the clash says, one that overlaps as it is', () => {
  const clash = (delta, of) => ({ fake_below: 0.01, real_above: 0.02, delta, class: of });
  assert.equal(liftOf(clash([0.05, 0.05], 'real'), 0), 0.05);
  assert.equal(liftOf(clash([0.05, 0.05], 'real'), 0.05), 0);
  assert.equal(liftOf(clash([0.002, 0.05], 'real'), 0.03), 0); // within the bracket
  assert.equal(liftOf(clash([0.005, 0.005], 'fake'), 0), 0);
  assert.equal(liftOf(clash([null, null], 'real'), NaN), 0);
});
