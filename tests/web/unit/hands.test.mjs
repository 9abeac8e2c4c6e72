import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Choice } from '../../../client/web/page/session/choice.js';
import { between, gapSaid, ofOne, realGap, realGapSaid } from '../../../client/web/page/session/measure.js';
import { Mover } from '../../../client/web/page/session/mover.js';
import { Session } from '../../../client/web/page/session/session.js';
import { Stops } from '../../../client/web/page/session/stops.js';

const near = (a, b, by = 1e-9) => assert.ok(Math.abs(a - b) <= by, `${a} is not ${b}`);
const cylinder = (at, radius, inward = false, axis = [0, 0, 1]) => ({ kind: 'cylinder', at, axis, radius, inward });
const plane = (at, axis) => ({ kind: 'plane', at, axis, radius: 0, inward: false });
const point = (at) => ({ kind: 'point', at, axis: [0, 0, 1], radius: 0, inward: false });
const figures = (a, b) => Object.fromEntries(between(a, b).figures.map(({ name, mm, rad }) => [name, mm ?? rad]));

test('a shaft in a bore: clearance, how far the axes are apart, and the least gap', () => {
  const found = figures(cylinder([0, 0, 0], 10.01, true), cylinder([0.003, 0.004, 50], 10));
  near(found['Axes apart'], 0.005);
  near(found['Bore less shaft, diameters'], 0.02);
  near(found['Least gap'], 0.005);
  assert.deepEqual(figures(cylinder([0.003, 0.004, 50], 10), cylinder([0, 0, 0], 10.01, true)), found, 'the order is of no meaning');
  assert.deepEqual(ofOne(cylinder([0, 0, 0], 10)), [{ name: 'Diameter', mm: 20 }]);
});

test('the real gap of a judged pair is an interval: Ø20 H7/g6 is 7 to 41 µm in diameter, however deep the meshes are in each other', () => {
  const g6 = { delta: [0.048, 0.0481], fake_below: 0.0516, real_above: 0.0685, explanation: 'fake up to 51.6 µm, real above 68.5 µm' };
  near(realGap(g6)[0], 0.0035);
  near(realGap(g6)[1], 0.0205);
  assert.equal(realGapSaid(g6), 'real gap 3.5 µm to 20.5 µm');
  assert.equal(gapSaid({ mesh_mm: 0.1, real_mm: [0.079, 0.121] }), '0.100 mm (0.079 to 0.121)');
  assert.equal(gapSaid({ mesh_mm: 0.0125, real_mm: [0.0035, 0.0205] }), '0.0125 mm (0.0035 to 0.0205)', 'fits are of micrometres');
  assert.equal(realGapSaid({ ...g6, explanation: 'fake up to 51.6 µm' }), 'real gap at least 3.5 µm', 'an end that was left open says nothing');
  assert.equal(realGapSaid({ delta: [0.4, 0.5], fake_below: 0, real_above: 0.1, explanation: 'real above 100.0 µm' }), 'real gap -500.0 µm to -300.0 µm');
});

test('planes, points, spheres and axes', () => {
  near(figures(plane([0, 0, 3], [0, 0, 1]), plane([7, 7, 11.5], [0, 0, -1])).Distance, 8.5);
  near(figures(plane([0, 0, 3], [0, 0, 1]), plane([0, 0, 0], [0, 1, 0])).Angle, Math.PI / 2);
  near(figures(plane([0, 0, 3], [0, 0, 1]), cylinder([5, 5, 10], 2, false, [1, 0, 0]))['Surface to plane'], 5);
  near(figures(cylinder([5, 5, 10], 2), plane([0, 0, 3], [0.6, 0, 0.8]))['Angle of the axis to the plane'], Math.asin(0.8));
  near(figures(point([3, 4, 9]), cylinder([0, 0, 0], 2))['To the surface'], 3);
  near(figures(point([1, 0, 9]), cylinder([0, 0, 0], 2, true))['To the surface'], 1);
  near(figures(point([0, 0, 0]), point([2, 3, 6])).Distance, 7);
  near(figures({ ...point([0, 0, 0]), kind: 'sphere', radius: 1 }, { ...point([0, 0, 7]), kind: 'sphere', radius: 2 })['Between surfaces'], 4);
  near(figures(cylinder([0, 0, 0], 1), cylinder([0, 3, 0], 1, false, [1, 0, 0]))['Axes apart'], 3);
});

test('a motion that is longer than one increment may be goes in several, and all of it', () => {
  const sent = [];
  const mover = new Mover((part, { t }) => sent.push(t[2]) > 0, 1e6);
  mover.push(1, { t: [0, 0, 23], r: [0, 0, 0] });
  for (let i = 0; i < 10; ++i) mover.beat();
  assert.ok(sent.every((mm) => mm <= 5), `${sent}`);
  near(sent.reduce((sum, mm) => sum + mm), 23);
});

