// Draws the pictures of the READMEs from the demo's own session: node tests/web/screenshots.mjs [FOLDER]
// 1280 × 720: people at work; a clash with its section.
import { mkdirSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { openBrowser, openPage, whyNoBrowser } from './support/browser.mjs';
import { whenListed } from './support/people.mjs';
import { LiveSession } from './support/session.mjs';

const folder = resolve(process.argv[2] ?? join(import.meta.dirname, '../../client/web/pictures'));
mkdirSync(folder, { recursive: true });
const session = new LiveSession('gearbox');
const why = await whyNoBrowser();
if (why) throw new Error(why);
const browser = await openBrowser();

async function shoot(page, name) {
  await page.mouse.move(640, 4); // no row lights up under the pointer
  await page.waitForTimeout(1500);
  await page.screenshot({ path: join(folder, `${name}.png`) });
}

try {
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
  if (eve.complaints.length + tom.complaints.length > 0) throw new Error([...eve.complaints, ...tom.complaints].join('\n'));
} catch (error) {
  for (const context of browser.contexts()) for (const page of context.pages()) await page.screenshot({ path: join(folder, 'failed.png') });
  throw error;
} finally {
  await browser.close();
  await session.end();
}
