// One clash, one story: who moved it, who reviewed it, what was said, whose task it is, and a link that leads a colleague to it.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { openPage } from '../support/browser.mjs';
import { BrowserSession } from '../support/browser_session.mjs';
import { PATIENCE, drawn, grab, moveBy, until, whenListed } from '../support/people.mjs';
import { PEGS } from '../support/scenario.mjs';

const session = new BrowserSession('review');
let browser, addresses, eva, tom;

// Beside the pegs a shell that is open at its top, and a ball that fits into it: what lies inside is not known. And parts of two sub-assemblies.
const OPEN = `${PEGS.replace('fits:', `  - {name: shell, mesh: {file: shell.stl, unit: mm}, pose: {position: [-60, 80, 0]}}
  - {name: ball, generator: {kind: block, x: 4, y: 4, z: 4}, moving: true, pose: {position: [-60, 80, 40]}}
  - {name: arm/left/jaw, generator: {kind: block, x: 8, y: 8, z: 8}, moving: true, pose: {position: [60, 80, 40]}}
  - {name: arm/left/pad, generator: {kind: block, x: 8, y: 8, z: 8}, pose: {position: [60, 80, 20]}}
  - {name: arm/right/jaw, generator: {kind: block, x: 8, y: 8, z: 8}, pose: {position: [67, 80, 20]}}
fits:`)}`;

/** Five sides of a cube of 20 mm. */
function shellStl() {
  const c = (i) => [i & 1 ? 10 : -10, i & 2 ? 10 : -10, i & 4 ? 10 : -10].join(' ');
  const sides = [[0, 2, 1], [1, 2, 3], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]];
  return `solid shell\n${sides.map((t) => `facet normal 0 0 0\nouter loop\n${t.map((i) => `vertex ${c(i)}\n`).join('')}endloop\nendfacet\n`).join('')}endsolid shell\n`;
}

before(async () => {
  writeFileSync(join(session.folder, 'shell.stl'), shellStl());
  await session.serve(OPEN, ['--log', join(session.folder, 'review.mcap')]);
  ({ browser, addresses } = await session.show());
  [eva, tom] = await session.join('Eva', 'Tom');
  for (const page of [eva, tom]) await page.context().grantPermissions(['clipboard-read', 'clipboard-write']);
  await whenListed(eva, 'parts', 'peg_k6');
  await grab(eva, 'peg_k6');
  await moveBy(eva, [0, 0, -28]);
  await whenListed(tom, 'clashes', 'potential, plate_k6 × peg_k6');
}, { timeout: 240_000 });

const row = (page, pair) => page.locator(`#clashes > li[aria-label*="${pair}"]`);
const figure = (page, name) => page.locator('#clash dl').evaluate((list, wanted) => {
  const names = [...list.children];
  const at = names.findIndex((dt) => dt.tagName === 'DT' && dt.textContent === wanted);
  return at < 0 ? null : names[at + 1].textContent;
}, name);

test('who moved, who reviewed, what was said and whose task it is are told apart, also to who comes late', async () => {
  await row(tom, 'plate_k6 × peg_k6').click();
  await tom.getByLabel('Review status').selectOption('active');
  await tom.getByLabel('Whose task').selectOption({ label: 'Eva' });
  await tom.getByLabel('Comment').fill('please turn it by 90°');
  await tom.click('#clash button:has-text("Save")');
  await row(eva, 'plate_k6 × peg_k6').click();
  await eva.locator('#clash .thread > li', { hasText: 'please turn it by 90°' }).waitFor(PATIENCE);
  assert.equal(await figure(eva, 'Moved by'), 'Eva');
  assert.equal(await figure(eva, 'Reviewed by'), 'Tom: active');
  assert.equal(await figure(eva, 'Task of'), 'Eva');
  await eva.getByLabel('Review status').selectOption('reviewed');
  await eva.getByLabel('Whose task').selectOption('0');
  await eva.getByLabel('Comment').fill('turned');
  await eva.click('#clash button:has-text("Save")');
  await tom.locator('#clash .thread > li', { hasText: 'turned' }).waitFor(PATIENCE);
  assert.equal(await tom.getByLabel('Comment').inputValue(), '', 'a comment is written once');
  const late = await openPage(browser, addresses.designer, { name: 'late' });
  await whenListed(late, 'clashes', 'reviewed');
  await row(late, 'plate_k6 × peg_k6').click();
  const thread = await late.locator('#clash .thread > li').allTextContents();
  assert.equal(thread.length, 2);
  assert.match(thread[0], /^Tom, \d+ s ago: active, task of Eva.*please turn it by 90°/);
  assert.match(thread[1], /^Eva, \d+ s ago: reviewed, nobody’s task.*turned/);
  assert.equal(await figure(late, 'Moved by'), 'Eva');
  assert.equal(await figure(late, 'Reviewed by'), 'Eva: reviewed');
  await late.context().close();
});

