// Fits asked in bulk: what is of one pattern and size is one group with one code; everybody sees all of them, and they are taken back as one step.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { BrowserSession } from '../support/browser_session.mjs';
import { PATIENCE } from '../support/people.mjs';

const session = new BrowserSession('proposed');
let eva, tom;

// Three pegs and bores of Ø20, and a fourth peg that is too thick for any fit of Ø20.
const at = (i) => `{position: [${80 * i}, 0, 0]}`;
const peg = (name, diameter, i) => `  - {name: ${name}, moving: true, generator: {kind: dowel, diameter: ${diameter}, length: 40, chamfer: 1, facets: 32, phase_deg: 5.625}, instances: [${i.map((k) => `{name: peg_${k}, pose: ${at(k)}}`).join(', ')}]}`;
const SCENE = `
name: proposed
units: mm
policy: report
deviation: recognized
parts:
  - {name: plate, generator: {kind: plate_with_bore, bore: 20, facets: 32}, instances: [${[1, 2, 3, 4].map((k) => `{name: plate_${k}, pose: ${at(k)}}`).join(', ')}]}
${peg('peg', 20, [1, 2, 3])}
${peg('thick', 20.4, [4])}
`;
const inForce = (page) => page.getByLabel('Rules in force').locator('li', { hasText: 'H7/g6' });
const picture = async (page, name) => process.env.MORTISE_PICTURES && page.screenshot({ path: join(process.env.MORTISE_PICTURES, `${name}.png`) });

before(async () => {
  await session.serve(SCENE);
  await session.show();
  [eva, tom] = await session.join('Eva', 'Tom');
  for (const page of [eva, tom]) await page.click('#tab_rules');
}, { timeout: 240_000 });

test('holes of one pattern and size are one line with their count, and open to single pairs', async () => {
  const group = eva.getByLabel('Proposed fits').locator('li.several');
  await group.getByText('3 × Ø20 in Ø20: plate* × peg*').waitFor(PATIENCE);
  assert.equal(await eva.getByLabel('Proposed fits').locator(':scope > li').count(), 2, 'the thick one stands apart');
  const inner = group.locator('ul > li');
  assert.ok(await inner.first().isHidden());
  await group.getByText('Single pairs').click();
  assert.equal(await inner.count(), 3);
  await inner.first().waitFor(PATIENCE);
  await picture(eva, 'groups');
  await eva.setViewportSize({ width: 390, height: 844 });
  const targets = await eva.locator('form:has([aria-label="Proposed fits"])').evaluate((form) => [...form.querySelectorAll('button, input, summary')].filter((at) => at.checkVisibility())
    .map((at) => [at.getAttribute('aria-label') ?? at.textContent, at.getBoundingClientRect()]).filter(([, r]) => r.height < 43.5 || r.left < 0 || r.right > innerWidth).map(([name]) => name));
  await picture(eva, 'groups_390');
  assert.deepEqual(targets, [], 'too small or cut off');
  await eva.setViewportSize({ width: 1280, height: 720 });
});

test('one code is set for a group: another page sees all its rules; one step takes them back', async () => {
  const button = eva.getByRole('button', { name: 'Set for all 3' });
  assert.ok(await button.isDisabled(), 'without a code there is nothing to set');
  await eva.getByLabel('Fit for 3 × Ø20 in Ø20: plate* × peg*').fill('H7/g6');
  await button.click();
  await eva.getByText('Fits set: 3', { exact: true }).waitFor(PATIENCE);
  for (const k of [1, 2, 3]) await tom.getByLabel('Rules in force').locator('li', { hasText: new RegExp(`plate_${k}\\..+ × peg_${k}\\..+ H7/g6`) }).getByText('Eva').waitFor(PATIENCE);
  await picture(eva, 'group_set');
  await eva.getByRole('button', { name: 'Take back the 3 that were set' }).click();
  await eva.getByText('Fits taken back: 3', { exact: true }).waitFor(PATIENCE);
  await inForce(tom).first().waitFor({ ...PATIENCE, state: 'detached' });
  await eva.getByLabel('Proposed fits').locator('li.several').getByText('3 × Ø20').waitFor(PATIENCE);
});

test('what could not be set is counted and named, and the others are set', async () => {
  await eva.getByLabel('Fit for what is proposed').fill('Ø20 H7/g6');
  await eva.getByRole('button', { name: 'Set for all', exact: true }).click();
  await eva.getByText('Fits set: 3 of 4').waitFor(PATIENCE);
  await eva.getByText(/^Fits not set: 1: plate_4\..+ × peg_4\..+ \(.+\)$/).waitFor(PATIENCE);
  await inForce(tom).nth(2).waitFor(PATIENCE);
  assert.equal(await inForce(tom).count(), 3);
  assert.deepEqual([...eva.complaints, ...tom.complaints], []);
});
