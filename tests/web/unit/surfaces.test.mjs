import assert from 'node:assert/strict';
import { test } from 'node:test';
import { facetsAbout, facetsOf, offSurface } from '../../../client/web/page/session/surfaces.js';
import { prism } from '../support/solids.mjs';

const face = (more) => ({ name: 'f', origin: 'declared', inward: false, point: [0, 0, 0], axis: [0, 0, 1], radius: 0, tube_radius: 0, half_angle: 0, along: [0, 0], middle: [0, 0, 0], ...more });

test('the distance to each kind of surface', () => {
  assert.equal(offSurface(face({ kind: 'plane', point: [0, 0, 2] }), [7, 8, 5]), 3);
  assert.equal(offSurface(face({ kind: 'cylinder', radius: 5 }), [3, 4, 9]), 0);
  assert.equal(offSurface(face({ kind: 'sphere', radius: 2 }), [0, 3, 0]), 1);
  assert.ok(offSurface(face({ kind: 'cone', half_angle: Math.PI / 4 }), [2, 0, 2]) < 1e-15);
  assert.ok(Math.abs(offSurface(face({ kind: 'torus', radius: 10, tube_radius: 2 }), [13, 0, 0]) - 1) < 1e-15);
  assert.equal(offSurface(face({ kind: 'unknown' }), [0, 0, 0]), Infinity);
});

test('the facets of a cylinder are its sides and not its ends; those of an end are one end', () => {
  for (const sides of [12, 24, 48]) {
    const { mesh, around } = prism(sides, 10, 30);
    const side = facetsOf(mesh, face({ kind: 'cylinder', radius: 10, along: [0, 30] }));
    assert.deepEqual(side, Array.from({ length: 2 * sides }, (_, i) => 3 * i));
    assert.ok(side.every((k) => k < around));
    assert.equal(facetsOf(mesh, face({ kind: 'plane', point: [0, 0, 30] })).length, sides);
    assert.equal(facetsOf(mesh, face({ kind: 'cylinder', radius: 10, along: [0, 10] })).length, 0);
    assert.equal(facetsOf(mesh, face({ kind: 'cylinder', radius: 12, along: [0, 30] })).length, 0);
  }
});

test('without a face: what comes near and looks that way', () => {
  const { mesh, around } = prism(48, 10, 30);
  const near = facetsAbout(mesh, [10, 0, 15], [1, 0, 0], 1);
  assert.ok(near.length >= 2 && near.length < 12 && near.every((k) => k < around));
  assert.equal(facetsAbout(mesh, [10, 0, 15], [0, 0, 1], 1).length, 0);
});
