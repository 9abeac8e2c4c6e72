// What a person does at the page, by what a person sees: names, labels, keys.
import assert from 'node:assert/strict';

export const PATIENCE = { timeout: 60_000 }; // on a machine that does other things as well

export const row = (page, list, text) => page.locator(`#${list} > li[aria-label*="${text}"], #${list} > li`).filter({ hasText: text }).first();

/** Chooses a part in the list. */
export async function choose(page, part) {
  await page.locator('#parts > li').filter({ has: page.getByText(part, { exact: true }) }).click(PATIENCE);
  await page.waitForFunction((name) => document.querySelector('#hand strong')?.textContent === name, part, PATIENCE);
}

export async function grab(page, part) {
  await choose(page, part);
  await page.click('#hand button:has-text("Grab")');
  await page.waitForFunction(() => document.querySelector('#hand .quiet')?.textContent === 'in your hand', undefined, PATIENCE);
}

/** By numbers, mm. */
export async function moveBy(page, [x, y, z]) {
  for (const [axis, value] of Object.entries({ X: x, Y: y, Z: z })) await page.getByLabel(`along or about ${axis}`).fill(`${value}`);
  await page.click('#hand button:has-text("Move by")');
}

/** Where the chosen part is shown to be, mm. */
export async function position(page) {
  const text = await page.textContent('#hand .pose');
  const numbers = /^(\S+), (\S+), (\S+) mm/.exec(text ?? '');
  assert.ok(numbers, `no pose is shown: ${text}`);
  return numbers.slice(1).map(Number);
}

const TICKS_AT_REST = 60; // a second of the server, however busy the machine is

/** Waits until the server has gone on by so many ticks and the page has heard of it. @param {import('playwright-core').Page} page @param {number} ticks */
export async function ticksPass(page, ticks) {
  const from = await page.evaluate(() => Number(/\d+/.exec(document.getElementById('status_tick')?.textContent ?? '')?.[0] ?? 0));
  await page.waitForFunction((to) => Number(/\d+/.exec(document.getElementById('status_tick')?.textContent ?? '')?.[0] ?? 0) >= to, from + ticks, PATIENCE);
}

/** Waits until the chosen part has stood still for a second of the server. */
export async function settled(page) {
  let last = await position(page);
  for (;;) {
    await ticksPass(page, TICKS_AT_REST);
    const now = await position(page);
    if (now.every((x, i) => x === last[i])) return now;
    last = now;
  }
}

/** Where the chosen part stands once it has left `from`, and rests. */
export async function settledElsewhere(page, from) {
  await page.waitForFunction((before) => {
    const now = /^(\S+), (\S+), (\S+) mm/.exec(document.querySelector('#hand .pose')?.textContent ?? '')?.slice(1).map(Number);
    return now?.some((x, i) => x !== before[i]);
  }, from, PATIENCE);
  return settled(page);
}

/** Waits until what was done is drawn: flights of the eye are at once here (reduced motion), in the next picture. */
export function drawn(page) {
  return page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(() => done(undefined))))));
}

/** Asks again until it is so. @param {() => Promise<boolean>} isSo @param {() => string} what is waited for, as it stands */
export async function until(isSo, what) {
  const end = Date.now() + PATIENCE.timeout;
  while (!(await isSo())) {
    assert.ok(Date.now() < end, `never: ${what()}`);
    await new Promise((done) => setTimeout(done, 100));
  }
}

/** When a row of this list first says this, by the clock of the machine. */
export function whenListed(page, list, text) {
  return page.evaluate(([id, wanted]) => new Promise((done, fail) => {
    const look = () => {
      if (![...document.querySelectorAll(`#${id} > li`)].some((li) => li.getAttribute('aria-label')?.includes(wanted))) return;
      watch.disconnect();
      done(Date.now());
    };
    const watch = new MutationObserver(look);
    watch.observe(document.getElementById(id), { childList: true, subtree: true, attributes: true });
    setTimeout(() => fail(new Error(`${id} never said ${wanted}, but ${[...document.querySelectorAll(`#${id} > li`)].map((li) => li.getAttribute('aria-label') ?? li.textContent).join(' | ')}`)), 60_000);
    look();
  }), [list, text]);
}