test('"since" counts while nothing happens', async () => {
  const since = async () => Number(/(\d+) s$/.exec(await figure(eva, 'Since'))?.[1]);
  const first = await since();
  await until(async () => ((await since()) - first + 60) % 60 >= 2, () => `two seconds beyond ${first} s`);
});

test('the section is drawn anew in other colours and at another size', async () => {
  const drawing = () => eva.locator('#clash canvas').evaluate((canvas) => /** @type {HTMLCanvasElement} */ (canvas).toDataURL());
  const dark = await drawing();
  await eva.click('#do_theme');
  await until(async () => (await drawing()) !== dark, () => 'the section in light colours');
  await eva.click('#do_theme');
  await until(async () => (await drawing()) === dark, () => 'the section as it was');
  await eva.setViewportSize({ width: 1024, height: 720 });
  const fits = () => eva.locator('#clash canvas').evaluate((canvas) => Math.abs(/** @type {HTMLCanvasElement} */ (canvas).width - canvas.clientWidth) <= 1);
  await until(fits, () => 'the section as wide as its place');
  await eva.setViewportSize({ width: 1280, height: 720 });
});

test('a link leads a colleague to the clash and the view, with the address of their own', async () => {
  await row(eva, 'plate_k6 × peg_k6').click();
  await eva.focus('#canvas');
  await eva.keyboard.press('3');
  await drawn(eva);
  await eva.click('#clash button[aria-label="Copy the link to this clash"]');
  await eva.getByText('The link to clash').first().waitFor(PATIENCE);
  const link = await eva.evaluate(() => navigator.clipboard.readText());
  assert.match(link, /^http:\/\/127\.0\.0\.1:\d+\/#session=review\d+&clash=\d+&tick=\d+&eye=.*&at=/);
  assert.doesNotMatch(link, /token/);
  // Tom's browser has come in before. His page stands at the same clash, seen from the same place.
  const tab = await tom.context().newPage();
  await tab.goto(link);
  await tab.fill('#join_name', 'Tim');
  await tab.click('#join_go');
  await tab.locator('#clash h3 .grow', { hasText: /^#\d+ plate_k6 × peg_k6/ }).waitFor(PATIENCE);
  const compass = (page) => page.evaluate(() => document.getElementById('compass')?.toDataURL());
  await eva.click('#do_theme'); // Tom's is light
  await eva.focus('#canvas');
  await eva.keyboard.press('+');
  await drawn(eva);
  await until(async () => (await compass(tab)) === (await compass(eva)), () => 'both see it from the same place');
  await eva.click('#do_theme');
  await tab.close();
  // One who was never here is told what is missing.
  const stranger = await openPage(browser, link);
  await stranger.locator('#banner[data-trouble="no_token"]').waitFor(PATIENCE);
  await stranger.context().close();
});

test('the numbers of clashes are those of the log', async () => {
  const number = /^#(\d+) /.exec(await eva.textContent('#clash h3 .grow'))[1];
  assert.match(await row(eva, 'plate_k6 × peg_k6').textContent(), new RegExp(`#${number}(?!\\d)`));
  const told = await session.run('replay', ['explain', join(session.folder, 'review.mcap'), number]);
  assert.match(told, /plate_k6/);
  assert.match(told, /peg_k6/);
});

test('clashes stand in groups', async () => {
  await grab(tom, 'peg_p6');
  await moveBy(tom, [0, 0, -28]);
  await whenListed(tom, 'clashes', 'real, plate_p6 × peg_p6');
  await tom.click('#clash button[aria-label="Close"]');
  await tom.getByLabel('Groups').selectOption('pair');
  await tom.locator('#clashes > li.head', { hasText: 'plate_p6 × peg_p6' }).waitFor(PATIENCE);
  assert.equal(await tom.locator('#clashes > li.head').count(), 2);
  await tom.getByLabel('Groups').selectOption('relation');
  await tom.locator('#clashes > li.head', { hasText: 'bore × journal' }).first().waitFor(PATIENCE);
  await tom.locator('#clashes > li.head').first().click(); // a head is nothing to be chosen
  assert.ok(await tom.locator('#clash').isHidden());
  await tom.getByLabel('Groups').selectOption('');
  assert.equal(await tom.locator('#clashes > li.head').count(), 0);
});

test('clashes stand in groups by the sub-assemblies of their parts', async () => {
  await tom.getByLabel('Groups').selectOption('assembly');
  await tom.getByLabel('What a real contact does').selectOption('report'); // else it stands at the first of both
  await grab(eva, 'arm/left/jaw');
  await moveBy(eva, [0, 0, -15]);
  for (const pair of ['arm/left/jaw × arm/left/pad', 'arm/left/jaw × arm/right/jaw']) await whenListed(tom, 'clashes', `real, ${pair}`);
  const listed = await tom.locator('#clashes > li').evaluateAll((rows) => rows.map((li) => (li.classList.contains('head') ? '' : '  ') + (li.querySelector('.grow') ?? li).textContent));
  assert.deepEqual(listed, [
    'arm/left', '  arm/left/jaw × arm/left/pad',
    'arm/left × arm/right', '  arm/left/jaw × arm/right/jaw',
    'In no sub-assembly', '  plate_p6 × peg_p6', '  plate_k6 × peg_k6',
  ]);
  await eva.locator('#do_undo').click();
  for (const page of [eva, tom]) await page.locator('#clashes > li[aria-label*="arm/left"]').first().waitFor({ ...PATIENCE, state: 'detached' });
  await tom.getByLabel('What a real contact does').selectOption('stop');
  await eva.click('#hand button:has-text("Release")');
  await tom.getByLabel('Groups').selectOption('');
});

test('a fit is set from the clash itself, and the verdict flips for everybody', async () => {
  await row(tom, 'plate_p6 × peg_p6').click();
  await tom.getByText('Fit of bore × journal: Ø20 H7/p6').waitFor(PATIENCE);
  const gone = Promise.all([eva, tom].map((page) => page.waitForFunction(() => ![...document.querySelectorAll('#clashes > li')].some((li) => li.getAttribute('aria-label')?.startsWith('real, plate_p6')), undefined, PATIENCE)));
  await tom.getByLabel('Fit of the two faces').fill('H7/g6');
  await tom.click('#clash button:has-text("Set fit")');
  await gone;
  await tom.getByLabel('State', { exact: true }).selectOption('all');
  await tom.click('#hand button:has-text("Release")');
});

test('the fits of the scenario are listed among the rules, and those that were set since with who set them', async () => {
  await eva.click('#tab_rules');
  const rule = (text) => eva.locator('#rules_panel li', { hasText: text });
  await rule('plate_k6.bore × peg_k6.journal Ø20 H7/k6').getByText('scenario').waitFor(PATIENCE);
  await rule('plate_g6.bore × peg_g6.journal Ø20 H7/g6').getByText('scenario').waitFor(PATIENCE);
  await rule('plate_p6.bore × peg_p6.journal H7/g6').getByText('Tom').waitFor(PATIENCE);
  assert.equal(await rule('H7/p6').count(), 0);
  await eva.click('#tab_clashes');
});

test('a view is saved, found again, and forgotten', async () => {
  await eva.focus('#canvas');
  await eva.keyboard.press('1');
  await drawn(eva);
  const compass = () => eva.evaluate(() => document.getElementById('compass')?.toDataURL());
  const top = await compass();
  await eva.getByLabel('Look from').selectOption({ label: 'Save this view…' });
  await eva.fill('#view_name', 'from above');
  await eva.click('#views button:has-text("Save")');
  await eva.click('#views button:has-text("Close")');
  await eva.focus('#canvas');
  await eva.keyboard.press('0');
  await drawn(eva);
  assert.notEqual(await compass(), top);
  await eva.getByLabel('Look from').selectOption({ label: 'from above' });
  await drawn(eva);
  assert.equal(await compass(), top);
  await eva.getByLabel('Look from').selectOption({ label: 'Save this view…' });
  await eva.click('#views button[aria-label="Forget from above"]');
  await eva.click('#views button:has-text("Close")');
  assert.equal(await eva.getByLabel('Look from').locator('option', { hasText: 'from above' }).count(), 0);
});

test('a pair without a verdict is named in the list and in the view, with what it waits for', async () => {
  await grab(tom, 'ball');
  await tom.focus('#canvas');
  await tom.keyboard.press('f');
  await moveBy(tom, [0, 0, -38]);
  for (const page of [eva, tom]) await page.locator('#unexamined li', { hasText: 'shell × ball' }).getByText('a mesh is open').waitFor(PATIENCE);
  await tom.locator('#labels > div', { hasText: 'shell × ball: not examined' }).waitFor(PATIENCE);
  await moveBy(tom, [0, 0, 60]);
  await tom.locator('#unexamined').waitFor({ ...PATIENCE, state: 'hidden' });
});

test('nothing was complained of', () => {
  assert.deepEqual([...eva.complaints, ...tom.complaints], []);
});
