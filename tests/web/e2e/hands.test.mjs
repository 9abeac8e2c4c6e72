// What hands do: every stop says why, asking for a part, several parts, hiding, measuring, dragging, the shadow on the ground, pictures, a 3D mouse.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { before, test } from 'node:test';
import { openPage } from '../support/browser.mjs';
import { BrowserSession } from '../support/browser_session.mjs';
import { PATIENCE, choose, drawn, grab, moveBy, position, settled, settledElsewhere, ticksPass, until, whenListed } from '../support/people.mjs';
import { PEGS } from '../support/scenario.mjs';

const session = new BrowserSession('hands');
let ann, bob;

before(async () => {
  await session.serve(PEGS);
  await session.show();
  [ann, bob] = await session.join('ann', 'bob');
  await whenListed(ann, 'parts', 'peg_k6');
  await whenListed(bob, 'parts', 'peg_k6');
}, { timeout: 240_000 });

async function release(page) {
  await page.click('#hand button:has-text("Release")');
  await page.locator('#tool_select[aria-pressed="true"]').waitFor({ ...PATIENCE, state: 'attached' });
}

/** The chosen part fills the view, seen from the side of this key. */
async function lookAtIt(page, key) {
  await page.focus('#canvas');
  await page.keyboard.press(key);
  await drawn(page);
  await page.keyboard.press('z');
  await drawn(page);
}

/** The plane of the view is that of X and Z. */
const lookAtItsFront = (page) => lookAtIt(page, '2');

/** Takes what is in the view beside its middle, where handles may stand, and drags it, pixels. */
async function drag(page, [right, down]) {
  const box = await page.locator('#canvas').boundingBox();
  const [x, y] = [box.x + box.width / 2 - 60, box.y + box.height / 2 + 60];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + right, y + down, { steps: 8 });
  await page.mouse.up();
}

/** With the axis of its journal on that of a bore: it may be moved along it and turned about it. */
async function alignStray(page) {
  await grab(page, 'stray');
  await page.click('#tool_align');
  await page.locator('#align_bar option[value="journal"]').first().waitFor({ ...PATIENCE, state: 'attached' });
  await page.getByLabel('Feature of the part in your hand').selectOption('journal');
  await page.getByLabel('Other part', { exact: true }).selectOption({ label: 'plate_k6' });
  await page.getByLabel('Feature of the other part').selectOption('bore');
  await page.click('#align_bar button:has-text("Align")');
  await page.getByText('Kept:').waitFor(PATIENCE);
  await settled(page);
}

/** Of a picture of the view without what lies on it: how bright its pixels are, 0 … 765, row by row. */
async function brightness(page) {
  const cover = (visibility) => page.evaluate((how) => document.querySelectorAll('.view > :not(#canvas)').forEach((element) => (element.style.visibility = how)), visibility);
  await cover('hidden');
  await page.locator('#canvas').blur(); // its outline is no part of the view
  const png = (await page.locator('#canvas').screenshot()).toString('base64');
  await cover('');
  return page.evaluate(async (text) => {
    const picture = await createImageBitmap(new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))]));
    const { width, height } = picture;
    const pen = new OffscreenCanvas(width, height).getContext('2d');
    pen.drawImage(picture, 0, 0);
    const { data } = pen.getImageData(0, 0, width, height);
    return { width, sums: Array.from({ length: width * height }, (_, i) => data[4 * i] + data[4 * i + 1] + data[4 * i + 2]) };
  }, png);
}

test('"Move by" clears its numbers after use', async () => {
  await grab(ann, 'block');
  const from = await settled(ann);
  await moveBy(ann, [0, 0, 7]);
  const values = await ann.locator('#hand input').evaluateAll((fields) => fields.map((field) => field.value));
  assert.deepEqual(values, ['0', '0', '0']);
  const to = await settledElsewhere(ann, from);
  assert.ok(Math.abs(to[2] - from[2] - 7) < 1e-3);
  await ann.locator('#hand input').first().press('Enter');
  assert.deepEqual(await settled(ann), to);
  await release(ann);
});

