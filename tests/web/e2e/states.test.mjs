// What goes wrong is told with what to do about it, and a screen of any size reaches everything.
import assert from 'node:assert/strict';
import { rmSync } from 'node:fs';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { joinAs, openPage } from '../support/browser.mjs';
import { BrowserSession } from '../support/browser_session.mjs';
import { coveredWords, cutOff, paleTexts, skippedHeadings, smallTargets } from '../support/looks.mjs';
import { PATIENCE, choose, drawn, grab, moveBy, settled, until, whenListed } from '../support/people.mjs';
import { PEGS } from '../support/scenario.mjs';

const session = new BrowserSession('states');
let browser, addresses, ann;

before(async () => {
  await session.serve(PEGS, ['--log', join(session.folder, 'logs')]);
  ({ browser, addresses } = await session.show());
  [ann] = await session.join('ann');
  await whenListed(ann, 'parts', 'peg_k6');
  await grab(ann, 'peg_p6');
  const real = whenListed(ann, 'clashes', 'real, plate_p6 × peg_p6');
  await moveBy(ann, [0, 0, -28]);
  await real;
  await ann.click('#hand button:has-text("Release")');
}, { timeout: 240_000 });

const trouble = (page, kind) => page.locator(`#banner[data-trouble="${kind}"]`);

test('at 1440, 1280, 1024 and 800 pixels nothing is cut off, covered or out of reach, in both themes', async () => {
  for (const scheme of ['dark', 'light']) {
    const page = await openPage(browser, addresses.designer, { name: `tom ${scheme}`, scheme });
    await whenListed(page, 'clashes', 'real, plate_p6 × peg_p6');
    await choose(page, 'block');
    await page.locator('#clashes > li').first().click();
    for (const [width, height] of [[1440, 900], [1280, 720], [1024, 768], [800, 600]]) {
      await page.setViewportSize({ width, height });
      for (const side of ['left', 'right']) {
        const place = page.locator(`#place_${side}`);
        if (await place.isVisible()) await place.click();
        else if (side === 'left') assert.ok(await page.locator('#parts').isVisible() && await page.locator('#clashes').isVisible());
        await drawn(page);
        assert.deepEqual(await cutOff(page), [], `${scheme} ${width} × ${height}, ${side}`);
        assert.deepEqual(await skippedHeadings(page), [], `${width} × ${height}, ${side}`);
        assert.ok(await page.locator(side === 'left' ? '#parts' : '#clashes').isVisible(), `${side} at ${width}`);
      }
    }
    await page.context().close();
  }
});

test('with little room the bar is one row, and the keyboard reaches what stands behind its first button', async () => {
  for (const [width, height, touch] of /** @type {const} */ ([[800, 600, false], [1024, 768, true], [800, 600, true], [390, 844, true]])) {
    const size = `${width} pixels${touch ? ', by touch' : ''}`;
    const page = await openPage(browser, addresses.designer, { name: `bo ${size}`, touch, view: { width, height } });
    await whenListed(page, 'parts', 'block');
    const bar = () => page.evaluate(() => {
      const { clientHeight, clientWidth, scrollWidth } = document.querySelector('header.bar');
      return { rows: clientHeight < 60 ? 1 : 2, beside: scrollWidth - clientWidth };
    });
    assert.deepEqual(await bar(), { rows: 1, beside: 0 }, size);
    await page.locator('#more_tools').focus();
    await page.keyboard.press('Enter');
    assert.deepEqual(await cutOff(page), [], size);
    if (touch) assert.deepEqual(await smallTargets(page), [], size);
    const all = await page.evaluate(() => [...document.querySelectorAll('.bar button:not([hidden], :disabled), .bar select')].map(({ id }) => id));
    const reached = [await page.evaluate(() => (document.querySelector('.bar button').focus(), document.activeElement.id))];
    while (reached.length < all.length) {
      await page.keyboard.press('Tab');
      reached.push(await page.evaluate(() => document.activeElement.id));
    }
    assert.deepEqual(reached, all, size);
    await page.locator('#more_tools').press('Enter');
    assert.deepEqual(await bar(), { rows: 1, beside: 0 }, size);
    await page.context().close();
  }
});

