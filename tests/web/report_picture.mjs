// Draws the picture of the README from the report of mortise check: node tests/web/report_picture.mjs [OUT.png]
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { openBrowser, whyNoBrowser } from './support/browser.mjs';

const root = resolve(import.meta.dirname, '../..');
const bin = process.env.MORTISE_BIN_DIR ?? join(root, 'build/release/bin');
const out = resolve(process.argv[2] ?? join(root, 'scenarios/tensioner.png'));
const folder = mkdtempSync(join(tmpdir(), 'mortise-report-'));
const why = await whyNoBrowser();
if (why) throw new Error(why);
const browser = await openBrowser();
try {
  const report = join(folder, 'report.html');
  execFileSync(join(bin, 'mortise-check'), ['tensioner.step', '--html', report], { cwd: join(root, 'scenarios'), stdio: 'ignore' });
  const page = await browser.newPage({ viewport: { width: 960, height: 720 } });
  await page.goto(`file://${report}`);
  const first = await page.locator('svg').first().boundingBox();
  if (!first) throw new Error('the report has no picture');
  await page.screenshot({ path: out, fullPage: true, clip: { x: 0, y: 0, width: 960, height: first.y + first.height + 16 } });
} finally {
  await browser.close();
  rmSync(folder, { recursive: true });
}
