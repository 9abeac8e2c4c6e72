// What a page looks like, measured: what is cut off, how texts stand out from their ground, how large what is touched is.
import assert from 'node:assert/strict';
import { drawn } from './people.mjs';

/** Controls and headings that are out of the window or lie on each other. @param {import('playwright-core').Page} page @returns {Promise<string[]>} */
export function cutOff(page) {
  return page.evaluate(() => {
    const bad = [];
    const controls = [...document.querySelectorAll('.bar > *, .bar button, .bar select, .places button, .tabs button, .panel h2, #clash_filters > *, #hand button, #hand input, #hand select, #heat_legend, #compass, .status > span')]
      .filter((c) => c.checkVisibility() && c.getBoundingClientRect().width > 0);
    for (const control of controls) {
      const { left, right, top, bottom } = control.getBoundingClientRect();
      if (left < -1 || top < -1 || right > innerWidth + 1 || bottom > innerHeight + 1) bad.push(`out of view: ${control.outerHTML.slice(0, 80)}`);
      for (const other of controls) {
        if (other === control || other.contains(control) || control.contains(other)) continue;
        const o = other.getBoundingClientRect();
        if (Math.min(right, o.right) - Math.max(left, o.left) > 1 && Math.min(bottom, o.bottom) - Math.max(top, o.top) > 1) bad.push(`covers: ${control.outerHTML.slice(0, 60)} and ${other.outerHTML.slice(0, 60)}`);
      }
    }
    if (document.documentElement.scrollWidth > innerWidth || document.documentElement.scrollHeight > innerHeight) bad.push('the page scrolls');
    return bad;
  });
}

/** Headings that skip a level, which a screen reader takes for a gap. @param {import('playwright-core').Page} page @returns {Promise<string[]>} */
export function skippedHeadings(page) {
  return page.evaluate(() => [...document.querySelectorAll('h1, h2, h3')].filter((h) => h.checkVisibility())
    .filter((h, i, all) => Number(h.tagName[1]) > 1 + Number(all[i - 1]?.tagName[1] ?? 0)).map((h) => `${h.tagName} ${h.textContent}`));
}

/** Texts whose contrast with what is behind them is below 4.5 (WCAG 2.2, 1.4.3). What is disabled is exempt. @param {import('playwright-core').Page} page @returns {Promise<string[]>} */
export function paleTexts(page) {
  return page.evaluate(() => {
    const numbers = (/** @type {string} */ colour) => colour.match(/[\d.]+/g)?.map(Number) ?? [0, 0, 0, 0];
    const over = (top, under) => {
      const a = top[3] ?? 1;
      return [0, 1, 2].map((i) => top[i] * a + under[i] * (1 - a));
    };
    const luminance = (c) => [0, 1, 2].reduce((sum, i) => {
      const s = c[i] / 255;
      return sum + [0.2126, 0.7152, 0.0722][i] * (s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4);
    }, 0);
    /** All colours that may lie behind its text: a gradient has several, and stripes lie over others. */
    const grounds = (element) => {
      const { backgroundColor, backgroundImage } = getComputedStyle(element);
      const own = numbers(backgroundColor);
      const image = (backgroundImage.match(/rgba?\([^)]*\)/g) ?? []).map(numbers);
      const isOpaque = (colour) => (colour[3] ?? 1) === 1;
      let under = image.filter(isOpaque);
      if (under.length === 0) under = isOpaque(own) || !element.parentElement ? [own] : grounds(element.parentElement).map((back) => over(own, back));
      return [...under, ...image.filter((colour) => !isOpaque(colour)).flatMap((stripe) => under.map((back) => over(stripe, back)))];
    };
    const faded = (element) => (element ? Number(getComputedStyle(element).opacity) * faded(element.parentElement) : 1);
    const bad = new Set();
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
      const element = node.parentElement;
      if (!node.textContent.trim() || !element.checkVisibility() || element.closest('svg, [disabled], script')) continue;
      const alpha = faded(element);
      const own = numbers(getComputedStyle(element).color);
      const ratio = Math.min(...grounds(element).map((back) => {
        const front = over([own[0], own[1], own[2], (own[3] ?? 1) * alpha], back);
        const [light, dark] = [luminance(front), luminance(back)].sort((x, y) => y - x);
        return (light + 0.05) / (dark + 0.05);
      }));
      if (ratio < 4.5) bad.add(`${ratio.toFixed(2)}: ${element.className || element.tagName} "${node.textContent.trim().slice(0, 30)}"`);
    }
    return [...bad];
  });
}

