// The picture of a clash's verdict in the page, of a live session and of a log: made by the gateway, enlarged, left by Escape.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { openPage } from '../support/browser.mjs';
import { BrowserSession } from '../support/browser_session.mjs';
import { PATIENCE, drawn, grab, moveBy, whenListed } from '../support/people.mjs';
import { PEGS } from '../support/scenario.mjs';

const session = new BrowserSession('picture');
const replay = new BrowserSession('pictured');
let eva, unlogged;

before(async () => {
  const log = join(session.folder, 'picture.mcap');
  await session.serve(PEGS, ['--log', log]);
  const without = await session.open();
  await session.show(undefined, ['--read-log', log]);
  [eva] = await session.join('Eva');
  unlogged = await openPage(session.browser, without.observer);
  await whenListed(eva, 'parts', 'peg_k6');
  await grab(eva, 'peg_k6');
  await moveBy(eva, [0, 0, -28]);
  await whenListed(eva, 'clashes', 'potential, plate_k6 × peg_k6');
}, { timeout: 240_000 });

const button = (page) => page.getByRole('button', { name: 'Picture of the verdict' });

/** The picture that is shown: how wide it is, what it says. */
async function picture(page) {
  const image = page.locator('#clash .picture img[src]');
  await image.waitFor(PATIENCE);
  await page.waitForFunction(() => /** @type {HTMLImageElement} */ (document.querySelector('#clash .picture img')).naturalWidth > 0, undefined, PATIENCE);
  return image.evaluate((img) => ({ width: /** @type {HTMLImageElement} */ (img).naturalWidth, alt: img.getAttribute('alt') }));
}

test('a gateway that knows no log says so in one line', async () => {
  await whenListed(unlogged, 'clashes', 'peg_k6');
  await unlogged.locator('#clashes > li').first().click();
  await button(unlogged).click();
  await unlogged.locator('#clash .picture p', { hasText: 'No picture: the gateway knows no log' }).waitFor(PATIENCE);
  assert.equal(await unlogged.locator('#clash .picture button').isVisible(), false);
});

test('a clash has its picture, which says the verdict, is enlarged, and left by Escape', async () => {
  await eva.locator('#clashes > li[aria-label*="plate_k6 × peg_k6"]').first().click();
  await button(eva).click();
  const { width, alt } = await picture(eva);
  assert.ok(width >= 800, `${width}`);
  assert.match(alt, /^potential: plate_k6 × peg_k6, overlap .*µm\. \S/);
  const enlarge = eva.getByRole('button', { name: 'Enlarge the picture' });
  await enlarge.focus();
  await eva.keyboard.press('Enter');
  const dialog = eva.getByRole('dialog', { name: /plate_k6 × peg_k6: potential/ });
  await dialog.waitFor(PATIENCE);
  await eva.keyboard.press('Escape');
  await dialog.waitFor({ state: 'hidden', ...PATIENCE });
  assert.ok(await enlarge.evaluate((here) => here === document.activeElement));
  await moveBy(eva, [0, 0, 28]);
  await eva.locator('#clash .picture p', { hasText: 'has changed since' }).waitFor(PATIENCE);
});

test('a log has the pictures of its moments, at 390 pixels too', async () => {
  const { browser, addresses } = await replay.show('tests/golden/thin_wall.mcap');
  const page = await openPage(browser, addresses.observer, { scheme: 'light', view: { width: 390, height: 844 }, touch: true });
  await page.locator('#timeline:not([hidden])').waitFor(PATIENCE);
  await page.evaluate(() => {
    const slider = /** @type {HTMLInputElement} */ (document.querySelector('#timeline input'));
    slider.value = '1000000';
    for (const type of ['input', 'change']) slider.dispatchEvent(new Event(type));
  });
  await whenListed(page, 'clashes', 'real');
  await page.locator('#clashes > li').first().click();
  await button(page).click();
  assert.match((await picture(page)).alt, /^real: /);
  await page.getByRole('button', { name: 'Enlarge the picture' }).click();
  await drawn(page);
  const box = await page.locator('dialog.picture_large').evaluate((d) => d.getBoundingClientRect().toJSON());
  assert.ok(box.left >= 0 && box.right <= 390 && box.bottom <= 844, JSON.stringify(box));
  await page.getByRole('button', { name: 'Close' }).last().click();
  await page.locator('dialog.picture_large').waitFor({ state: 'hidden', ...PATIENCE });
});
