import assert from 'node:assert/strict';
import { test } from 'node:test';
import { tokenOf } from '../../../client/web/page/session/connection.js';
import { readPoseFrame } from '../../../client/web/page/session/frames.js';
import { Session } from '../../../client/web/page/session/session.js';
import { bracket, small } from '../../../client/web/page/session/words.js';
import { poseFrame } from '../support/frames.mjs';

const part = (id, more = {}) => ({ id, name: `p${id}`, mesh: 'm', moving: true, holder: 0, p: [0, 0, 0], q: [0, 0, 0, 1], radius: 1, reference: [0, 0, 0], classes: 0, ...more });
const clash = (id, more = {}) => ({ kind: 'begin', seq: id, clash: id, a: 1, b: 2, class: 'potential', delta: [0.1, 0.1], worst_class: 'potential', review: { status: 'new', comment: '', user: 0, tick: 0 }, ...more });

function begun() {
  const session = new Session();
  session.apply({ type: 'welcome', mode: 'live', role: 'designer', limits: {} });
  session.apply({ type: 'scene', session: 's', tick: 5, tick_rate_hz: 60, policy: 'stop', parts: [part(1), part(2)], users: [{ id: 9, name: 'ann', present: true, role: 'designer' }], clashes: [clash(3)], standing: [] });
  session.apply({ type: 'joined', user: 9, name: 'ann', role: 'designer' });
  return session;
}

test('poses, holders and classes follow the frames; parts that nobody spoke of are skipped', () => {
  const session = begun();
  const held = [];
  session.on('holder', (p) => held.push([p.id, p.holder]));
  session.applyPoses(readPoseFrame(poseFrame(8, [{ part: 1, holder: 9, p: [1, 2, 3], q: [0, 0, 1, 0], classes: 4 }, { part: 77, holder: 1, p: [0, 0, 0], q: [0, 0, 0, 1], classes: 0 }])));
  assert.deepEqual(session.parts.get(1).p, [1, 2, 3]);
  assert.equal(session.tick, 8);
  assert.deepEqual(held, [[1, 9]]);
  assert.deepEqual(session.heldByMe().map((p) => p.id), [1]);
});

test('an ended clash stays to be read, a review of it too, and leaves the open ones', () => {
  const session = begun();
  session.apply({ type: 'events', events: [clash(4, { class: 'real' }), clash(3, { kind: 'end', class: 'none', delta: [0, 0] })] });
  assert.deepEqual(session.openClashes().map((c) => c.clash), [4]);
  assert.equal(session.clashes.get(3).class, 'potential');
  session.apply({ type: 'events', events: [clash(4, { kind: 'review', class: 'real', review: { status: 'approved', comment: 'x', user: 9, tick: 9 } })] });
  assert.equal(session.clashes.get(4).review.status, 'approved');
  assert.deepEqual(session.openClashes().map((c) => c.clash), [4]);
});

test('ended clashes do not pile up', () => {
  const session = begun();
  for (let id = 10; id < 1000; ++id) session.apply({ type: 'events', events: [clash(id), clash(id, { kind: 'end' })] });
  assert.ok(session.clashes.size <= 202);
  assert.equal(session.openClashes().length, 1);
});

test('what holds is what the session says that holds', () => {
  const session = begun();
  let told = 0;
  session.on('standing', () => ++told);
  const decide = (decision) => session.apply({ type: 'decisions', decisions: [decision] });
  const constraint = { kind: 'add constraint', user: 9, part: 1, constraint_id: 6, constraint: { part: 1 } };
  session.apply({ type: 'standing', standing: [constraint] });
  assert.deepEqual(session.standing, [constraint]);
  assert.equal(told, 1);
  decide({ kind: 'hand-over', user: 9, part: 1, other_user: 8 });
  assert.equal(session.parts.get(1).holder, 8);
  decide({ kind: 'release', user: 8, part: 1 });
  assert.equal(session.parts.get(1).holder, 0);
  session.apply({ type: 'standing', standing: [] });
  assert.deepEqual(session.standing, []);
  assert.equal(told, 2);
});

test('messages that the page does not know are skipped; a lost line leaves nobody joined', () => {
  const session = begun();
  session.apply({ type: 'from_a_newer_gateway', x: 1 });
  assert.equal(session.mayAct, true);
  session.lost();
  assert.equal(session.mayAct, false);
});

test('figures read as people say them', () => {
  assert.equal(small(0.0482), '48.2 µm');
  assert.equal(small(12.5), '12.500 mm');
  assert.equal(small(null), '–');
  assert.equal(bracket([0.04821, 0.04822]), '48.2 µm');
  assert.equal(bracket([0.0482, 0.0491]), '48.2 µm … 49.1 µm');
});

test('a token is taken from the address only when it is one', () => {
  assert.equal(tokenOf('#token=abc_-1'), 'abc_-1');
  assert.equal(tokenOf('#token=a b'), '');
  assert.equal(tokenOf(''), '');
});

test('what was held is held again after the line was away, or is said not to be', () => {
  const back = (holders) => {
    const session = begun();
    session.applyPoses(readPoseFrame(poseFrame(8, [1, 2].map((id) => ({ part: id, holder: 9, p: [0, 0, 0], q: [0, 0, 0, 1], classes: 0 })))));
    const dropped = [];
    session.on('dropped', (parts) => dropped.push(...parts.map(({ id, holder }) => [id, holder])));
    session.lost();
    session.lost(); // an attempt that failed tells nothing new
    session.apply({ type: 'server', present: true });
    session.apply({ type: 'scene', session: 's', tick: 9, tick_rate_hz: 60, policy: 'stop', parts: [part(1, { holder: holders[0] }), part(2, { holder: holders[1] })], users: [], clashes: [], standing: [] });
    assert.deepEqual(dropped, [], 'who one is is not known yet');
    session.apply({ type: 'joined', user: 9, name: 'ann', role: 'designer' });
    return { dropped, held: session.heldByMe().map(({ id }) => id) };
  };
  assert.deepEqual(back([9, 9]), { dropped: [], held: [1, 2] });
  assert.deepEqual(back([0, 4]), { dropped: [[1, 0], [2, 4]], held: [] });
});

test('a clash that comes before the name of an added part is told once the name is there, and not where it has ended', () => {
  const session = begun();
  const told = [];
  session.on('event', ({ clash: id, a, b }) => told.push(`#${id} ${session.partName(a)} × ${session.partName(b)}`));
  session.apply({ type: 'events', events: [clash(7, { b: 5, class: 'real' }), clash(8, { b: 5, class: 'real' })] });
  assert.deepEqual([told, session.openClashes().length], [[], 3], 'it is in the list at once');
  const scene = { type: 'scene', session: 's', tick: 9, tick_rate_hz: 60, policy: 'stop', parts: [part(1), part(2), part(5, { name: 'added' })], users: [], clashes: [clash(3), clash(7, { b: 5, class: 'real' })], standing: [] };
  session.apply(scene);
  assert.deepEqual(told, ['#7 p1 × added']);
  session.apply(scene);
  session.apply({ type: 'events', events: [clash(9, { b: 5 })] });
  assert.deepEqual(told, ['#7 p1 × added', '#9 p1 × added'], 'once');
});