test('a part is dragged by itself in the plane of the view', async () => {
  await grab(ann, 'block');
  await ann.click('#tool_move');
  await lookAtItsFront(ann);
  const from = await settled(ann);
  await drag(ann, [40, 30]);
  const to = await settledElsewhere(ann, from);
  assert.ok(to[0] > from[0] + 1 && to[2] < from[2] - 1, `dragged from ${from} to ${to}`);
  assert.ok(Math.abs(to[1] - from[1]) < 1e-3, `out of the plane of the view: from ${from} to ${to}`);
  await release(ann);
});

test('one gesture takes a part that nobody holds and drags it; a click with the same tool asks for nothing', async () => {
  await choose(ann, 'block');
  await lookAtItsFront(ann);
  await ann.keyboard.press('Escape'); // a tool that is chosen beside a chosen part would take that
  await ann.locator('#hand').waitFor({ ...PATIENCE, state: 'hidden' });
  await ann.keyboard.press('t');
  await drag(ann, [0, 0]);
  await ann.locator('#hand strong', { hasText: 'block' }).waitFor(PATIENCE);
  const from = await settled(ann);
  assert.equal(await ann.textContent('#hand .quiet'), 'free');
  await drag(ann, [40, 30]);
  await ann.locator('#hand .quiet', { hasText: 'in your hand' }).waitFor(PATIENCE);
  const to = await settledElsewhere(ann, from);
  // The way that the pointer went before the part was granted is not lost: as far as one in hand goes.
  assert.ok(to[0] > from[0] + 1 && Math.abs((to[0] - from[0]) / (from[2] - to[2]) - 40 / 30) < 0.01, `dragged from ${from} to ${to}`);
  await bob.locator('#people > li', { hasText: 'holds 1' }).filter({ hasText: 'ann' }).waitFor(PATIENCE);
  await release(ann);
});

