// What a designer with mesh files and a browser does: `mortise open`, join, drop the files, say their unit, read the verdict.
// node tests/web/from_files.mjs MORTISE FILE FILE: prints the verdict and the seconds, from the command in the shell to the row in the list.
// node tests/web/from_files.mjs --why-not: prints why there can be no browser here, or an empty line.
import { spawn } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { openBrowser, openPage, whyNoBrowser } from './support/browser.mjs';
import { PATIENCE } from './support/people.mjs';

const [mortise, ...files] = process.argv.slice(2);
const why = await whyNoBrowser();
if (mortise === '--why-not' || why) {
  console.log(why);
  process.exit(mortise === '--why-not' ? 0 : 1);
}
const began = Date.now();
const opened = spawn(mortise, ['open'], { stdio: ['ignore', 'ignore', 'pipe'] });
const ended = new Promise((done) => opened.once('exit', done));
let browser;
let said = '';
try {
  const addresses = await new Promise((done, fail) => {
    opened.stderr.on('data', (text) => {
      said += text;
      const named = /addresses for browsers are in (\S+), /.exec(said);
      if (named) done(readFileSync(join(process.cwd(), named[1]), 'utf8'));
    });
    ended.then((code) => fail(new Error(`mortise open ended with ${code}`)));
  });
  browser = await openBrowser();
  const page = await openPage(browser, /^designer (\S+)$/m.exec(addresses)?.[1], { name: 'Eva' });
  const carried = await page.evaluateHandle((all) => {
    const data = new DataTransfer();
    for (const [name, bytes] of all) data.items.add(new File([Uint8Array.from(bytes)], name));
    return data;
  }, files.map((file) => /** @type {[string, number[]]} */ ([basename(file), [...readFileSync(file)]])));
  await page.dispatchEvent('.view', 'drop', { dataTransfer: carried });
  await page.getByLabel('Unit of their numbers').selectOption('mm');
  await page.click('#units_add');
  const pair = files.map((file) => basename(file).replace(/\.[^.]*$/, '')).join(' × ');
  const verdict = page.locator(`#clashes > li[aria-label*="${pair}"]`);
  await verdict.waitFor(PATIENCE);
  console.log(`${((Date.now() - began) / 1000).toFixed(1)} s after the command: ${await verdict.getAttribute('aria-label')}`);
  if (page.complaints.length > 0) throw new Error(page.complaints.join('\n'));
} catch (error) {
  console.error(said);
  throw error;
} finally {
  await browser?.close();
  opened.kill('SIGINT');
  await ended;
}
