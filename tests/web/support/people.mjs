// What a person does at the page, by what a person sees: names, labels, keys.
import assert from 'node:assert/strict';

export const PATIENCE = { timeout: 30_000 };

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

/** Waits until the chosen part stands still. */
export async function settled(page) {
  let last = await position(page);
  for (let same = 0; same < 3;) {
    await page.waitForTimeout(200);
    const now = await position(page);
    same = now.every((x, i) => x === last[i]) ? same + 1 : 0;
    last = now;
  }
  return last;
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
    setTimeout(() => fail(new Error(`${id} never said ${wanted}, but ${[...document.querySelectorAll(`#${id} > li`)].map((li) => li.getAttribute('aria-label') ?? li.textContent).join(' | ')}`)), 40_000);
    look();
  }), [list, text]);
}
