import assert from 'node:assert/strict';
import { test } from 'node:test';
import { extentOf, extentSaid, formatOf, partNameOf, statedUnit } from '../../../client/web/page/session/mesh_file.js';
import { Uploads } from '../../../client/web/page/session/uploads.js';

const bytes = (text) => new TextEncoder().encode(text).buffer;

/** A binary STL of one facet, whose head begins as that of a text does. */
function binary(corners) {
  const view = new DataView(new ArrayBuffer(84 + 50));
  [...'solid'].forEach((letter, i) => view.setUint8(i, letter.charCodeAt(0)));
  view.setUint32(80, 1, true);
  corners.flat().forEach((value, i) => view.setFloat32(96 + 4 * i, value, true));
  return view.buffer;
}

test('the size of a mesh file is read of its corners, binary or text', () => {
  assert.deepEqual(extentOf('a.STL', binary([[1, 2, 3], [4, 2, -1], [0, 7, 3]])), [4, 5, 4]);
  assert.deepEqual(extentOf('a.stl', bytes('solid a\nfacet normal 9 9 9\nouter loop\n vertex 1 0 0\nvertex -1e1 2 0\n  vertex 0 0 .5\n')), [11, 2, 0.5]);
  assert.deepEqual(extentOf('a.obj', bytes('# a\nv 0 0 0\nvn 99 99 99\nv 1 2 3 1\nvt 50 50\nf 1 2 1\n')), [1, 2, 3]);
  assert.equal(extentOf('a.glb', bytes('glTF')), null);
  assert.equal(extentOf('a.stl', bytes('')), null);
  assert.equal(extentOf('a.stl', bytes('solid a\nvertex x y z\n')), null);
});

test('units are asked for where a file has none, and shown in mm', () => {
  assert.equal(statedUnit('x.glb'), 1000);
  assert.equal(statedUnit('x.stl'), 0);
  assert.equal(formatOf('x.igs'), '');
  assert.equal(formatOf('x.STEP'), 'step');
  assert.equal(statedUnit('x.stp'), 1);
  assert.equal(extentSaid([1, 0.5, 2], 25.4), '25.4 × 12.7 × 50.8 mm');
  assert.equal(extentSaid(null, 1), 'of unknown size');
});

test('a part has the name of its file, and no other has it', () => {
  const names = new Set(['left_bracket', 'left_bracket_2']);
  assert.equal(partNameOf('left bracket.v2.stl', () => false), 'left_bracket_v2');
  assert.equal(partNameOf('left bracket.stl', (name) => names.has(name)), 'left_bracket_3');
  assert.equal(partNameOf('.stl', () => false), 'part');
});

test('a file goes as it is allowed to, and each end of it is told', async () => {
  const sent = [];
  const posted = [];
  const uploads = new Uploads((message) => sent.push(message) > 0, async (path) => (posted.push(path), path === 'upload/bad' ? 'nobody waits for this file' : ''));
  const file = { name: 'a.stl', size: 200 };
  const shares = [];
  const good = uploads.bring(file, 25.4, (share) => shares.push(share));
  assert.deepEqual(sent[0], { type: 'upload', id: 1, name: 'a.stl', unit_mm: 25.4, bytes: 200 });
  uploads.take({ id: 1, state: 'open', path: 'upload/t' });
  uploads.take({ id: 1, state: 'sent', received: 50 });
  uploads.take({ id: 1, state: 'ready', mesh: 'h', text: 'open' });
  assert.deepEqual(await good, { mesh: 'h', parts: undefined, text: 'open' });
  assert.deepEqual([posted, shares], [['upload/t'], ['25 %']]);
  const said = [];
  const assembly = uploads.bring({ name: 'a.step', size: 9 }, 1, (text) => said.push(text));
  const parts = [{ name: 'a/b', mesh: 'h', p: [0, 0, 0], q: [0, 0, 0, 1] }];
  for (const done of [0, 1]) uploads.take({ id: 2, state: 'parts', done, of: 2 * done });
  uploads.take({ id: 2, state: 'ready', parts, text: '' });
  assert.deepEqual(await assembly, { mesh: '', parts, text: '' });
  assert.deepEqual(said, ['is read', '1 of 2 parts']);
  const refused = uploads.bring(file, 1, () => {});
  uploads.take({ id: 3, state: 'refused', refusal: 'no right', text: 'the scenario does not let you add parts' });
  await assert.rejects(refused, /does not let you/);
  const torn = uploads.bring(file, 1, () => {});
  uploads.take({ id: 4, state: 'open', path: 'upload/bad' });
  await assert.rejects(torn, /nobody waits/);
  const lost = uploads.bring(file, 1, () => {});
  uploads.lost();
  await assert.rejects(lost, /connection was lost/);
});
