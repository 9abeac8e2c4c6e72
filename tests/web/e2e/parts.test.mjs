// People bring their parts as files: everybody sees them and the verdict, and the way out of it; what is refused says why; what was done is taken back.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { cpus, loadavg } from 'node:os';
import { join, resolve } from 'node:path';
import { before, test } from 'node:test';
import { openPage } from '../support/browser.mjs';
import { BrowserSession } from '../support/browser_session.mjs';
import { PATIENCE, choose, until, whenListed } from '../support/people.mjs';
import { box, glb, obj } from '../support/solids.mjs';

const session = new BrowserSession('parts');
let browser, addresses, eva, tom;

// As `mortise open` begins without a file.
const SCENE = `
name: empty
units: mm
policy: report
deviation: recognized
parts: []
`;
const began = Date.now();

/** A block as an STL of text, in the numbers given. @param {[number, number, number]} size @param {[number, number, number]} at */
function stl(size, at) {
  const { points, triangles } = box(size);
  const corner = (i) => `vertex ${[0, 1, 2].map((k) => points[3 * i + k] + at[k]).join(' ')}`;
  const facets = Array.from({ length: triangles.length / 3 }, (_, k) => `facet normal 0 0 0\nouter loop\n${[0, 1, 2].map((c) => corner(triangles[3 * k + c])).join('\n')}\nendloop\nendfacet\n`);
  return `solid block\n${facets.join('')}endsolid block\n`;
}

const file = (name, text) => {
  const path = join(session.folder, name);
  writeFileSync(path, text);
  return path;
};

/** Files that are dropped on the page. @param {import('playwright-core').Page} page @param {Array<[string, string | Uint8Array]>} files */
async function drop(page, files) {
  const carried = await page.evaluateHandle((all) => {
    const data = new DataTransfer();
    for (const [name, bytes] of all) data.items.add(new File([Uint8Array.from(bytes)], name));
    return data;
  }, files.map(([name, content]) => /** @type {[string, number[]]} */ ([name, [...Buffer.from(content)]])));
  await page.dispatchEvent('.view', 'dragover', { dataTransfer: carried });
  await page.dispatchEvent('.view', 'drop', { dataTransfer: carried });
}

before(async () => {
  await session.serve(SCENE);
  ({ browser, addresses } = await session.show());
  [eva, tom] = await session.join('Eva', 'Tom');
  await tom.locator('#no_parts').waitFor(PATIENCE);
}, { timeout: 240_000 });

test('in an empty session two files become parts, units are asked once with the size shown, and everybody has the verdict within a minute', async (t) => {
  if (process.env.MORTISE_PICTURES) await eva.screenshot({ path: join(process.env.MORTISE_PICTURES, 'empty.png') });
  await eva.setInputFiles('#add_files', [file('bracket.stl', stl([2, 2, 2], [0, 0, 0])), file('cover.stl', stl([2, 1, 2], [0, 1.3, 0]))]);
  await eva.locator('#units_list li', { hasText: 'bracket.stl' }).getByText('2 × 2 × 2 mm').waitFor(PATIENCE);
  await eva.getByLabel('Unit of their numbers').selectOption('cm');
  await eva.locator('#units_list li', { hasText: 'cover.stl' }).getByText('20 × 10 × 20 mm').waitFor(PATIENCE);
  await eva.click('#units_add');
  for (const page of [eva, tom]) await whenListed(page, 'clashes', 'real, bracket × cover');
  const took = (Date.now() - began) / 1000;
  t.diagnostic(`from no server at all to the verdict: ${took.toFixed(1)} s`);
  if (loadavg()[0] <= 1.5 * cpus().length) assert.ok(took < 60, `it took ${took} s`); // a busy machine shows nothing
  await eva.locator('#arriving > li').first().waitFor({ ...PATIENCE, state: 'detached' });
  const late = await openPage(browser, addresses.observer);
  await whenListed(late, 'parts', 'cover');
  assert.ok(await late.locator('#add_parts').isHidden(), 'who looks on brings nothing');
  await late.context().close();
});

test('the way out of a clash is told with its length, and goes as a ghost', async () => {
  await tom.locator('#clashes > li[aria-label*="bracket × cover"]').click();
  const ghost = tom.locator('#labels > div', { hasText: ', free' });
  assert.equal(await ghost.count(), 0);
  const out = tom.getByRole('button', { name: 'Show the way out' });
  await out.click();
  const told = await tom.locator('#clash .way').textContent();
  assert.match(told, /^(bracket comes free of cover|cover comes free of bracket) by 2\.000 mm, along the normal/);
  await ghost.waitFor(PATIENCE);
  assert.equal(await out.getAttribute('aria-pressed'), 'true');
  if (process.env.MORTISE_PICTURES) await tom.screenshot({ path: join(process.env.MORTISE_PICTURES, 'way_out.png') });
  await out.click();
  await ghost.waitFor({ ...PATIENCE, state: 'detached' });
  assert.equal(await tom.locator('#clash .way').textContent(), '');
});

