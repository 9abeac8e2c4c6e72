import assert from 'node:assert/strict';
import { test } from 'node:test';
import { SpaceMouse, readReport } from '../../../client/web/page/session/space_mouse.js';

/** @param {...number} counts int16, little endian */
const words = (...counts) => counts.reduce((data, count, i) => (data.setInt16(2 * i, count, true), data), new DataView(new ArrayBuffer(2 * counts.length)));
const bytes = (...values) => new DataView(Uint8Array.from(values).buffer);

test('right, towards the user and down become right, up and towards the eye', () => {
  assert.deepEqual(readReport(1, words(350, 0, 0)), { shift: [1, 0, 0] });
  assert.deepEqual(readReport(1, words(0, 350, 0)), { shift: [0, 0, 1] });
  assert.deepEqual(readReport(1, words(0, 0, 350)), { shift: [0, -1, 0] });
  assert.deepEqual(readReport(2, words(0, 0, -350)), { turn: [0, 1, 0] });
});

test('a report of twelve bytes has shift and turn; buttons are bits; others and short ones say nothing', () => {
  assert.deepEqual(readReport(1, words(350, 0, 0, 0, -350, 0)), { shift: [1, 0, 0], turn: [0, 0, -1] });
  assert.deepEqual(readReport(3, bytes(2, 1)), { buttons: 0x102 });
  assert.deepEqual(readReport(3, bytes(0, 0, 0, 0x80)), { buttons: 0x80000000 });
  assert.equal(readReport(1, words(350, 0)), null);
  assert.equal(readReport(2, bytes(1, 2, 3)), null);
  assert.equal(readReport(3, bytes()), null);
  assert.equal(readReport(23, words(1, 2, 3)), null);
});

test('a hand that rests moves nothing, half way is less than half, beyond the stop is the stop', () => {
  const [x] = readReport(1, words(20, -20, 5)).shift.map(Math.abs);
  assert.equal(x, 0);
  const half = readReport(1, words(175, 0, 0)).shift[0];
  assert.ok(half > 0.1 && half < 0.5, `${half}`);
  assert.equal(readReport(1, words(-175, 0, 0)).shift[0], -half);
  assert.equal(readReport(1, words(-32768, 0, 0)).shift[0], -1);
});

test('its motion is that of the time it was pushed, without leaps; silent, it stands', () => {
  const mouse = new SpaceMouse();
  assert.equal(mouse.motion(0), null);
  mouse.take(1, words(350, 0, 0), 1000);
  mouse.take(2, words(0, 350, 0), 1000);
  assert.deepEqual(mouse.motion(1000), { t: [0, 0, 0], r: [0, 0, 0] });
  assert.deepEqual(mouse.motion(1050), { t: [0.05, 0, 0], r: [0, 0, 0.05] });
  assert.deepEqual(mouse.motion(1300), { t: [0.1, 0, 0], r: [0, 0, 0.1] }, 'a slow picture');
  assert.equal(mouse.motion(1401), null, 'nothing heard for 0.4 s');
  mouse.take(1, words(350, 0, 0), 9000);
  assert.deepEqual(mouse.motion(9000), { t: [0, 0, 0], r: [0, 0, 0] }, 'the time it stood does not count, nor does its old turn');
  mouse.take(1, words(0, 0, 0), 9010);
  assert.equal(mouse.motion(9010), null);
});

test('a button is pressed once, however often it is told', () => {
  const mouse = new SpaceMouse();
  assert.equal(mouse.take(3, bytes(1, 0), 0), 1);
  assert.equal(mouse.take(3, bytes(3, 0), 1), 2);
  assert.equal(mouse.take(1, words(1, 1, 1), 2), 0);
  assert.equal(mouse.take(3, bytes(3, 0), 3), 0);
  assert.equal(mouse.take(3, bytes(0, 0), 4), 0);
  assert.equal(mouse.take(3, bytes(1, 0), 5), 1);
});
