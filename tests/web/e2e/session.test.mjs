// Two people and a late one share a session through their browsers; the server, the gateway and the engine are the real ones.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { joinAs, openPage } from '../support/browser.mjs';
import { BrowserSession } from '../support/browser_session.mjs';
import { PATIENCE, choose, drawn, grab, moveBy, position, settled, settledElsewhere, until, whenListed } from '../support/people.mjs';
import { PEGS } from '../support/scenario.mjs';

const session = new BrowserSession();
let browser, addresses, ann, bob;

before(async () => {
  await session.serve(PEGS);
  ({ browser, addresses } = await session.show());
  [ann, bob] = await session.join('ann', 'bob');
}, { timeout: 240_000 });

test('two people join and see each other', async () => {
  await whenListed(ann, 'parts', 'peg_k6');
  await ann.locator('#people > li', { hasText: 'bob' }).waitFor(PATIENCE);
  await bob.locator('#people > li', { hasText: 'ann' }).waitFor(PATIENCE);
});

test('one moves a peg into its bore, both see the same classified clash', async () => {
  await grab(ann, 'peg_k6');
  await bob.locator('#labels > div', { hasText: 'peg_k6 – ann' }).waitFor(PATIENCE);
  const seen = [whenListed(ann, 'clashes', 'potential, plate_k6 × peg_k6'), whenListed(bob, 'clashes', 'potential, plate_k6 × peg_k6')];
  await moveBy(ann, [0, 0, -28]);
  const times = await Promise.all(seen);
  console.log(`  both browsers list the clash ${Math.abs(times[0] - times[1])} ms apart`);
  const end = await settled(ann);
  assert.ok(Math.abs(end[2] - -3) < 1e-3, `the peg is at z = ${end[2]}`);
  await choose(bob, 'peg_k6');
  assert.deepEqual(await settled(bob), end);
  const labels = await Promise.all([ann, bob].map((page) => page.locator('#clashes > li[aria-label*="plate_k6 × peg_k6"]').getAttribute('aria-label')));
  assert.equal(labels[0], labels[1]);
});

test('keys move in micrometres, undo takes the move back', async () => {
  await grab(bob, 'block');
  await bob.focus('#canvas');
  const [x, y, z] = await settled(bob);
  for (let i = 0; i < 3; ++i) await bob.keyboard.press('[');
  await bob.keyboard.press('ArrowRight');
  await bob.waitForFunction((text) => document.querySelector('#hand .pose')?.textContent?.startsWith(text), (x + 0.001).toFixed(4), PATIENCE);
  for (let i = 0; i < 4; ++i) await bob.keyboard.press(']');
  await bob.keyboard.press('PageUp');
  await bob.waitForFunction((text) => document.querySelector('#hand .pose')?.textContent?.includes(text), `${(z + 10).toFixed(4)} mm`, PATIENCE);
  await bob.keyboard.press('Shift+PageUp');
  await bob.waitForFunction(() => document.querySelector('#hand .pose')?.textContent?.includes('0.00, 0.00, 10.00°'), undefined, PATIENCE);
  await bob.keyboard.press('Control+z');
  await bob.waitForFunction((text) => !document.querySelector('#hand .pose')?.textContent?.includes(text), '0.00, 0.00, 10.00°', PATIENCE);
  assert.equal((await settled(bob))[1], y);
});

test('a handle drags the part', async () => {
  const from = await settled(bob);
  await bob.click('#tool_move');
  await bob.keyboard.press('z');
  await drawn(bob);
  const box = await bob.locator('#canvas').boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  // The upward handle begins above the middle of the part.
  await bob.mouse.move(x, y - 30);
  await bob.mouse.move(x, y - 50, { steps: 3 });
  await bob.mouse.down();
  await bob.mouse.move(x, y - 120, { steps: 6 });
  await bob.mouse.up();
  const to = await settledElsewhere(bob, from);
  assert.ok(to[2] > from[2] + 1, `dragged from ${from} to ${to}`);
  assert.ok(Math.abs(to[0] - from[0]) < 1e-3 && Math.abs(to[1] - from[1]) < 1e-3, `dragged from ${from} to ${to}`);
});