test('text stands out from its ground by 4.5 or more, in both themes', async () => {
  for (const scheme of ['dark', 'light']) {
    const page = await openPage(browser, addresses.designer, { name: `cid ${scheme}`, scheme });
    await whenListed(page, 'clashes', 'real, plate_p6 × peg_p6');
    await choose(page, 'block');
    await page.click('#clash_filters .chip >> nth=2');
    await page.locator('#clashes > li').first().click();
    assert.ok(await page.locator('#heat_legend .zone').first().isVisible(), 'its letters are among what is looked at');
    for (const tab of ['clashes', 'rules', 'statistics']) {
      await page.click(`#tab_${tab}`);
      await drawn(page);
      assert.deepEqual(await paleTexts(page), [], `${scheme}, ${tab}`);
    }
    await page.context().close();
  }
});

test('words of the view, as why a part stops, lie under nothing at any size', async () => {
  const page = await openPage(browser, addresses.designer, { name: 'fay' });
  await grab(page, 'peg_p6');
  await page.locator('#clashes > li', { hasText: 'plate_p6 × peg_p6' }).click();
  await page.locator('#heat_legend:not([hidden])').waitFor(PATIENCE);
  for (const [width, height] of [[1440, 900], [1024, 768], [800, 600], [390, 844]]) {
    await page.setViewportSize({ width, height });
    await page.getByLabel('along or about Z').evaluate((field) => (/** @type {HTMLInputElement} */ (field).value = '-28'));
    await page.locator('#hand button:has-text("Move by")').evaluate((button) => /** @type {HTMLElement} */ (button).click()); // also where numbers have no room
    await page.locator('#labels > div', { hasText: 'Stop: ' }).waitFor(PATIENCE);
    await page.focus('#canvas');
    // Near, so that words come to stand at the edges and corners, where bars, the legend and what was said are.
    for (const key of ['0', '2', 'z', '+', '+']) {
      await page.keyboard.press(key);
      await drawn(page);
      // What has just been moved or told finds its place with one of the next pictures; what is told meanwhile is another question.
      let covered = await coveredWords(page);
      for (let i = 0; i < 20 && covered.length > 0; ++i) {
        await drawn(page);
        covered = await coveredWords(page);
      }
      assert.deepEqual(covered, [], `${width} × ${height}, ${key}`);
    }
  }
  await page.locator('#hand button:has-text("Release")').click();
  await page.context().close();
});

test('at 390 pixels one looks on and reviews by touch, with targets of 44 pixels', async () => {
  const page = await openPage(browser, addresses.designer, { name: 'eve', touch: true, view: { width: 390, height: 844 } });
  await whenListed(page, 'clashes', 'real, plate_p6 × peg_p6');
  assert.deepEqual(await smallTargets(page), []);
  await page.locator('#clashes > li', { hasText: 'plate_p6 × peg_p6' }).tap();
  await page.getByLabel('Review status').selectOption('reviewed');
  await page.getByLabel('Comment').fill('seen on the way');
  await page.locator('#clash button:has-text("Save")').scrollIntoViewIfNeeded();
  assert.deepEqual(await smallTargets(page), []);
  await page.locator('#clash button:has-text("Save")').tap();
  await ann.locator('#clashes > li', { hasText: 'reviewed' }).waitFor(PATIENCE);
  await page.locator('#place_left').tap();
  await page.locator('#parts > li', { hasText: 'block' }).first().tap();
  await page.locator('#hand strong', { hasText: 'block' }).waitFor(PATIENCE);
  await page.locator('#hand button:has-text("Grab")').tap();
  await page.locator('#hand .quiet', { hasText: 'in your hand' }).waitFor(PATIENCE);
  assert.deepEqual(await smallTargets(page), []);
  const [view, hand] = await Promise.all(['.view', '#hand'].map((part) => page.locator(part).boundingBox()));
  assert.ok(view && hand && hand.y - view.y > 100, 'beside a list, the bar of the hand leaves room for the view and what it says');
  await page.locator('#place_none').tap();
  assert.ok(await page.getByLabel('along or about Z').isVisible());
  assert.deepEqual(await smallTargets(page), []);
  assert.deepEqual(await cutOff(page), []);
  await page.locator('#hand button:has-text("Release")').tap();
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert.ok(wide <= 0, `the page is ${wide} pixels too wide`);
  await page.context().close();
});

