// The demo: scripted designers are there, and begin once somebody has come to see them.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { openPage } from '../support/browser.mjs';
import { BrowserSession } from '../support/browser_session.mjs';
import { PATIENCE, ticksPass } from '../support/people.mjs';

const session = new BrowserSession('demo');

before(async () => {
  await session.serve('gearbox.yaml');
  await session.show();
  await session.play('gearbox.play.yaml', 20, ['--for-people']);
}, { timeout: 240_000 });

test('nothing moves while nobody has joined; who looks on is nobody', async () => {
  const looksOn = await openPage(session.browser, session.addresses.observer);
  await looksOn.locator('#people > li', { hasText: 'ann' }).waitFor(PATIENCE);
  await ticksPass(looksOn, 180);
  assert.match(await looksOn.textContent('#clashes') ?? '', /No clash is open/);
  assert.equal(await looksOn.locator('#people > li', { hasText: 'holds' }).count(), 0);
  // And then it begins.
  const [eva] = await session.join('Eva');
  await looksOn.locator('#people > li', { hasText: 'holds' }).first().waitFor(PATIENCE);
  for (const page of [looksOn, eva]) await page.locator('#clashes > li[data-key]').first().waitFor(PATIENCE);
});