test('files that cannot be parts say why in their row', async () => {
  const row = (text) => tom.locator('#arriving > li', { hasText: text });
  await drop(tom, [['notes.txt', 'x']]);
  await row('notes.txt').getByText('neither a mesh').waitFor(PATIENCE);
  await drop(tom, [['frame.step', 'ISO-10303-21;']]);
  await tom.click('#units_add');
  await row('frame').locator('button').waitFor(PATIENCE);
  assert.doesNotMatch(await row('frame').textContent(), /frame: (…|is read|\d.*parts)$/);
  await drop(tom, [['torn.stl', 'solid torn\nfacet normal 0 0 0\n']]);
  await tom.click('#units_add');
  await row('torn').locator('button').waitFor(PATIENCE);
  const why = await row('torn').textContent();
  assert.doesNotMatch(why, /torn: (…|\d+ %|is added)$/, why);
  if (process.env.MORTISE_PICTURES) await tom.screenshot({ path: join(process.env.MORTISE_PICTURES, 'refused.png') });
  for (let left = 3; left > 0; --left) await tom.locator('#arriving button').first().click();
  assert.equal(await tom.locator('#arriving > li').count(), 0);
});

test('a part is made to stand, is removed for everybody, and comes back', async () => {
  await choose(eva, 'cover');
  await eva.getByRole('button', { name: 'May be moved' }).click();
  await tom.waitForFunction(() => [...document.querySelectorAll('#parts > li')].some((li) => li.getAttribute('aria-label')?.startsWith('cover, fixed')), undefined, PATIENCE);
  await eva.getByRole('button', { name: 'Undo: cover stands' }).click();
  await tom.waitForFunction(() => [...document.querySelectorAll('#parts > li')].some((li) => li.getAttribute('aria-label')?.startsWith('cover, moving')), undefined, PATIENCE);
  await choose(eva, 'cover');
  await eva.getByRole('button', { name: 'Remove the part' }).click();
  await tom.locator('#parts > li', { hasText: 'cover' }).waitFor({ ...PATIENCE, state: 'detached' });
  if (process.env.MORTISE_PICTURES) await eva.screenshot({ path: join(process.env.MORTISE_PICTURES, 'removed.png') });
  await eva.getByRole('button', { name: 'Undo: cover is removed' }).click();
  for (const page of [eva, tom]) await whenListed(page, 'clashes', 'real, bracket × cover');
});

test('a file replaces a part: everybody sees it and is told what became of its clashes; who comes later too; it is taken back', async () => {
  await choose(eva, 'cover');
  const replace = async (name, size, at) => {
    const [chooser] = await Promise.all([eva.waitForEvent('filechooser'), eva.getByRole('button', { name: 'Replace the part by a file' }).click()]);
    await chooser.setFiles(file(name, stl(size, at)));
    await eva.getByRole('heading', { name: 'Replace cover' }).waitFor(PATIENCE);
    assert.ok(await eva.locator('#units_move').isHidden(), 'it stays as movable as it was');
    await eva.getByLabel('Unit of their numbers').selectOption('cm');
    if (process.env.MORTISE_PICTURES) await eva.screenshot({ path: join(process.env.MORTISE_PICTURES, 'replace_asked.png') });
    await eva.click('#units_add');
  };
  const told = (page, text) => page.locator('#said > div', { hasText: text }).waitFor(PATIENCE);
  let heard = [told(tom, 'Eva replaced cover: faces:'), told(tom, 'Clashes of cover: 1 as before'), told(eva, 'Clashes of cover: 1 as before')];
  await replace('cover_b.stl', [2, 1, 3], [0, 1.3, 0]);
  await Promise.all(heard);
  if (process.env.MORTISE_PICTURES) await eva.screenshot({ path: join(process.env.MORTISE_PICTURES, 'replaced.png') });
  heard = [told(tom, 'Clashes of cover: 1 gone')];
  await replace('cover_c.stl', [2, 0.2, 2], [0, 1.7, 0]);
  await Promise.all(heard);
  const late = await openPage(browser, addresses.observer);
  await whenListed(late, 'parts', 'cover');
  assert.match(await late.textContent('#clashes') ?? '', /No clash is open/);
  await late.context().close();
  const undo = eva.getByRole('button', { name: 'Undo: cover is replaced' });
  for (const left of [1, 0]) {
    await undo.last().click();
    await until(async () => (await undo.count()) === left, () => `${left} to be undone`);
  }
  for (const page of [eva, tom]) await whenListed(page, 'clashes', 'real, bracket × cover');
});