test('with Ctrl the second part is gathered beside the chosen one, and leaves again', () => {
  const choice = new Choice();
  choice.gather(3);
  assert.equal(choice.part, 3);
  choice.ungather();
  choice.gather(5);
  assert.deepEqual(choice.together.sort(), [3, 5]);
  choice.gather(5);
  assert.deepEqual(choice.together, [3]);
  choice.isolate(choice.together, [3, 4, 5]);
  assert.deepEqual([...choice.hidden], [4, 5]);
});

const part = (id, more = {}) => ({ id, name: `p${id}`, mesh: 'm', moving: true, holder: 9, p: [0, 0, 0], q: [0, 0, 0, 1], radius: 10, reference: [0, 0, 0], classes: 0, ...more });
const real = { kind: 'begin', seq: 1, clash: 7, a: 1, b: 2, class: 'real', delta: [0.04, 0.0482], margin: 0.0005, worst_class: 'real', cause: 'unknown', user: 9 };

function held({ clashes = [], standing = [] } = {}) {
  const session = new Session();
  session.apply({ type: 'welcome', mode: 'live', role: 'designer', limits: {} });
  session.apply({ type: 'scene', session: 's', tick: 5, tick_rate_hz: 60, policy: 'stop', parts: [part(1), part(2, { holder: 0 })], users: [{ id: 9, name: 'ann', present: true, role: 'designer' }], clashes, standing });
  session.apply({ type: 'joined', user: 9, name: 'ann', role: 'designer' });
  session.apply({ type: 'features', sets: [{ parts: [2], features: [{ name: 'bore', kind: 'cylinder', axis: [0, 0, 1], point: [0, 0, 0] }] }] });
  return session;
}
const kept = { kind: 'add constraint', user: 9, part: 1, constraint: { kind: 'coaxial', part: 1, feature: 'shaft', other: 2, other_feature: 'bore' } };

/** Asks for a shift of which the session does so much. */
function pushed(session, t, done) {
  const stops = new Stops();
  const one = session.parts.get(1);
  stops.asked(one, { t, r: [0, 0, 0] }, 0);
  one.p = done;
  stops.moved(one, 100);
  return stops.why(one, session, 1000);
}

test('a part that came where it was asked to, or is still on its way, has nothing to say', () => {
  assert.equal(pushed(held({ clashes: [real] }), [0, 0, 5], [0, 0, 5]), null);
  const stops = new Stops();
  const session = held();
  stops.asked(session.parts.get(1), { t: [0, 0, 5], r: [0, 0, 0] }, 0);
  session.parts.get(1).p = [0, 0, 2];
  stops.moved(session.parts.get(1), 900);
  assert.equal(stops.why(session.parts.get(1), session, 1000), null);
});

test('each stop has its reason: contact, constraint, waiting, refusal; and what is not known is not made up', () => {
  assert.match(pushed(held({ clashes: [real] }), [0, 0, 5], [0, 0, 2]).text, /^3\.000 mm of the move is missing\. Real contact with p2: 48\.2 µm deep .* 0\.5 µm beyond the real threshold \(clash #7\)/);
  assert.match(pushed(held({ clashes: [real], standing: [kept] }), [4, 0, 5], [0, 0, 5]).text, /Held by its constraint: shaft coaxial with p2 bore/);
  assert.match(pushed(held({ clashes: [real], standing: [kept] }), [4, 0, 5], [0, 0, 2]).text, /Real contact/, 'along the axis it is not the constraint');
  const waiting = held();
  waiting.apply({ type: 'pulse', tick: 9, unexamined: [{ a: 1, b: 2, why: 'waits for depth', ticks: 3 }] });
  assert.match(pushed(waiting, [0, 0, 5], [0, 0, 2]).text, /Not judged against p2: it waits for its turn/);
  assert.match(pushed(held(), [0, 0, 5], [0, 0, 2]).text, /has told no reason/);
  const session = held();
  session.parts.get(1).holder = 4;
  const stops = new Stops();
  stops.refused(1, 'not the holder', 500);
  assert.match(stops.why(session.parts.get(1), session, 1000).text, /Refused: not the holder: user 4 holds it/);
  assert.equal(stops.why(session.parts.get(1), session, 9000), null);
});

test('a part that was turned less than asked says so in degrees', () => {
  const session = held({ clashes: [real] });
  const stops = new Stops();
  stops.asked(session.parts.get(1), { t: [0, 0, 0], r: [0, 0, 0.1] }, 0);
  assert.match(stops.why(session.parts.get(1), session, 1000).text, /^5\.730° of the move is missing/);
});