test('a part stops at a real contact', async () => {
  await grab(ann, 'peg_p6');
  const real = whenListed(ann, 'clashes', 'real, plate_p6 × peg_p6');
  const told = ann.getByText('Real clash: plate_p6 × peg_p6').first().waitFor(PATIENCE);
  await moveBy(ann, [0, 0, -28]);
  await Promise.all([real, told]);
  const [, , z] = await settled(ann);
  assert.ok(z > 9 && z < 25, `stopped at z = ${z}`);
});

test('two picked features are brought in line, and the part then moves along what freedom is left', async () => {
  await grab(bob, 'stray');
  await bob.click('#tool_align');
  await bob.locator('#align_bar option[value="journal"]').first().waitFor({ ...PATIENCE, state: 'attached' });
  await bob.getByLabel('Feature of the part in your hand').selectOption('journal');
  await bob.getByLabel('Other part', { exact: true }).selectOption({ label: 'plate_k6' });
  await bob.getByLabel('Feature of the other part').selectOption('bore');
  await bob.click('#align_bar button:has-text("Align")');
  await bob.waitForFunction(() => document.querySelector('#hand .pose')?.textContent?.startsWith('0.0000, 0.0000, '), undefined, PATIENCE);
  const from = await settled(bob);
  await moveBy(bob, [4, 3, 5]);
  const to = await settledElsewhere(bob, from);
  assert.ok(Math.abs(to[0]) < 1e-3 && Math.abs(to[1]) < 1e-3, `off the axis: ${to}`);
  assert.ok(Math.abs(to[2] - from[2] - 5) < 1e-3, `from ${from} to ${to}`);
  await bob.getByText('Kept:').waitFor(PATIENCE);
  await bob.click('#align_bar button:has-text("Free")');
  await bob.getByText('Kept:').waitFor({ ...PATIENCE, state: 'hidden' });
  await bob.click('#tool_select');
});

test('a feature picked in the picture and one from the list snap, and the part is dragged along the freedom that is left into its bore', async () => {
  await grab(bob, 'peg_g6');
  await bob.click('#tool_align');
  await bob.locator('#align_bar option[value="journal"]').first().waitFor({ ...PATIENCE, state: 'attached' });
  await bob.focus('#canvas');
  await bob.keyboard.press('z'); // the part fills the picture: its middle is the journal
  await drawn(bob);
  const box = await bob.locator('#canvas').boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await bob.mouse.click(x, y);
  assert.equal(await bob.getByLabel('Feature of the part in your hand').inputValue(), 'journal');
  await bob.getByLabel('Other part', { exact: true }).selectOption({ label: 'plate_g6' });
  await bob.getByLabel('Feature of the other part').selectOption('bore');
  await bob.click('#align_bar button:has-text("Snap")');
  await bob.getByText('Kept: journal coaxial with plate_g6 bore').waitFor(PATIENCE);
  const from = await settled(bob);
  assert.ok(Math.abs(from[0] - 160) < 1e-3 && Math.abs(from[1]) < 1e-3, `not on the axis: ${from}`);
  await bob.click('#tool_move');
  await bob.focus('#canvas');
  await bob.keyboard.press('z');
  await drawn(bob);
  await bob.mouse.move(x, y - 30);
  await bob.mouse.move(x, y - 50, { steps: 3 });
  await bob.mouse.down();
  await bob.mouse.move(x + 60, y + 20, { steps: 8 });
  await bob.mouse.up();
  const dragged = await settledElsewhere(bob, from);
  assert.ok(dragged[2] < from[2] - 1, `dragged from ${from} to ${dragged}`);
  const fake = whenListed(ann, 'clashes', 'fake, plate_g6 × peg_g6');
  await moveBy(bob, [3, -2, -dragged[2]]); // a hand that trembles
  await fake;
  const inside = await settled(bob);
  for (const at of [dragged, inside]) assert.ok(Math.abs(at[0] - 160) < 1e-3 && Math.abs(at[1]) < 1e-3, `off the axis: ${at}`);
  assert.ok(Math.abs(inside[2]) < 1e-3, `the peg is at z = ${inside[2]}, not in its bore`);
  await bob.click('#hand button:has-text("Release")');
});