/** Words of the view that lie under something, on each other or out of it. @param {import('playwright-core').Page} page @returns {Promise<string[]>} */
export function coveredWords(page) {
  return page.evaluate(() => {
    const view = document.querySelector('.view');
    const words = [...document.querySelectorAll('#labels > div')].filter((word) => word.checkVisibility());
    const others = [...view.children].filter((other) => !['canvas', 'labels'].includes(other.id) && other.checkVisibility());
    const frame = view.getBoundingClientRect();
    return words.flatMap((word, i) => {
      const { left, right, top, bottom } = word.getBoundingClientRect();
      const out = left < frame.left - 1 || right > frame.right + 1 || top < frame.top - 1 || bottom > frame.bottom + 1 ? ['out of the view'] : [];
      const under = [...others, ...words.slice(0, i)].filter((other) => {
        const o = other.getBoundingClientRect();
        return Math.min(right, o.right) - Math.max(left, o.left) > 1 && Math.min(bottom, o.bottom) - Math.max(top, o.top) > 1;
      }).map((other) => other.id || other.className);
      return [...out, ...under].map((what) => `${word.textContent}: ${what}`);
    });
  });
}

/** What is touched and is smaller than 44 pixels, as far as it is in sight. @param {import('playwright-core').Page} page @returns {Promise<string[]>} */
export function smallTargets(page) {
  return page.evaluate(() => [...document.querySelectorAll('button, select, input, textarea, .list > li')]
    .filter((c) => c.checkVisibility() && c.getBoundingClientRect().width > 0)
    .map((c) => ({ c, box: c.getBoundingClientRect() }))
    .filter(({ box }) => box.width < 43.5 || box.height < 43.5)
    .map(({ c, box }) => `${box.width.toFixed(0)} × ${box.height.toFixed(0)}: ${c.outerHTML.slice(0, 80)}`));
}

/**
 * Of a report: what sticks out of the window or of its cell, heads that do not stand over their columns, and boxes that scroll without a word or out of
 * reach of the keyboard.
 * @param {import('playwright-core').Page} page @returns {Promise<string[]>}
 */
export function outOfReport(page) {
  return page.evaluate(() => {
    const bad = [];
    const name = (element) => `${element.tagName} ${element.textContent.trim().slice(0, 40)}`;
    for (const element of document.querySelectorAll('body *:not(.wide *, figure *, script)')) {
      if (element.checkVisibility() && element.getBoundingClientRect().right > innerWidth + 1) bad.push(`out of the window: ${name(element)}`);
    }
    for (const cell of document.querySelectorAll('th, td')) if (cell.clientWidth < 24 || cell.scrollWidth > cell.clientWidth + 1) bad.push(`out of its cell: ${name(cell)}`);
    for (const table of document.querySelectorAll('table')) {
      const first = table.querySelector('tbody tr:not([hidden])')?.children ?? [];
      table.querySelectorAll('thead th').forEach((head, i) => {
        if (first[i] && getComputedStyle(head).textAlign !== getComputedStyle(first[i]).textAlign) bad.push(`not over its column: ${name(head)}`);
      });
    }
    for (const box of document.querySelectorAll('.wide, figure')) {
      if (box.scrollWidth <= box.clientWidth + 1 || getComputedStyle(box).overflowX === 'visible') continue;
      if (getComputedStyle(box, '::before').content === 'none' || box.tabIndex !== 0) bad.push(`scrolls and does not say so: ${name(box)}`);
    }
    return bad;
  });
}

/** A report of any kind: nothing sticks out at five widths and on paper, which does not scroll. @param {import('playwright-core').Page} report */
export async function fitsScreensAndPaper(report) {
  for (const width of [1440, 1280, 1024, 800, 390]) {
    await report.setViewportSize({ width, height: 900 });
    await drawn(report);
    assert.deepEqual(await outOfReport(report), [], `${width} pixels`);
  }
  await report.setViewportSize({ width: 718, height: 900 }); // A4 less its margins
  await report.emulateMedia({ media: 'print' });
  await report.evaluate(() => dispatchEvent(new Event('beforeprint')));
  await drawn(report);
  assert.deepEqual(await outOfReport(report), [], 'print');
  const wider = () => [...document.querySelectorAll('.wide, figure')].filter((box) => box.scrollWidth > box.clientWidth + 1).map((box) => box.textContent?.slice(0, 60));
  assert.deepEqual(await report.evaluate(wider), [], 'print');
}
