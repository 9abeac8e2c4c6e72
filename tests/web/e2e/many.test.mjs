// Many parts of many shapes: those that look alike are drawn by one call, and each of them is still shown, hidden, seen through and cut by itself.
// The shadow on the ground is one more call for all of them.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { openBrowser, openPage } from '../support/browser.mjs';
import { openFakeGateway } from '../support/fake_gateway.mjs';
import { PATIENCE } from '../support/people.mjs';

const PARTS = 200;
const SHAPES = 50;
/** The map of the shadow is blurred along both sides and laid on the ground. */
const SHADOW = 3;
let gateway, browser, page;

/** What one picture draws: calls, and bodies among all that is drawn of triangles. @param {boolean} [alone] in a browser that draws one by one */
const counting = (alone) => {
  const now = { calls: 0, bodies: 0 };
  const count = (/** @type {any} */ of, /** @type {string} */ name, /** @type {(args: any[]) => number} */ bodies) => {
    const draw = of[name];
    of[name] = function drawn(...args) {
      ++now.calls;
      if (args[0] === WebGL2RenderingContext.TRIANGLES) now.bodies += bodies(args);
      draw.apply(this, args);
    };
  };
  const gl = WebGL2RenderingContext.prototype;
  for (const name of ['drawArrays', 'drawElements']) count(gl, name, () => 1);
  const { getExtension } = gl;
  const seen = new Set();
  gl.getExtension = function extension(name) {
    const found = alone && name === 'WEBGL_multi_draw' ? null : getExtension.call(this, name);
    if (found && name === 'WEBGL_multi_draw' && !seen.has(found)) count(seen.add(found) && found, 'multiDrawElementsWEBGL', (args) => args[6]);
    return found;
  };
  const ask = requestAnimationFrame;
  window.requestAnimationFrame = (what) => ask((time) => {
    Object.assign(now, { calls: 0, bodies: 0 });
    what(time);
    if (now.calls > 0) window.picture = { ...now };
  });
};

before(async () => {
  gateway = await openFakeGateway(PARTS, SHAPES, 2);
  browser = await openBrowser();
  page = await openPage(browser, gateway.address, { first: counting, view: { width: 760, height: 400 } });
}, { timeout: 240_000 });
after(async () => {
  await browser?.close();
  gateway?.close();
});

/** Calls of a picture that has so many bodies, once there is one. @param {number} bodies */
async function bodies(bodies) {
  const found = page.waitForFunction((n) => window.picture?.bodies === n && window.picture.calls, bodies, PATIENCE);
  return (await found.catch(async () => assert.fail(`${JSON.stringify(await page.evaluate(() => window.picture))}, not ${bodies} bodies`))).jsonValue();
}

test('a picture of many parts of many shapes takes few calls', async () => {
  const calls = await bodies(2 * PARTS + SHADOW);
  assert.ok(calls <= 8, `${calls} calls`);
  await page.focus('#canvas');
  await page.keyboard.press('s'); // without the shadow
  assert.equal(await bodies(PARTS), calls - SHADOW - 1);
});

test('one of them is hidden, chosen among ghosts, and cut', async () => {
  await page.locator('#place_left').click();
  await page.locator('#parts > li').first().click();
  await page.keyboard.press('d');
  await bodies(PARTS - 1);
  await page.keyboard.press('u');
  await bodies(PARTS);
  await page.keyboard.press('x'); // the insides, too
  await bodies(2 * PARTS);
  await page.keyboard.press('h'); // but not of ghosts
  const calls = await bodies(PARTS + 1);
  assert.ok(calls <= 8, `${calls} calls`);
  assert.deepEqual(page.complaints, []);
});

test('a browser that draws one by one draws the same, without the shadow', async () => {
  const size = page.viewportSize();
  await page.context().close();
  page = await openPage(browser, gateway.address, { first: { content: `(${counting})(true)` }, view: size });
  assert.ok((await bodies(PARTS)) >= 2 * PARTS);
  assert.deepEqual(page.complaints, []);
});