test('a stop at a real contact says with which part and by how much, in the bar and at the part', async () => {
  await grab(ann, 'peg_p6');
  await ann.focus('#canvas');
  await ann.keyboard.press('f');
  await moveBy(ann, [0, 0, -28]);
  const said = ann.locator('#hand .stop', { hasText: 'Real contact with plate_p6' });
  await said.waitFor(PATIENCE);
  assert.match(await said.textContent(), /^[\d.]+ mm of the move is missing\. Real contact with plate_p6: [\d.]+ µm deep .* [\d.]+ µm beyond .*\(clash #\d+\)/);
  await ann.locator('#labels > div', { hasText: 'real contact: plate_p6' }).waitFor(PATIENCE);
  await moveBy(ann, [0, 0, 3]); // away from it there is nothing to say
  await said.waitFor({ ...PATIENCE, state: 'hidden' });
  await release(ann);
});

test('a stop by a constraint names it, and one by somebody else’s hand names the holder', async () => {
  await alignStray(bob);
  await bob.click('#tool_move');
  await moveBy(bob, [4, 0, 0]);
  const said = bob.locator('#hand .stop', { hasText: 'Held by its constraint: journal coaxial with plate_k6 bore' });
  await said.waitFor(PATIENCE);
  assert.match(await said.textContent(), /^4\.000 mm of the move is missing/);
  await choose(ann, 'stray');
  const from = await settled(ann);
  await ann.click('#tool_move');
  await lookAtItsFront(ann);
  await drag(ann, [40, 30]);
  await ann.getByText('stray is held by bob: ask for it').waitFor(PATIENCE);
  assert.deepEqual(await settled(ann), from);
  await ann.click('#tool_select');
  await release(bob);
});

test('a part under a constraint that is dragged by itself follows the freedom that is left', async () => {
  await alignStray(bob);
  await bob.click('#tool_move');
  await lookAtItsFront(bob);
  const from = await settled(bob);
  await drag(bob, [40, -30]);
  const to = await settledElsewhere(bob, from);
  assert.ok(to[2] > from[2] + 1, `not along its axis: from ${from} to ${to}`);
  assert.ok(Math.hypot(to[0] - from[0], to[1] - from[1]) < 1e-3, `off its axis: from ${from} to ${to}`);
  await release(bob);
});

test('twenty typed moves along an axis go all the way', async () => {
  await alignStray(bob);
  const [x, y, z] = await settled(bob);
  for (let i = 0; i < 20; ++i) {
    const goal = i % 2 ? z : z + 5;
    await moveBy(bob, [0, 0, goal - (i % 2 ? z + 5 : z)]);
    await until(async () => Math.abs((await position(bob))[2] - goal) < 1e-3, () => `move ${i} to ${goal}`);
  }
  const to = await settled(bob);
  assert.ok(Math.hypot(to[0] - x, to[1] - y, to[2] - z) < 1e-3, `from ${[x, y, z]} to ${to}`);
  await bob.click('#tool_select');
  await release(bob);
});

test('who asks for a part sees that for as long as it takes, whatever is chosen, and may ask no longer', async () => {
  await grab(ann, 'block');
  await choose(bob, 'block');
  await bob.click('#hand button:has-text("Ask for it")');
  const asks = (page, text) => page.locator('#asks > div', { hasText: text });
  await asks(bob, 'You ask ann for block').waitFor(PATIENCE);
  await asks(ann, 'bob asks you for block').waitFor(PATIENCE);
  await choose(bob, 'peg_g6');
  await choose(ann, 'peg_g6');
  await ticksPass(bob, 420); // longer than a lease
  assert.ok(await asks(bob, 'You ask ann for block').isVisible());
  assert.ok(await asks(ann, 'bob asks you for block').isVisible());
  await asks(bob, 'You ask ann for block').getByText('Ask no longer').click();
  await asks(ann, 'bob asks you').waitFor({ ...PATIENCE, state: 'hidden' });
  await choose(bob, 'block');
  await bob.click('#hand button:has-text("Ask for it")');
  await asks(ann, 'bob asks you for block').getByText('Give it to bob').click();
  await bob.locator('#hand .quiet', { hasText: 'in your hand' }).waitFor(PATIENCE);
  assert.ok(await bob.locator('#asks').isHidden());
  await release(bob);
  // One that is let go while somebody waits for it is said to be free.
  await grab(ann, 'block');
  await bob.click('#hand button:has-text("Ask for it")');
  await asks(bob, 'You ask ann for block').waitFor(PATIENCE);
  await release(ann);
  await bob.getByText('block is free now').waitFor(PATIENCE);
});

test('a click, another with Ctrl, and G: both parts are in hand', async () => {
  await choose(ann, 'block');
  await ann.locator('#parts > li', { hasText: 'peg_g6' }).click({ modifiers: ['Control'] });
  await ann.focus('#canvas');
  await ann.keyboard.press('g');
  await bob.locator('#people > li', { hasText: 'holds 2' }).filter({ hasText: 'ann' }).waitFor(PATIENCE);
  await ann.keyboard.press('g');
  await bob.locator('#people > li', { hasText: 'holds 2' }).waitFor({ ...PATIENCE, state: 'hidden' });
  for (let i = 0; i < 3 && (await ann.locator('#parts > li.gathered').count()) > 0; ++i) await ann.keyboard.press('Escape');
  assert.equal(await ann.locator('#parts > li.gathered').count(), 0);
});

test('in the view as well: a click, another with Ctrl, and G', async () => {
  await choose(ann, 'block');
  await ann.locator('#parts > li', { hasText: 'peg_g6' }).click({ modifiers: ['Control'] });
  await ann.focus('#canvas');
  for (const key of ['i', '2', 'Escape', 'Escape']) await ann.keyboard.press(key);
  await ann.locator('#hand').waitFor({ ...PATIENCE, state: 'hidden' });
  await drawn(ann);
  const { width, sums } = await brightness(ann);
  const solid = sums.flatMap((sum, i) => (Math.abs(sum - sums[i - (i % width) + 8]) > 60 ? [i] : []));
  const [left, right] = [Math.min(...solid.map((i) => i % width)) + 12, Math.max(...solid.map((i) => i % width)) - 12];
  const box = await ann.locator('#canvas').boundingBox();
  /** In the middle of what is seen in this column. */
  const press = (x) => {
    const rows = solid.filter((i) => i % width === x).map((i) => Math.floor(i / width));
    return ann.mouse.click(box.x + x, box.y + (rows[0] + rows[rows.length - 1]) / 2);
  };
  await press(left);
  await ann.locator('#hand strong', { hasText: 'block' }).waitFor(PATIENCE);
  await ann.keyboard.down('Control');
  await press(right);
  await ann.keyboard.up('Control');
  await ann.locator('#parts > li.gathered', { hasText: 'peg_g6' }).waitFor(PATIENCE);
  assert.equal(await ann.locator('#parts > li.gathered').count(), 2);
  await ann.keyboard.press('g');
  await bob.locator('#people > li', { hasText: 'holds 2' }).filter({ hasText: 'ann' }).waitFor(PATIENCE);
  await ann.keyboard.press('g');
  await bob.locator('#people > li', { hasText: 'holds 2' }).waitFor({ ...PATIENCE, state: 'hidden' });
  await ann.locator('#tool_select[aria-pressed="true"]').waitFor({ ...PATIENCE, state: 'attached' });
  for (const key of ['u', 'Escape', 'Escape']) await ann.keyboard.press(key);
});

test('parts are hidden, shown alone, and shown again; what is hidden is not hit', async () => {
  await choose(ann, 'block');
  await ann.focus('#canvas');
  await ann.keyboard.press('z');
  await drawn(ann);
  const box = await ann.locator('#canvas').boundingBox();
  const middle = [box.x + box.width / 2, box.y + box.height / 2];
  await ann.keyboard.press('d');
  await ann.locator('#hidden_count', { hasText: '1 hidden' }).waitFor(PATIENCE);
  await ann.mouse.click(...middle);
  assert.notEqual(await ann.locator('#hand strong').textContent(), await ann.locator('#hand').isVisible() ? 'block' : 'nothing');
  await ann.keyboard.press('u');
  await ann.locator('#hidden_row').waitFor({ ...PATIENCE, state: 'hidden' });
  await ann.mouse.click(...middle);
  await ann.locator('#hand strong', { hasText: 'block' }).waitFor(PATIENCE);
  await ann.click('#hand button[aria-label^="Show it alone"]');
  await ann.locator('#hidden_count', { hasText: '7 hidden' }).waitFor(PATIENCE);
  await ann.click('#show_hidden');
});

test('the face under the pointer lights up, and no other', async () => {
  await choose(ann, 'block');
  await ann.focus('#canvas');
  for (const key of ['i', 'k']) await ann.keyboard.press(key);
  await lookAtIt(ann, '0');
  const box = await ann.locator('#canvas').boundingBox();
  const [x, y] = [Math.round(box.width / 2), Math.round(box.height / 2)];
  const faces = { front: [x - 70, y + 40], right: [x + 80, y + 20], top: [x - 10, y - 85] };
  await ann.mouse.move(box.x + 30, box.y + box.height / 2);
  await drawn(ann);
  const dark = await brightness(ann);
  await ann.mouse.move(box.x + faces.front[0], box.y + faces.front[1]);
  await ann.locator('#labels > div', { hasText: /^block: / }).waitFor(PATIENCE);
  await drawn(ann);
  const lit = await brightness(ann);
  const by = ([right, down]) => lit.sums[down * lit.width + right] - dark.sums[down * lit.width + right];
  assert.ok(by(faces.front) > 30, `by ${by(faces.front)}`);
  assert.deepEqual([by(faces.right), by(faces.top)], [0, 0]);
  for (const key of ['Escape', 'u']) await ann.keyboard.press(key);
});

test('what is between two faces is measured, with what the session has judged of them', async () => {
  await choose(ann, 'block');
  await ann.focus('#canvas');
  await ann.keyboard.press('k');
  await ann.keyboard.press('1');
  await drawn(ann);
  await ann.keyboard.press('z');
  await drawn(ann);
  const box = await ann.locator('#canvas').boundingBox();
  const middle = [box.x + box.width / 2, box.y + box.height / 2];
  await ann.mouse.move(middle[0] + 3, middle[1] + 3);
  await ann.locator('#labels > div', { hasText: /^block: / }).waitFor(PATIENCE); // the face under the pointer, before it is clicked
  await ann.mouse.click(...middle); // its top
  await ann.focus('#canvas');
  await ann.keyboard.press('2');
  await drawn(ann);
  await ann.keyboard.press('z');
  await drawn(ann);
  await ann.mouse.click(...middle); // its front
  await ann.locator('#measure_bar', { hasText: 'Angle 90.0000°' }).waitFor(PATIENCE);
  await ann.click('#measure_bar button:has-text("Measure anew")');
  await ann.locator('#measure_bar', { hasText: 'Click a face' }).waitFor(PATIENCE);
  await ann.keyboard.press('Escape');
});

test('a side of the cube looks from there, and the view is saved as a picture', async () => {
  const eye = () => ann.evaluate(() => document.getElementById('compass')?.toDataURL());
  await ann.focus('#canvas');
  await ann.keyboard.press('0');
  await drawn(ann);
  const before = await eye();
  const cube = await ann.locator('#compass').boundingBox();
  await ann.mouse.click(cube.x + cube.width / 2, cube.y + cube.height / 2 - 14); // its top
  await drawn(ann);
  const top = await eye();
  assert.notEqual(top, before);
  await ann.focus('#canvas');
  await ann.keyboard.press('1');
  await drawn(ann);
  assert.equal(await eye(), top);
  const [download] = await Promise.all([ann.waitForEvent('download'), ann.click('#view_picture')]);
  const bytes = readFileSync(await download.path());
  assert.equal(bytes.subarray(1, 4).toString(), 'PNG');
  assert.ok(bytes.length > 5000);
});

test('the ground under a part is darker than beside it, until its shadow is turned off or a plane cuts', async () => {
  await choose(ann, 'block');
  await ann.focus('#canvas');
  await ann.keyboard.press('i');
  await lookAtIt(ann, '0');
  const on = await brightness(ann);
  await ann.click('#view_ground');
  await ann.locator('#view_ground[aria-pressed="false"]').waitFor(PATIENCE);
  await drawn(ann);
  const off = await brightness(ann);
  const darker = on.sums.map((sum, i) => off.sums[i] - sum);
  const edge = (i) => i - (i % on.width) + 8; // in the same row, at the edge of the view
  const bare = (i) => Math.abs(off.sums[i] - off.sums[edge(i)]) <= 6;
  const at = darker.reduce((most, by, i) => (by > darker[most] && bare(i) ? i : most), 0);
  const beside = edge(at);
  assert.ok(on.sums[at] < on.sums[beside] - 20, `${on.sums[at]} under the part, ${on.sums[beside]} beside it`);
  assert.ok(darker.every((by) => by >= -6), 'a shadow makes nothing brighter');
  await ann.click('#view_ground');
  await ann.focus('#canvas');
  await ann.keyboard.press('x');
  await ann.locator('#section_bar:not([hidden])').waitFor(PATIENCE);
  await drawn(ann);
  const cut = await brightness(ann);
  assert.ok(Math.abs(cut.sums[at] - cut.sums[beside]) <= 6, `cut: ${cut.sums[at]}, beside it ${cut.sums[beside]}`);
  await ann.focus('#canvas');
  await ann.keyboard.press('x');
  await ann.keyboard.press('u');
});

test('a snap takes the declared fit before what is nearer', async () => {
  await grab(ann, 'peg_g6');
  await ann.click('#tool_align');
  await ann.locator('#align_bar option[value="end_lower"]').first().waitFor({ ...PATIENCE, state: 'attached' });
  const own = ann.getByLabel('Feature of the part in your hand');
  const [, , z] = await settled(ann);
  await moveBy(ann, [0, 0, 16 - z]); // 1 mm above the plate, 5 mm beside its bore
  await until(async () => (await position(ann))[2] === 16, () => 'the peg comes above the plate');
  /** Snaps, tells how far that was, mm, and frees the part again. */
  async function snap(feature, says) {
    await own.selectOption(feature);
    await ann.click('#align_bar button:has-text("Snap")');
    const said = ann.locator('#said > div', { hasText: says });
    await said.waitFor(PATIENCE);
    await settled(ann);
    await ann.click('#align_bar button:has-text("Free")');
    await ann.locator('#align_bar', { hasText: 'Kept:' }).waitFor({ ...PATIENCE, state: 'hidden' });
    return Number(/, (\S+) mm and \S+ degrees away/.exec(await said.textContent())?.[1]);
  }
  const nearer = await snap('end_lower', "'peg_g6.end_lower' coplanar with 'plate_g6.top'");
  assert.equal(nearer, 1);
  await moveBy(ann, [0, 0, 1]); // to where it was
  await until(async () => (await position(ann))[2] === 16, () => 'the peg is back above the plate');
  assert.equal(await snap('', "'peg_g6.journal' coaxial with 'plate_g6.bore'"), 5);
  await ann.getByText('their fit is Ø20 H7/g6').first().waitFor(PATIENCE);
  await ann.click('#tool_select');
  await release(ann);
});

/** A 3D mouse as WebHID has one: `push` tells the same report again and again, as it does while it is pushed. */
const withSpaceMouse = () => {
  const device = Object.assign(new EventTarget(), { vendorId: 0x256f, productName: 'SpaceMouse', opened: false, open: async () => void (device.opened = true) });
  const requestDevice = async ({ filters }) => (filters.some(({ vendorId }) => vendorId === device.vendorId) ? [device] : []);
  Object.defineProperty(navigator, 'hid', { value: Object.assign(new EventTarget(), { getDevices: async () => [], requestDevice }) });
  let telling;
  const tell = (reportId, counts) => device.opened && device.dispatchEvent(Object.assign(new Event('inputreport'), { reportId, data: new DataView(Int16Array.from(counts).buffer) }));
  window.push = (...report) => {
    clearInterval(telling);
    telling = setInterval(() => tell(...report), 20);
  };
  window.letGo = () => {
    clearInterval(telling);
    for (const id of [1, 2]) tell(id, [0, 0, 0]);
  };
};

test('a 3D mouse that the browser knows turns the view, and moves the part in hand', async () => {
  const cid = await openPage(session.browser, session.addresses.designer, { name: 'cid', first: withSpaceMouse });
  await whenListed(cid, 'parts', 'block');
  await cid.click('#do_help');
  await cid.click('#connect_space_mouse');
  await cid.getByText('SpaceMouse is connected').waitFor(PATIENCE);
  await cid.click('#keys button:has-text("Close")');
  const eye = () => cid.evaluate(() => document.getElementById('compass')?.toDataURL());
  const first = await eye();
  await cid.evaluate(() => window.push(2, [0, 0, -350]));
  await until(async () => (await eye()) !== first, () => 'the view turns');
  await cid.evaluate(() => window.letGo());
  await grab(cid, 'block');
  await cid.locator('#tool_move[aria-pressed="true"]').waitFor(PATIENCE);
  await lookAtItsFront(cid);
  const [from, front] = [await settled(cid), await eye()];
  await cid.evaluate(() => window.push(1, [350, 0, 0]));
  await until(async () => (await position(cid))[0] > from[0] + 1, () => 'the part goes to the right');
  await cid.evaluate(() => window.letGo());
  const to = await settled(cid);
  assert.ok(Math.hypot(to[1] - from[1], to[2] - from[2]) < 1e-3, `not to the right: from ${from} to ${to}`);
  assert.equal(await eye(), front, 'the view stays while a part is in hand');
  await release(cid);
  assert.deepEqual(cid.complaints, []);
  await cid.context().close();
});

test('a browser without WebHID has no button for a 3D mouse', async () => {
  const page = await openPage(session.browser, session.addresses.designer, { first: () => delete Navigator.prototype.hid });
  await page.locator('#join[open]').waitFor(PATIENCE);
  assert.equal(await page.evaluate(() => document.getElementById('connect_space_mouse').hidden), true);
  await page.context().close();
});

test('nothing was complained of', () => {
  assert.deepEqual([...ann.complaints, ...bob.complaints], []);
});
