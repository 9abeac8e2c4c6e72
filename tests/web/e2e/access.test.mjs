// Nothing that axe knows of stands in anybody's way: the page and the reports, in both themes and at five sizes.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { openPage } from '../support/browser.mjs';
import { BrowserSession } from '../support/browser_session.mjs';
import { barriers } from '../support/access.mjs';
import { fitsScreensAndPaper } from '../support/looks.mjs';
import { PATIENCE, choose, drawn, grab, moveBy, whenListed } from '../support/people.mjs';
import { PEGS } from '../support/scenario.mjs';

const SIZES = /** @type {const} */ ([[1440, 900], [1280, 720], [1024, 768], [800, 600], [390, 844]]);
const SCHEMES = /** @type {const} */ (['dark', 'light']);
const session = new BrowserSession('access');

before(async () => {
  await session.serve(PEGS);
  await session.show();
}, { timeout: 240_000 });

/** @param {import('playwright-core').Page} page @param {string} what @param {(size: string) => Promise<void>} [look] */
async function atEverySize(page, what, look = async (size) => assert.deepEqual(await barriers(page), [], `${what}, ${size}`)) {
  for (const [width, height] of SIZES) {
    await page.setViewportSize({ width, height });
    await drawn(page);
    await look(`${width} × ${height}`);
  }
}

for (const scheme of SCHEMES) {
  test(`the form to join, ${scheme}`, async () => {
    const page = await openPage(session.browser, session.addresses.designer, { scheme });
    await page.locator('#join[open]').waitFor(PATIENCE);
    await atEverySize(page, 'the form');
    await page.context().close();
  });

  test(`a session with a clash, a part in hand and each panel, ${scheme}`, async () => {
    const page = await openPage(session.browser, session.addresses.designer, { name: `ann ${scheme}`, scheme });
    await whenListed(page, 'parts', 'peg_p6');
    await grab(page, 'peg_p6');
    if (scheme === SCHEMES[0]) await moveBy(page, [0, 0, -28]);
    await whenListed(page, 'clashes', 'real, plate_p6 × peg_p6');
    await page.locator('#clashes > li', { hasText: 'plate_p6 × peg_p6' }).click();
    await page.locator('#clash:not([hidden])').waitFor(PATIENCE);
    await atEverySize(page, 'session', async (size) => {
      for (const side of ['left', 'right', 'none']) {
        const place = page.locator(`#place_${side}`);
        if (await place.isVisible()) await place.click();
        for (const tab of side === 'right' ? ['rules', 'statistics', 'clashes'] : ['clashes']) {
          if (side === 'right') await page.click(`#tab_${tab}`);
          await drawn(page);
          assert.deepEqual(await barriers(page), [], `${size}, ${side}, ${tab}`);
        }
      }
    });
    await page.keyboard.press('Escape');
    await page.setViewportSize({ width: 1280, height: 720 });
    await page.locator('#hand button:has-text("Release")').click();
    await page.context().close();
  });

  test(`bars, dialogs and tools that open, ${scheme}`, async () => {
    const page = await openPage(session.browser, session.addresses.designer, { name: `bob ${scheme}`, scheme });
    await whenListed(page, 'parts', 'block');
    await choose(page, 'block');
    for (const [button, opens] of [['#view_section', '#section_bar'], ['#tool_align', '#align_bar'], ['#tool_measure', '#measure_bar']]) {
      await page.click(button);
      await page.locator(`${opens}:not([hidden])`).waitFor(PATIENCE);
      assert.deepEqual(await barriers(page), [], opens);
    }
    await page.click('#do_help');
    await page.locator('dialog[open]').waitFor(PATIENCE);
    assert.deepEqual(await barriers(page), [], 'keys');
    await page.context().close();
  });

  test(`the reports of a check and of a recorded session, also on paper, ${scheme}`, async () => {
    for (const [program, ...args] of [['check', 'scenarios/tensioner.step', '--html'], ['replay', 'export', 'tests/golden/thin_wall.mcap', '--html']]) {
      const file = join(session.folder, `${program}_${scheme}.html`);
      await session.run(program, [...args, file]);
      const page = await openPage(session.browser, `file://${file}`, { scheme });
      await atEverySize(page, program);
      await fitsScreensAndPaper(page);
      await page.context().close();
    }
  });
}
