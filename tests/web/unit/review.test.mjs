import assert from 'node:assert/strict';
import { test } from 'node:test';
import { groupOf, inGroups } from '../../../client/web/page/session/groups.js';
import { forgetToken, keptToken, linkOf, placeOf } from '../../../client/web/page/session/link.js';
import { SavedViews } from '../../../client/web/page/session/saved_views.js';
import { Session } from '../../../client/web/page/session/session.js';
import { Unexamined } from '../../../client/web/page/session/unexamined.js';
import { span } from '../../../client/web/page/session/words.js';

const names = { 1: 'arm/servo_1/horn', 2: 'arm/servo_1/screw_2', 3: 'arm/servo_2/horn', 4: 'plate', 5: 'peg_12' };
const nameOf = (id) => names[id];
const clash = (a, b, faces = ['', '']) => ({ a, b, faces, shapes: ['planar', 'convex'] });

test('a link holds the session, the clash, the time and the view, and no token', () => {
  const place = { session: 'hall 3 & more', clash: 4, tick: 77, eye: [1.23456, -2, 3e5], at: [0, 0, 0.5] };
  const link = linkOf('http://127.0.0.1:8080/#token=SECRET', place);
  assert.doesNotMatch(link, /SECRET|token/);
  assert.deepEqual(placeOf(new URL(link).hash), { ...place, eye: [1.235, -2, 300000] });
});

test('what is no link, or a broken one, leads nowhere or as far as it can be read', () => {
  assert.equal(placeOf('#token=abc'), null);
  assert.equal(placeOf(''), null);
  assert.deepEqual(placeOf('#session=s&clash=-3&eye=1,2&at=a,b,c&tick=1e400'), { session: 's', clash: 0, tick: 0, eye: null, at: null });
});

test('a link is opened with the token that this browser came in with last, until that is not accepted', () => {
  const kept = new Map();
  const storage = { getItem: (key) => kept.get(key) ?? null, setItem: (key, value) => kept.set(key, value), removeItem: (key) => kept.delete(key) };
  assert.equal(keptToken('', storage), '');
  assert.equal(keptToken('mine', storage), 'mine');
  assert.equal(keptToken('', storage), 'mine');
  forgetToken('another', storage);
  assert.equal(keptToken('', storage), 'mine');
  forgetToken('mine', storage);
  assert.equal(keptToken('', storage), '');
});

test('clashes are grouped by pair, by relation and by sub-assembly', () => {
  assert.equal(groupOf(clash(4, 5), 'pair', nameOf), 'plate × peg_12');
  assert.equal(groupOf(clash(4, 5, ['bore_3', 'journal']), 'relation', nameOf), 'bore × journal');
  assert.equal(groupOf(clash(5, 4, ['journal', 'bore_4']), 'relation', nameOf), 'bore × journal');
  assert.equal(groupOf(clash(4, 5, ['bore', '']), 'relation', nameOf), 'bore × convex face');
  assert.equal(groupOf(clash(1, 2), 'assembly', nameOf), 'arm/servo_1');
  assert.equal(groupOf(clash(3, 1), 'assembly', nameOf), 'arm/servo_1 × arm/servo_2');
  assert.equal(groupOf(clash(4, 5), 'assembly', nameOf), 'In no sub-assembly');
  const groups = inGroups([clash(1, 2), clash(4, 5), clash(2, 1)], 'assembly', nameOf);
  assert.deepEqual(groups.map(({ name, clashes }) => [name, clashes.length]), [['arm/servo_1', 2], ['In no sub-assembly', 1]]);
});

test('who moved a clash, who changed its rule and who reviewed it are three', () => {
  const session = new Session();
  const event = (more) => session.apply({ type: 'events', events: [{ kind: 'change', seq: 1, clash: 3, a: 1, b: 2, class: 'real', cause: 'unknown', user: 1, ...more }] });
  event({ kind: 'begin', user: 1 });
  event({ user: 2, cause: 'set tolerance' });
  event({ kind: 'review', user: 3, cause: 'review', review: { status: 'approved', comment: '', user: 3, tick: 5 } });
  const now = session.clashes.get(3);
  assert.equal(now.mover, 1);
  assert.deepEqual(now.ruled, { user: 2, cause: 'set tolerance' });
  assert.equal(now.review.user, 3);
  event({ kind: 'change', user: 4 });
  assert.equal(session.clashes.get(3).mover, 4);
  assert.equal(session.clashes.get(3).ruled.user, 2);
});

