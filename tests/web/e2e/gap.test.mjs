// Measure tells how far two parts are apart that do not meet: as meshes, and as what their real surfaces may be.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { openPage } from '../support/browser.mjs';
import { BrowserSession } from '../support/browser_session.mjs';
import { PATIENCE, choose, drawn, grab, moveBy, whenListed } from '../support/people.mjs';

// A block 0.1 mm above a plate, aside from its middle.
const SCENE = `
name: gap
units: mm
policy: report
parts:
  - {name: plate, generator: {kind: block, x: 100, y: 100, z: 10}, tolerance: "+-0.006", pose: {position: [0, 0, -5]}}
  - {name: block, generator: {kind: block, x: 20, y: 20, z: 20}, tolerance: "+-0.015", moving: true, pose: {position: [30, 0, 10.1]}}
`;
const session = new BrowserSession('gap');
let eva, unlogged;

before(async () => {
  const log = join(session.folder, 'gap.mcap');
  await session.serve(SCENE, ['--log', log]);
  const without = await session.open();
  await session.show(undefined, ['--read-log', log]);
  [eva] = await session.join('Eva');
  unlogged = await openPage(session.browser, without.observer);
  for (const page of [eva, unlogged]) await whenListed(page, 'parts', 'block');
}, { timeout: 240_000 });

/** Picks the top of both parts, seen from above. @param {import('playwright-core').Page} page */
async function measureTops(page) {
  for (const part of ['plate', 'block']) {
    await choose(page, part);
    await page.focus('#canvas');
    if (part === 'plate') await page.keyboard.press('k');
    for (const key of ['1', 'z']) {
      await page.keyboard.press(key);
      await drawn(page);
    }
    const box = await page.locator('#canvas').boundingBox();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  }
}

const says = (page, text) => page.locator('#measure_bar', { hasText: text }).waitFor(PATIENCE);

test('two parts that do not meet have a gap with its interval, which follows them', async () => {
  await grab(eva, 'block');
  await measureTops(eva);
  await says(eva, 'Gap of the parts: 0.100 mm (0.079 to 0.121)');
  await moveBy(eva, [0, 0, 0.2]);
  await says(eva, 'Gap of the parts: 0.300 mm (0.279 to 0.321)');
});

test('where they meet the session says it', async () => {
  await moveBy(eva, [0, 0, -0.29]);
  await says(eva, 'The session: overlap');
  assert.doesNotMatch(await eva.locator('#measure_bar').innerText(), /Gap of the parts/);
});

test('a gateway that knows no log says so', async () => {
  await moveBy(eva, [0, 0, 0.5]);
  await measureTops(unlogged);
  await says(unlogged, 'Real gap not known: the gateway knows no log');
  assert.deepEqual([...eva.complaints, ...unlogged.complaints], []);
});