test('heat shows how deep each point of a face is, by a field worked out beside the page, and says its scale', async () => {
  const legend = bob.locator('#heat_legend');
  await bob.locator('#clashes > li[aria-label*="plate_k6 × peg_k6"]').click();
  await bob.waitForFunction(() => document.getElementById('heat_legend')?.textContent?.includes('As they stand'), undefined, PATIENCE);
  const said = await legend.getAttribute('aria-label');
  assert.match(said, /fake from 0.0 µm to 40.7 µm, potential from 40.7 µm to [\d.]+ µm, real from [\d.]+ µm/);
  // What the page's own field finds on the faces is what the session says the clash is deep, as far as its points are apart.
  const deep = Number(/As they stand ([\d.]+) µm deep/.exec(said)?.[1]);
  const bracket = /deepest ([\d.]+) µm(?: … ([\d.]+) µm)?/.exec(said).slice(1).map(Number);
  assert.ok(deep >= bracket[0] - 2 && deep <= (bracket[1] || bracket[0]) + 0.2, said);
  assert.deepEqual(await legend.locator('.zone').allTextContents(), ['F', 'P', 'R']);
  await bob.click('#clash_filters button:has-text("Heat")');
  await legend.waitFor({ ...PATIENCE, state: 'hidden' });
  await bob.click('#clash_filters button:has-text("Heat")');
  await legend.waitFor(PATIENCE);
  await bob.locator('#clashes > li[aria-label*="plate_p6 × peg_p6"]').click();
  await bob.waitForFunction(() => document.getElementById('heat_legend')?.textContent?.includes('As they stand'), undefined, PATIENCE);
  await bob.click('#clash button[aria-label="Close"]');
});

test('two gathered parts are taken in hand together and move as one body', async () => {
  await choose(bob, 'stray');
  const stray = await settled(bob);
  await choose(bob, 'block');
  const block = await settled(bob);
  if ((await bob.textContent('#hand button.primary:visible')) === 'Release') await bob.click('#hand button:has-text("Release")');
  await bob.focus('#canvas');
  await bob.keyboard.press('m');
  await bob.locator('#parts > li', { hasText: 'stray' }).click({ modifiers: ['Control'] });
  await bob.click('#hand button:has-text("Grab 2 parts")');
  await bob.locator('#hand .quiet', { hasText: 'in your hand' }).waitFor(PATIENCE);
  await ann.locator('#people > li', { hasText: 'holds 2' }).filter({ hasText: 'bob' }).waitFor(PATIENCE);
  await moveBy(bob, [0, 0, 4]);
  const moved = await settled(bob);
  assert.ok(Math.abs(moved[2] - block[2] - 4) < 1e-3, `block from ${block} to ${moved}`);
  await choose(ann, 'stray');
  const along = await settled(ann);
  assert.ok(along.every((x, i) => Math.abs(x - stray[i] - (i === 2 ? 4 : 0)) < 1e-3), `stray from ${stray} to ${along}`);
  await bob.click('#hand button:has-text("Release 2 parts")');
  await bob.locator('#hand .quiet', { hasText: 'free' }).waitFor(PATIENCE);
  await bob.keyboard.press('m');
  await bob.locator('#parts > li', { hasText: 'stray' }).click({ modifiers: ['Control'] });
  assert.equal(await bob.locator('#parts > li.gathered').count(), 0);
});