test('remarks of a clash, and whose task it is', () => {
  const session = new Session();
  const remark = (clash, assignee, text) => ({ clash, user: 1, assignee, status: 'active', tick: 4, text });
  session.apply({ type: 'remarks', remarks: [remark(3, 2, 'a'), remark(9, 7, 'b'), remark(3, 0, 'c')] });
  assert.deepEqual(session.remarksOf(3).map(({ text }) => text), ['a', 'c']);
  assert.equal(session.assigneeOf(3), 0);
  assert.equal(session.assigneeOf(9), 7);
});

test('what waits is gone when it is told no more; what was given up stays until a part of it has moved', () => {
  const unexamined = new Unexamined();
  const told = (a, b, why) => ({ a, b, why, ticks: 2 });
  assert.ok(unexamined.take({ tick: 60, unexamined: [told(1, 2, 'waits for depth'), told(1, 3, 'given up'), told(4, 5, 'no inside')], unexamined_left_out: 4 }));
  assert.deepEqual(unexamined.of(1).map(({ b }) => b), [2, 3]);
  assert.equal(unexamined.leftOut, 4);
  unexamined.take({ tick: 120, unexamined: [] });
  assert.deepEqual([...unexamined.rows.keys()], ['1 3', '4 5']);
  unexamined.moved([{ id: 5 }]);
  unexamined.take({ tick: 180 });
  assert.deepEqual([...unexamined.rows.keys()], ['1 3']);
  assert.equal(unexamined.take({ tick: 240 }), false);
});

test('a pair that waits longer than half a second is told once, and again only after nothing has waited', () => {
  const session = new Session();
  const told = [];
  session.on('waits', (row) => told.push(`${row.a} ${row.b}`));
  const pulse = (...rows) => session.apply({ type: 'pulse', tick: 1, unexamined: rows.map(([a, b, ticks]) => ({ a, b, why: 'waits for depth', ticks })) });
  pulse([1, 2, 20]);
  assert.deepEqual(told, []);
  pulse([1, 2, 10]); // 30 ticks of 60 a second: not longer
  assert.deepEqual(told, []);
  pulse([1, 2, 1], [3, 4, 9]);
  pulse([1, 2, 60], [3, 4, 60]);
  assert.deepEqual(told, ['1 2']);
  pulse();
  pulse([3, 4, 60]);
  assert.deepEqual(told, ['1 2', '3 4']);
});

test('saved views belong to their session; one of the same name is replaced, and what cannot be read is none', () => {
  const kept = new Map();
  const views = new SavedViews({ getItem: (key) => kept.get(key) ?? null, setItem: (key, value) => kept.set(key, value) });
  const view = (name, x) => ({ name, eye: [x, 0, 0], at: [0, 0, 0], clash: 0 });
  views.save('a', view('top', 1));
  views.save('a', view('side', 2));
  views.save('a', view('top', 3));
  views.save('b', view('top', 4));
  assert.deepEqual(views.of('a').map(({ name, eye }) => [name, eye[0]]), [['side', 2], ['top', 3]]);
  views.forget('a', 'side');
  assert.deepEqual(views.of('a').map(({ name }) => name), ['top']);
  for (let i = 0; i < 80; ++i) views.save('a', view(`v${i}`, i));
  assert.equal(views.of('a').length, 50);
  kept.set('mortise.views', '{"a": [{"name": "x"}, 7], "b"');
  assert.deepEqual(views.of('a'), []);
  kept.set('mortise.views', '{"a": [{"name": "x"}, 7, null]}');
  assert.deepEqual(views.of('a'), []);
});

test('how long something has lasted reads in words', () => {
  assert.deepEqual([0.4, 59, 61, 3599, 7260].map(span), ['0 s', '59 s', '1 min 1 s', '59 min 59 s', '2 h 1 min']);
});
