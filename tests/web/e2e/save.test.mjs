// What is saved on the page is opened again: two files are dropped, a fit is set, the session is saved as a scenario, and another server
// that opens it says the same of them.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { openPage } from '../support/browser.mjs';
import { BrowserSession } from '../support/browser_session.mjs';
import { PATIENCE, until, whenListed } from '../support/people.mjs';

const first = new BrowserSession('save');
const second = new BrowserSession('saved');
let eva, verdict;

// As `mortise open` begins without a file.
const EMPTY = `
name: empty
units: mm
policy: report
deviation: recognized
parts: []
`;
const archive = join(first.folder, 'saved.zip');

/** The verdict on the one clash, as the page says it; not by whom it came about, and since when. @param {import('playwright-core').Page} page */
async function said(page) {
  if (await page.locator('#clash').isHidden()) await page.locator('#clashes > li[aria-label]').first().click();
  return page.evaluate(() => {
    const figures = [...document.querySelectorAll('#clash dl > dt')].map((at) => `${at.textContent}: ${at.nextElementSibling?.textContent}`);
    return [...document.querySelectorAll('#clash .scale > *')].map((at) => at.textContent).concat(figures.filter((text) => !/^(Moved by|Rule by|Since)/.test(text))).join('; ');
  });
}

before(async () => {
  const log = join(first.folder, 'first.mcap');
  await first.serve(EMPTY, ['--log', log]);
  await first.show(undefined, ['--read-log', log]);
  [eva] = await first.join('Eva');
}, { timeout: 240_000 });

test('two files that are dropped get the fit that was set', async () => {
  const plate = join(first.folder, 'plate.stl');
  const peg = join(first.folder, 'peg.stl');
  await first.run('generate', ['plate_with_bore', 'bore_mm=20', 'facets=32', '-o', plate]);
  await first.run('generate', ['dowel', 'diameter_mm=20', 'length_mm=40', 'chamfer_mm=1', 'facets=32', 'phase_rad=0.098', '-o', peg]);
  await eva.setInputFiles('#add_files', [plate, peg]);
  await eva.click('#units_add');
  await whenListed(eva, 'parts', 'peg');
  await eva.click('#tab_rules');
  await eva.getByLabel('Proposed fits').locator('li', { hasText: /^plate\..+ × peg\./ }).waitFor(PATIENCE);
  await eva.getByLabel('Fit for what is proposed').fill('H7/k6');
  await eva.getByRole('button', { name: 'Set for all' }).click();
  await eva.locator('#rules_panel li', { hasText: /plate\..+ × peg\..+ H7\/k6/ }).waitFor(PATIENCE);
  await eva.click('#tab_clashes');
  await whenListed(eva, 'clashes', 'potential, plate × peg');
  // Of a fit a probability is known.
  await until(async () => /Interference: 31\.4 %/.test(verdict = await said(eva)), () => verdict);
});

test('the session is saved as a scenario in an archive', async () => {
  await eva.click('#do_save');
  const [download] = await Promise.all([eva.waitForEvent('download', PATIENCE), eva.getByRole('button', { name: 'Scenario and arrangement' }).click()]);
  assert.equal(download.suggestedFilename(), `${first.name}.zip`);
  await download.saveAs(archive);
  await eva.getByText(`Saved: mortise open ${first.name}.zip goes on from here`).waitFor(PATIENCE);
});

test('with all its buttons the bar is one row from 1024 pixels on; a phone reaches all rules, and what is asked of files', async () => {
  for (const width of [1280, 1024]) {
    await eva.setViewportSize({ width, height: 720 });
    const { height } = await eva.locator('header.bar').boundingBox();
    assert.ok(height < 60, `${height} pixels high at ${width}`);
  }
  await eva.click('#tab_rules');
  for (const [width, height] of [[800, 600], [390, 844]]) {
    await eva.setViewportSize({ width, height });
    assert.deepEqual(await eva.evaluate(() => {
      const panel = document.getElementById('rules_panel');
      return [...panel.querySelectorAll('button, input, select')].filter((at) => at.checkVisibility()).filter((at) => {
        at.scrollIntoView();
        const [its, all] = [at.getBoundingClientRect(), panel.getBoundingClientRect()];
        return its.bottom > Math.min(all.bottom, innerHeight) + 1 || its.top < all.top - 1;
      }).map((at) => at.getAttribute('aria-label') ?? at.textContent);
    }), [], `${width} pixels`);
  }
  const long = `${'a_long_name_'.repeat(8)}.stl`;
  await eva.setInputFiles('#add_files', [{ name: long, mimeType: '', buffer: Buffer.from('solid') }]);
  const dialog = await eva.locator('#units').boundingBox();
  assert.ok(dialog.x >= 0 && dialog.x + dialog.width <= 390, `${dialog.x} to ${dialog.x + dialog.width}`);
  await eva.click('#units_cancel');
  await eva.setViewportSize({ width: 1280, height: 720 });
  await eva.click('#tab_clashes');
});

test('another server opens it and says the same', async () => {
  const folder = join(second.folder, 'kept');
  await second.run('replay', ['unpack', archive, '--out', folder]);
  await second.serve(join(folder, 'scenario.yaml'));
  await second.show();
  const tom = await openPage(second.browser, second.addresses.observer);
  await whenListed(tom, 'clashes', 'potential, plate × peg');
  assert.equal(await said(tom), verdict);
  await tom.click('#tab_rules');
  await tom.locator('#rules_panel li', { hasText: /plate\..+ × peg\..+ H7\/k6/ }).waitFor(PATIENCE);
  assert.deepEqual([...eva.complaints, ...tom.complaints], []);
});
