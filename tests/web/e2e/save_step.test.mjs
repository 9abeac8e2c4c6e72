// A session on a STEP assembly, as `mortise open` begins it, is saved on the page and opened again: parts, places, fits and clashes are the same.
import assert from 'node:assert/strict';
import { join, resolve } from 'node:path';
import { before, test } from 'node:test';
import { openPage } from '../support/browser.mjs';
import { BrowserSession } from '../support/browser_session.mjs';
import { PATIENCE, choose, grab, moveBy, position, settledElsewhere, whenListed } from '../support/people.mjs';

const first = new BrowserSession('step');
const second = new BrowserSession('stepped');
const archive = join(first.folder, 'saved.zip');
let eva, was;

before(async () => {
  const scenario = join(first.folder, 'tensioner.yaml');
  const log = join(first.folder, 'first.mcap');
  await first.run('check', [resolve(import.meta.dirname, '../../../scenarios/tensioner.step'), '--session', scenario]);
  await first.serve(scenario, ['--log', log]);
  await first.show(undefined, ['--read-log', log]);
  [eva] = await first.join('Eva');
  await whenListed(eva, 'parts', 'cover');
}, { timeout: 240_000 });

/** What the lists of a page say: parts, fits, and clashes with their class; not by whom, since when, or under which number. @param {import('playwright-core').Page} page */
async function told(page) {
  const listed = async (rows, wanted) => {
    const texts = await page.locator(rows).evaluateAll((all) => all.map((li) => li.getAttribute('aria-label') ?? li.textContent ?? ''));
    return texts.flatMap((text) => wanted.exec(text)?.[0].replace(/ Ø\d+ (?=H7)/, ' ') ?? []).sort(); // a scenario says the size as well
  };
  await page.click('#tab_rules');
  const fits = await listed('#rules_panel li', /^.* × .*H7\/g6/);
  await page.click('#tab_clashes');
  return { parts: await listed('#parts > li', /.+/), fits, clashes: await listed('#clashes > li[aria-label]', /.+(?=, number)/) };
}

test('fits are set and a part is moved', async () => {
  await eva.click('#tab_rules');
  await eva.getByLabel('Proposed fits').locator('li').first().waitFor(PATIENCE);
  await eva.getByLabel('Fit for what is proposed').fill('H7/g6');
  await eva.getByRole('button', { name: 'Set for all', exact: true }).click();
  await eva.locator('#rules_panel li', { hasText: 'H7/g6' }).first().waitFor(PATIENCE);
  await grab(eva, 'cover');
  const from = await position(eva);
  await moveBy(eva, [0, 0, 60]); // clear of all others
  const to = await settledElsewhere(eva, from);
  assert.equal(to[2], from[2] + 60);
  await eva.click('#hand button:has-text("Release")');
  was = { at: to, ...(await told(eva)) };
  assert.equal(was.fits.length, 8);
  assert.equal(was.clashes.length, 7, 'those that are explained; the cover has left the bracket');
});

test('it is saved', async () => {
  await eva.click('#do_save');
  const [download] = await Promise.all([eva.waitForEvent('download', PATIENCE), eva.getByRole('button', { name: 'Scenario and arrangement' }).click()]);
  await download.saveAs(archive);
  await eva.getByText(`Saved: mortise open ${first.name}.zip goes on from here`).waitFor(PATIENCE);
});

test('another server opens it and has the same', async () => {
  const folder = join(second.folder, 'kept');
  await second.run('replay', ['unpack', archive, '--out', folder]);
  await second.serve(join(folder, 'scenario.yaml'));
  await second.show();
  const tom = await openPage(second.browser, second.addresses.observer);
  await whenListed(tom, 'parts', 'cover');
  await choose(tom, 'cover');
  assert.deepEqual({ at: await position(tom), ...(await told(tom)) }, was);
  assert.deepEqual([...eva.complaints, ...tom.complaints], []);
});