test('an OBJ and a GLB file that are dropped become parts, each in its unit, and everybody has the verdict', async () => {
  await drop(tom, [['pad.obj', obj([20, 20, 20], [500, 0, 0])], ['stud.glb', glb([0.02, 0.02, 0.02], [0.515, 0, 0])]]);
  await tom.locator('#units_list li', { hasText: 'pad.obj' }).getByText('20 × 20 × 20 mm').waitFor(PATIENCE);
  await tom.locator('#units_list li', { hasText: 'stud.glb' }).waitFor(PATIENCE);
  await tom.click('#units_add');
  for (const page of [eva, tom]) await whenListed(page, 'clashes', 'real, pad × stud');
  await tom.locator('#clashes > li[aria-label*="pad × stud"]').click();
  assert.match(await tom.locator('#clash dl').textContent() ?? '', /Overlap5\.000 mm/, 'metres there, millimetres here');
  await tom.locator('#arriving > li').first().waitFor({ ...PATIENCE, state: 'detached' });
});

test('fits of bores and shafts that were found are proposed, and set at once for all', async () => {
  const plate = join(session.folder, 'plate.stl');
  const peg = join(session.folder, 'peg.stl');
  await session.run('generate', ['plate_with_bore', 'bore_mm=20', 'facets=32', '-o', plate]);
  await session.run('generate', ['dowel', 'diameter_mm=20', 'length_mm=40', 'chamfer_mm=1', 'facets=32', 'phase_rad=0.098', '-o', peg]);
  await tom.setInputFiles('#add_files', [plate, peg]);
  await tom.click('#units_add');
  await whenListed(tom, 'parts', 'peg');
  await tom.click('#tab_rules');
  await tom.getByLabel('Proposed fits').locator('li', { hasText: /^plate\..+ × peg\./ }).waitFor(PATIENCE);
  const all = tom.getByRole('button', { name: 'Set for all' });
  assert.ok(await all.isDisabled(), 'without a code there is nothing to set');
  await tom.getByLabel('Fit for what is proposed').fill('H7/g6');
  if (process.env.MORTISE_PICTURES) await tom.screenshot({ path: join(process.env.MORTISE_PICTURES, 'proposed.png') });
  await all.click();
  if (process.env.MORTISE_PICTURES) { await tom.waitForTimeout(1500); await tom.screenshot({ path: join(process.env.MORTISE_PICTURES, 'proposed_set.png') }); }
  await tom.locator('#rules_panel li', { hasText: /plate\..+ × peg\..+ H7\/g6/ }).getByText('Tom').waitFor(PATIENCE);
  await all.waitFor({ ...PATIENCE, state: 'hidden' });
});

test('a STEP file becomes all its parts, each where the file has it', async () => {
  await tom.setInputFiles('#add_files', resolve(import.meta.dirname, '../../../scenarios/tensioner.step'));
  await tom.locator('#units_list li', { hasText: 'tensioner.step' }).waitFor(PATIENCE);
  await tom.click('#units_add');
  const row = tom.locator('#arriving > li', { hasText: 'tensioner' });
  await row.waitFor(PATIENCE);
  await tom.waitForFunction(() => ![...document.querySelectorAll('#arriving > li')].some((li) => !li.classList.contains('bad')), undefined, { timeout: 240_000 });
  for (const page of [eva, tom]) await page.waitForFunction(() => document.querySelectorAll('#parts > li').length === 6 + 19, undefined, PATIENCE);
  assert.equal(await tom.locator('#arriving').textContent(), '', 'its three tolerances are used, and nothing was left out');
  if (process.env.MORTISE_PICTURES) await tom.screenshot({ path: join(process.env.MORTISE_PICTURES, 'step.png') });
  for (const left of await tom.locator('#arriving button').all()) await left.click();
});

test('a file under no ticket, of a foreign page or without a token is not taken', async () => {
  const at = new URL(addresses.designer);
  const token = new URLSearchParams(at.hash.slice(1)).get('token');
  const post = async (path, headers) => (await fetch(new URL(path, at), { method: 'POST', body: 'solid x', headers })).status;
  const mine = { Authorization: `Bearer ${token}`, Origin: at.origin };
  assert.equal(await post('upload/0123456789abcdef0123456789abcdef', mine), 404);
  assert.equal(await post('upload/0', { Origin: at.origin }), 401);
  assert.equal(await post('upload/0', { ...mine, Origin: 'http://evil.example' }), 403);
});

test('nothing was complained of', () => {
  assert.deepEqual([...eva.complaints, ...tom.complaints], []);
});
