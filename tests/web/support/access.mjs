// What axe (axe-core, by npm) finds wrong with a page for those who do not see it, or not well, or have no pointer.
import axe from 'axe-core';

/**
 * All rules of WCAG 2.2 A and AA, and what axe holds for good practice. What axe cannot decide (text over a picture) is not told.
 * A row of a list is called by the name that it shows; the figures beside that are read with it in other words, so axe's rule for
 * labels, which wants all text of a row in order, is replaced there.
 * @param {import('playwright-core').Page} page @returns {Promise<string[]>}
 */
export async function barriers(page) {
  // By the debugger's line, which the page's Content-Security-Policy does not bind.
  await page.evaluate(axe.source);
  return page.evaluate(async () => {
    const { violations } = await window.axe.run(document, { resultTypes: ['violations'] });
    const bad = violations.flatMap(({ id, help, nodes }) => nodes.map(({ html }) => `${id}: ${help}: ${html.slice(0, 120)}`))
      .filter((text) => !/^label-content-name-mismatch: .* <li role="option"/.test(text));
    for (const row of document.querySelectorAll('[role="option"][aria-label]')) {
      const name = row.querySelector('.grow')?.textContent?.replace(' ⚠', '') ?? '';
      if (!row.getAttribute('aria-label')?.includes(name)) bad.push(`a row is not called ${name}: ${row.outerHTML.slice(0, 120)}`);
    }
    return bad;
  });
}