test('one looks along with the other', async () => {
  await bob.getByLabel('Look along with ann').click(PATIENCE);
  await ann.focus('#canvas');
  await ann.keyboard.press('1');
  const places = () => Promise.all([ann, bob].map((page) => page.locator('#labels > div', { hasText: 'peg_k6' }).evaluate((word) => word.style.transform.match(/-?[\d.]+/g)?.slice(0, 2).map(Number) ?? [])));
  let last;
  await until(async () => {
    last = await places();
    return Math.hypot(last[0][0] - last[1][0], last[0][1] - last[1][1]) < 2;
  }, () => `the same word at one place, not at ${last}`);
  await bob.keyboard.press('0'); // from where one likes: no longer along with her
  await bob.getByLabel('Stop looking along with ann').click(PATIENCE);
});

test('a fit is set and dropped in one browser, and both see the clash judged anew; a pair is left out', async () => {
  const classed = (of) => Promise.all([ann, bob].map((page) => whenListed(page, 'clashes', `${of}, plate_k6 × peg_k6`)));
  await bob.click('#tab_rules');
  await bob.getByLabel('Part', { exact: true }).selectOption({ label: 'plate_k6' });
  await bob.getByLabel('Feature', { exact: true }).selectOption('bore');
  await bob.getByLabel('Second part', { exact: true }).selectOption({ label: 'peg_k6' });
  await bob.getByLabel('Feature of the second part').selectOption('journal');
  await bob.getByLabel('Value', { exact: true }).fill('H7/nonsense');
  await bob.click('#rules_panel button:has-text("Set")');
  await bob.locator('#said .bad').first().waitFor(PATIENCE); // a sentence, and nothing has changed
  await bob.locator('#rules_panel li', { hasText: 'Nothing was changed' }).waitFor(PATIENCE);
  await bob.getByLabel('Value', { exact: true }).fill('Ø20 H7/p6');
  const real = classed('real');
  await bob.click('#rules_panel button:has-text("Set")');
  await bob.locator('#rules_panel li', { hasText: 'plate_k6.bore × peg_k6.journal Ø20 H7/p6' }).getByText('bob', { exact: true }).waitFor(PATIENCE);
  await real;
  await bob.getByLabel('Value', { exact: true }).fill('Ø20 H7/k6');
  const potential = classed('potential');
  await bob.click('#rules_panel button:has-text("Set")');
  await potential;
  await bob.getByLabel('Kind of rule').selectOption('exclude');
  await bob.getByLabel('Value', { exact: true }).fill('pressed in on purpose');
  await bob.click('#rules_panel button:has-text("Set")');
  const out = bob.locator('#rules_panel li', { hasText: 'plate_k6 × peg_k6 left out: pressed in on purpose' });
  await out.waitFor(PATIENCE);
  await ann.getByText('bob leaves out plate_k6 × peg_k6').first().waitFor(PATIENCE);
  await out.getByRole('button').click();
  await out.waitFor({ ...PATIENCE, state: 'hidden' });
  await bob.click('#tab_clashes');
});

test('a review in one browser shows in the other', async () => {
  await bob.locator('#clashes > li[aria-label*="plate_k6 × peg_k6"]').click();
  await bob.getByLabel('Review status').selectOption('approved');
  await bob.getByLabel('Comment').fill('pressed in by <b>hand</b>');
  await bob.click('#clash button:has-text("Save")');
  await ann.locator('#clashes > li[aria-label*="plate_k6 × peg_k6"]', { hasText: 'approved' }).waitFor(PATIENCE);
  await ann.locator('#clashes > li[aria-label*="plate_k6 × peg_k6"]').click();
  await ann.locator('#clash .thread > li p', { hasText: 'pressed in by <b>hand</b>' }).waitFor(PATIENCE);
  assert.equal(await ann.locator('#clash .thread b').count(), 0);
  await ann.getByText('bob: approved').waitFor(PATIENCE);
  await ann.click('#clash button[aria-label="Close"]');
  await bob.click('#clash button[aria-label="Close"]');
});