test('an address without a token, and one with a wrong token, say what to do', async () => {
  const without = await openPage(browser, addresses.designer.replace(/#.*/, ''));
  await trouble(without, 'no_token').getByText('Open the whole address').waitFor(PATIENCE);
  const wrong = await openPage(browser, addresses.designer.replace(/token=.*/, 'token=wrong'));
  await trouble(wrong, 'token').getByText('wrong or has expired').waitFor(PATIENCE);
  assert.equal(await wrong.textContent('#line_text'), 'No access');
  await wrong.waitForTimeout(2500); // in which nothing is to happen
  assert.ok(wrong.complaints.filter((text) => /401/.test(text)).length <= 3, 'a token that is wrong is not tried over and over');
  for (const page of [without, wrong]) await page.context().close();
});

test('a gateway that is gone: seconds are counted down, and one can try now', async () => {
  const { port } = new URL(addresses.designer);
  await session.stop(session.gateway);
  await trouble(ann, 'gateway').waitFor(PATIENCE);
  const left = async () => Number(/Trying again in (\d+) s/.exec(await ann.textContent('#banner'))?.[1] ?? 0);
  await ann.waitForFunction(() => /in [4-8] s/.test(document.getElementById('banner')?.textContent ?? ''), undefined, PATIENCE);
  const first = await left();
  await ann.waitForFunction((n) => Number(/in (\d+) s/.exec(document.getElementById('banner')?.textContent ?? '')?.[1]) <= n - 2, first, PATIENCE);
  await session.open(undefined, port);
  await ann.click('#banner button:has-text("Try now")');
  await ann.locator('#status_server', { hasText: 'You are ann' }).waitFor(PATIENCE);
  assert.ok(await ann.locator('#banner').isHidden());
  // Started anew with other tokens, this address is of yesterday.
  await session.stop(session.gateway);
  rmSync(join(session.folder, 'tokens'));
  const fresh = await session.open(undefined, port);
  await trouble(ann, 'token').getByText('Ask who runs the session').waitFor(PATIENCE);
  await ann.goto('about:blank');
  await ann.goto(fresh.designer);
  await joinAs(ann, 'ann');
});

test('a server that is killed: one that stands by takes over, and the page says so', async () => {
  const standby = await session.standBy();
  session.server.removeAllListeners('exit');
  session.server.kill('SIGKILL');
  await ann.getByText('one leads it again').first().waitFor(PATIENCE);
  assert.ok(await ann.locator('#banner').isHidden());
  await ann.locator('#status_server', { hasText: 'You are ann' }).waitFor(PATIENCE);
  await grab(ann, 'block');
  await settled(ann);
  // Nobody stands by for the second one.
  standby.removeAllListeners('exit');
  standby.kill('SIGKILL');
  await trouble(ann, 'take_over').getByText('It has not said that it ends').waitFor(PATIENCE);
  const gone = async () => Number(/Since (\d+) s/.exec(await ann.textContent('#banner'))?.[1]);
  const first = await gone();
  await until(async () => (await gone()) >= first + 2, () => `two seconds after ${first} s are counted`);
  await session.serve(PEGS);
  await ann.locator('#status_server', { hasText: 'You are ann' }).waitFor(PATIENCE);
});

test('a session that ends in good order is said to have ended', async () => {
  await session.stop(session.server);
  await trouble(ann, 'take_over').getByText('It has said that it ends').waitFor(PATIENCE);
  await trouble(ann, 'ended').getByText('mortise web --replay').waitFor(PATIENCE);
  assert.equal(await ann.textContent('#line_text'), 'No server');
});
