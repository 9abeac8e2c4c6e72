// Draws pictures of the page.
// node tests/web/screenshots.mjs [FOLDER]: those of the READMEs, from the demo's own session, 1280 × 720: people at work; a clash with its section.
// node tests/web/screenshots.mjs --sizes FOLDER: a clash, a part in hand and the panels at five sizes in both themes, to be looked at.
import { mkdirSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { openBrowser, openPage, whyNoBrowser } from './support/browser.mjs';
import { PATIENCE, drawn, grab, moveBy, whenListed } from './support/people.mjs';
import { PEGS } from './support/scenario.mjs';
import { LiveSession } from './support/session.mjs';

const SIZES = /** @type {const} */ ([[1440, 900], [1280, 720], [1024, 768], [800, 600], [390, 844]]);
const ofSizes = process.argv[2] === '--sizes';
const named = process.argv[ofSizes ? 3 : 2];
if (ofSizes && !named) throw new Error('--sizes wants a folder');
const folder = resolve(named ?? join(import.meta.dirname, '../../client/web/pictures'));
mkdirSync(folder, { recursive: true });
const session = new LiveSession(ofSizes ? `sizes${process.pid}` : 'gearbox');
const why = await whyNoBrowser();
if (why) throw new Error(why);
const browser = await openBrowser();

async function shoot(page, name) {
  await page.mouse.move(640, 4); // no row lights up under the pointer
  await page.waitForTimeout(1500);
  await page.screenshot({ path: join(folder, `${name}.png`) });
}

/** @returns {Promise<import('playwright-core').Page[]>} who took part */
async function drawDemo() {
  await session.serve('gearbox.yaml', ['--live']);
  const { designer } = await session.open();
  const eve = await openPage(browser, designer, { name: 'eve' });
  const tom = await openPage(browser, designer, { name: 'tom', scheme: 'light' });
  await whenListed(eve, 'parts', 'input_shaft');
  await session.play('gearbox.play.yaml', 300);
  await whenListed(eve, 'clashes', 'potential, input_shaft × gear_in');
  await eve.keyboard.press('f');
  await shoot(eve, 'people');

  await whenListed(eve, 'clashes', 'real, cover × bearing_out_upper');
  await eve.waitForTimeout(3000);
  await eve.keyboard.press('f');
  await eve.locator('#clashes > li[aria-label*="gear_in"]').first().click();
  await eve.waitForFunction(() => document.getElementById('heat_legend')?.textContent?.includes('As they stand'), undefined, { timeout: 60_000 });
  await shoot(eve, 'clash');
  return [eve, tom];
}

/** @returns {Promise<import('playwright-core').Page[]>} */
async function drawSizes() {
  await session.serve(PEGS);
  const { designer } = await session.open();
  const eve = await openPage(browser, designer, { name: 'eve' });
  await whenListed(eve, 'parts', 'peg_p6');
  await grab(eve, 'peg_p6');
  await moveBy(eve, [0, 0, -28]);
  await whenListed(eve, 'clashes', 'real, plate_p6 × peg_p6');
  await eve.locator('#clashes > li', { hasText: 'plate_p6 × peg_p6' }).click();
  await eve.locator('#heat_legend:not([hidden])').waitFor(PATIENCE);
  for (const colorScheme of /** @type {const} */ (['dark', 'light'])) {
    await eve.emulateMedia({ colorScheme, reducedMotion: 'reduce' });
    for (const [width, height] of SIZES) {
      await eve.setViewportSize({ width, height });
      await drawn(eve);
      await eve.screenshot({ path: join(folder, `${width}_${colorScheme}.png`) });
    }
  }
  return [eve];
}

try {
  const people = await (ofSizes ? drawSizes() : drawDemo());
  const complaints = people.flatMap((page) => page.complaints);
  if (complaints.length > 0) throw new Error(complaints.join('\n'));
} catch (error) {
  for (const context of browser.contexts()) for (const page of context.pages()) await page.screenshot({ path: join(folder, 'failed.png') });
  throw error;
} finally {
  await browser.close();
  await session.end();
}