test('who comes late sees all; a name is text, whatever it says', async () => {
  const late = await openPage(browser, addresses.designer);
  await joinAs(late, '<img src=x onerror=hacked=1>');
  await whenListed(late, 'clashes', 'approved');
  await whenListed(late, 'clashes', 'real, plate_p6 × peg_p6');
  await choose(late, 'peg_p6');
  await choose(ann, 'peg_p6');
  assert.deepEqual(await position(late), await position(ann));
  await ann.locator('#people > li', { hasText: '<img src=x onerror=hacked=1>' }).waitFor(PATIENCE);
  for (const page of [ann, bob, late]) {
    assert.equal(await page.evaluate(() => 'hacked' in window), false);
    assert.equal(await page.locator('#people img, #labels img, #said img').count(), 0);
  }
  await late.context().close();
});

test('a line that breaks in mid-drag leaves the part in hand, and the page goes on with it', async () => {
  const carl = await openPage(browser, addresses.designer, { name: 'carl', first: () => {
    const window = /** @type {any} */ (globalThis);
    const Line = window.WebSocket;
    window.WebSocket = class extends Line {
      constructor(...of) {
        super(...of);
        window.lines = (window.lines ?? 0) + 1;
        window.line = this;
      }
    };
  } });
  await grab(carl, 'block');
  const [x, y, z] = await settled(carl);
  await moveBy(carl, [0, 0, 300]);
  await carl.waitForFunction((from) => Number(/^\S+, \S+, (\S+) mm/.exec(document.querySelector('#hand .pose')?.textContent ?? '')?.[1]) > from, z, PATIENCE);
  await carl.evaluate(() => /** @type {any} */ (globalThis).line.close(4000, 'as one that is silent'));
  await carl.waitForFunction(() => /** @type {any} */ (globalThis).lines === 2, undefined, PATIENCE);
  await carl.locator('#status_server', { hasText: 'You are carl' }).waitFor(PATIENCE);
  await carl.locator('#hand .quiet', { hasText: 'in your hand' }).waitFor(PATIENCE);
  const from = await settled(carl);
  await moveBy(carl, [0, 0, 5]);
  const to = await settledElsewhere(carl, from);
  assert.ok(to[2] > from[2] + 4.9 && Math.abs(to[0] - x) + Math.abs(to[1] - y) < 1e-3, `from ${from} to ${to}`);
  await moveBy(carl, [0, 0, z - to[2]]);
  await settledElsewhere(carl, to);
  await carl.context().close();
});

test('a reload in mid-drag frees the part', async () => {
  await choose(ann, 'peg_k6'); // still in her hand
  const from = await position(ann);
  await moveBy(ann, [0, 0, 300]);
  await ann.waitForFunction((z) => Number(/^\S+, \S+, (\S+) mm/.exec(document.querySelector('#hand .pose')?.textContent ?? '')?.[1]) > z, from[2], PATIENCE);
  await ann.reload();
  await bob.waitForFunction(() => !document.querySelector('#parts')?.textContent?.includes('ann'), undefined, PATIENCE);
  await choose(bob, 'peg_k6');
  await bob.locator('#hand .quiet', { hasText: 'free' }).waitFor(PATIENCE);
  await joinAs(ann, 'ann');
});

