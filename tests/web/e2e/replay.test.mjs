// A recorded session in the same page: a timeline, forwards and backwards, alone.
import assert from 'node:assert/strict';
import { mkdtemp, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { openPage } from '../support/browser.mjs';
import { BrowserSession } from '../support/browser_session.mjs';
import { cutOff, fitsScreensAndPaper, paleTexts } from '../support/looks.mjs';
import { PATIENCE, choose, drawn, position, until, whenListed } from '../support/people.mjs';

const session = new BrowserSession();
let page;

before(async () => {
  const { browser, addresses } = await session.show('tests/golden/thin_wall.mcap');
  page = await openPage(browser, addresses.designer);
}, { timeout: 240_000 });

const tick = () => page.evaluate(() => Number(/** @type {HTMLInputElement} */ (document.querySelector('#timeline input')).value));

async function seek(to) {
  await page.evaluate((n) => {
    const slider = /** @type {HTMLInputElement} */ (document.querySelector('#timeline input'));
    slider.value = `${n}`;
    slider.dispatchEvent(new Event('input'));
    slider.dispatchEvent(new Event('change'));
  }, to);
}

test('a log opens with a timeline and marks, and asks nobody to join', async () => {
  await page.locator('#timeline:not([hidden])').waitFor(PATIENCE);
  await whenListed(page, 'parts', 'moving');
  assert.equal(await page.locator('#join[open]').count(), 0);
  assert.equal(await page.textContent('#line_text'), 'Replay');
  assert.ok((await page.locator('#timeline .marks .mark').count()) >= 1);
});

test('parts and clashes are those of the moment', async () => {
  await page.keyboard.press('Escape');
  const moving = await page.evaluate(() => [...document.querySelectorAll('#parts > li')].find((li) => li.getAttribute('aria-label')?.includes('moving'))?.querySelector('.grow')?.textContent ?? '');
  await choose(page, moving);
  await seek(0);
  await page.waitForFunction(() => document.querySelector('#clashes')?.textContent?.includes('No clash is open'), undefined, PATIENCE);
  await drawn(page);
  const begin = await position(page);
  await seek(1e6);
  await whenListed(page, 'clashes', 'real');
  await drawn(page);
  const end = await position(page);
  assert.ok(Math.hypot(...end.map((x, i) => x - begin[i])) > 1, `${begin} and ${end}`);
  await seek(0);
  await page.waitForFunction(() => document.querySelector('#clashes')?.textContent?.includes('No clash is open'), undefined, PATIENCE);
  await drawn(page);
  assert.deepEqual(await position(page), begin);
});

test('it plays and pauses', async () => {
  await page.getByLabel('Speed').selectOption('0.25');
  await page.click('#timeline button[aria-label="Play"]');
  await page.locator('#timeline button[aria-label="Pause"]').waitFor(PATIENCE);
  const from = await tick();
  await until(async () => (await tick()) > from, () => `a tick after ${from}`);
  await page.click('#timeline button[aria-label="Pause"]');
  await page.locator('#timeline button[aria-label="Play"]').waitFor(PATIENCE);
  await page.getByRole('button', { name: 'Clash ▸' }).click();
  await whenListed(page, 'clashes', 'real');
});

test('depth and tick times are plotted on the axis of the timeline, are pressed as it is, and are told in words', async () => {
  await seek(0);
  const depths = page.getByRole('img', { name: /^Depth of #1 wall × cube: at least .* at .* s/ });
  await depths.waitFor(PATIENCE);
  await page.getByRole('img', { name: /^Tick times: / }).waitFor(PATIENCE);
  const drawing = depths.locator('svg rect.is-real').last();
  const [deep, all, track] = await Promise.all([drawing, page.locator('#timeline .plots'), page.locator('#timeline input')].map((box) => box.boundingBox()));
  assert.ok(Math.abs(all.x - track.x - 8) < 1.5 && Math.abs(all.width - track.width + 16) < 3, 'one axis');
  await page.mouse.click(deep.x + deep.width / 2, deep.y + deep.height - 2);
  await whenListed(page, 'clashes', 'real');
  await page.waitForFunction(() => /s; #1 real, at least .* deep$/.test(document.querySelector('#timeline input')?.getAttribute('aria-valuetext') ?? ''), undefined, PATIENCE);
  const [now, thumb] = [await page.locator('#timeline .now').boundingBox(), (await tick())];
  assert.ok(Math.abs(now.x + 1 - (deep.x + deep.width / 2)) < 8, `${now.x} at tick ${thumb}`);
  assert.deepEqual([...await paleTexts(page), ...await cutOff(page)], []);
  await page.getByRole('button', { name: 'Plots' }).press('Enter');
  assert.ok(await depths.isHidden());
  await page.getByRole('button', { name: 'Plots' }).press('Enter');
  assert.ok(await depths.isVisible());
});

test('at 390 pixels the timeline has a row of its own, and what filters says which', async () => {
  const phone = await openPage(session.browser, session.addresses.observer, { touch: true, view: { width: 390, height: 844 } });
  const slider = phone.locator('#timeline input[type="range"]');
  await slider.waitFor(PATIENCE);
  assert.ok((await slider.boundingBox()).width > 300, `${(await slider.boundingBox()).width} pixels`);
  for (const select of await phone.locator('#clash_filters select').all()) assert.ok((await select.boundingBox()).width >= 100, `${(await select.boundingBox()).width} pixels`);
  await phone.context().close();
});

test('the session is saved as a file', async () => {
  const [download] = await Promise.all([page.waitForEvent('download', PATIENCE), page.click('#do_save').then(() => page.click('#save_log'))]);
  assert.match(download.suggestedFilename(), /\.mcap$/);
  const begin = Buffer.alloc(8);
  const stream = await download.createReadStream();
  for await (const piece of stream) { piece.copy(begin); break; }
  assert.equal(begin.toString('latin1'), '\x89MCAP0\r\n');
  await page.getByText('goes on from here').waitFor(PATIENCE);
});

test('the report is downloaded, and opens by itself', async () => {
  const [download] = await Promise.all([page.waitForEvent('download', PATIENCE), page.click('#do_report')]);
  assert.match(download.suggestedFilename(), /report\.html$/);
  const folder = await mkdtemp(join(tmpdir(), 'mortise-report-'));
  const file = join(folder, 'report.html');
  await download.saveAs(file);
  const text = await readFile(file, 'utf8');
  assert.ok(text.startsWith('<!DOCTYPE html>'));
  assert.match(text, /wall × cube/);
  assert.match(text, /id="clash-1"/);
  const report = await session.browser.newPage();
  /** @type {string[]} */
  const asked = [];
  report.on('request', (request) => asked.push(request.url()));
  await report.goto(`file://${file}`);
  await report.locator('#clashes tbody tr').first().waitFor(PATIENCE);
  assert.deepEqual(asked.filter((url) => !/^(file|data):/.test(url)), []);
  assert.deepEqual(await report.evaluate(() => [...document.querySelectorAll('h2')].slice(0, 2).map((h2) => h2.textContent)), ['Clashes', 'Timeline']);
  await fitsScreensAndPaper(report);
  await report.close();
  await rm(folder, { recursive: true });
});

test('nobody takes a part in hand', async () => {
  assert.equal(await page.locator('#hand button:not(.look):visible').count(), 0);
  assert.equal(await page.isDisabled('#tool_move'), true);
  assert.deepEqual(page.complaints, []);
});