test('with keys alone: find a part, take it, move it, let it go', async () => {
  const labelled = () => bob.evaluate(() => [...document.querySelectorAll('button, input, select, textarea, [role=listbox], canvas[tabindex]')]
    .filter((control) => control.checkVisibility() && !control.getAttribute('aria-label') && !control.getAttribute('aria-labelledby')
      && !control.textContent?.trim() && /** @type {any} */ (control).labels?.length !== 1).map((control) => control.outerHTML.slice(0, 120)));
  assert.deepEqual(await labelled(), []);
  await bob.reload();
  await joinAs(bob, 'bob');
  for (let tabs = 0; tabs < 60 && (await bob.evaluate(() => document.activeElement?.id)) !== 'parts_search'; ++tabs) await bob.keyboard.press('Tab');
  await bob.keyboard.type('block');
  await bob.keyboard.press('Tab');
  await bob.keyboard.press('Tab');
  assert.equal(await bob.evaluate(() => document.activeElement?.id), 'parts');
  await bob.keyboard.press('ArrowDown');
  await bob.waitForFunction(() => document.querySelector('#hand strong')?.textContent === 'block', undefined, PATIENCE);
  await bob.keyboard.press('g');
  await bob.locator('#hand .quiet', { hasText: 'in your hand' }).waitFor(PATIENCE);
  const [x] = await settled(bob);
  await bob.keyboard.press('Tab');
  await bob.keyboard.press('ArrowRight');
  await bob.waitForFunction((text) => document.querySelector('#hand .pose')?.textContent?.startsWith(text), (x + 1).toFixed(4), PATIENCE);
  await bob.keyboard.press('g');
  await bob.locator('#hand .quiet', { hasText: 'free' }).waitFor(PATIENCE);
  await bob.fill('#parts_search', '');
});

test('nothing is cut off or covers another at 1280 × 720', async () => {
  for (const page of [ann, bob]) {
    const wrong = await page.evaluate(() => {
      const bad = [];
      const controls = [...document.querySelectorAll('.bar > *, .bar button, .bar select, .status > span, .tabs button, .panel h2, #hand button, #hand input, #heat_legend, #compass')].filter((c) => c.checkVisibility() && c.getBoundingClientRect().width > 0);
      for (const control of controls) {
        const { left, right, top, bottom } = control.getBoundingClientRect();
        if (left < 0 || top < 0 || right > innerWidth || bottom > innerHeight) bad.push(`out of view: ${control.outerHTML.slice(0, 80)}`);
        for (const other of controls) {
          if (other === control || other.contains(control) || control.contains(other)) continue;
          const o = other.getBoundingClientRect();
          if (Math.min(right, o.right) - Math.max(left, o.left) > 1 && Math.min(bottom, o.bottom) - Math.max(top, o.top) > 1) bad.push(`covers: ${control.outerHTML.slice(0, 60)} and ${other.outerHTML.slice(0, 60)}`);
        }
      }
      if (document.documentElement.scrollWidth > innerWidth || document.documentElement.scrollHeight > innerHeight) bad.push('the page scrolls');
      return bad;
    });
    assert.deepEqual(wrong, []);
  }
});

test('the read-only address looks on', async () => {
  const guest = await openPage(browser, addresses.observer);
  await whenListed(guest, 'parts', 'peg_k6');
  await choose(guest, 'peg_k6');
  assert.equal(await guest.locator('#hand button:not(.look):visible').count(), 0);
  assert.equal(await guest.locator('#join[open]').count(), 0);
  assert.equal(await guest.textContent('#line_text'), 'Looking on');
  await guest.context().close();
});

test('a server that goes and comes back, a gateway that goes and comes back', async () => {
  await session.stop(session.server);
  await ann.locator('#banner', { hasText: 'waits for the server' }).waitFor(PATIENCE);
  await session.serve(PEGS);
  await ann.locator('#banner').waitFor({ ...PATIENCE, state: 'hidden' });
  await ann.locator('#status_server', { hasText: 'You are ann' }).waitFor(PATIENCE);
  await session.stop(session.gateway);
  await ann.locator('#line_state[data-state="waiting"]').waitFor(PATIENCE);
  await session.open(undefined, new URL(addresses.designer).port);
  await ann.locator('#line_state[data-state="open"]').waitFor(PATIENCE);
  await ann.locator('#status_server', { hasText: 'You are ann' }).waitFor(PATIENCE);
  await grab(ann, 'block');
  // What the browser itself says of a line that breaks is no complaint of the page.
  for (const page of [ann, bob]) page.complaints = page.complaints.filter((text) => !/WebSocket|ERR_CONNECTION/.test(text));
});

test('nothing was complained of', () => {
  assert.deepEqual([...ann.complaints, ...bob.complaints], []);
});
