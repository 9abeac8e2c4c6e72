// Debian's chromium without a screen, pictures by software.
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const CHROMIUM = process.env.MORTISE_CHROMIUM ?? '/usr/bin/chromium';
const PATIENT = fileURLToPath(new URL('patient_chromium.sh', import.meta.url));
/** For a page to open, and for what is to be pressed: on a machine that does other things as well. */
const PATIENCE_MS = 120_000;
export const VIEW = { width: 1280, height: 720 };

/** Why there can be no browser here, or no use of it without this module; empty when there can. */
export async function whyNoBrowser(module = 'playwright-core') {
  if (Number(process.versions.node.split('.')[0]) < 20) return `node ${process.versions.node} is older than 20`;
  if (!existsSync(CHROMIUM)) return `${CHROMIUM} is not there: apt-get install chromium`;
  for (const needed of new Set(['playwright-core', module])) {
    try {
      await import(needed);
    } catch {
      return `${needed} is not there: npm ci --prefix tests/web`;
    }
  }
  if (!existsSync(new URL('../../../client/web/page/node_modules/three/build/three.module.js', import.meta.url))) {
    return 'three is not there: npm ci --omit=dev --prefix client/web/page';
  }
  return '';
}

export async function openBrowser() {
  const { chromium } = await import('playwright-core');
  // A page is put together without its software GPU, which costs a fifth more: that draws the view alone.
  // The sandbox of chromium refuses to run as root; nothing but our own page is opened.
  const sandbox = process.getuid?.() === 0 ? ['--no-sandbox'] : [];
  return chromium.launch({ executablePath: PATIENT, headless: true, args: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-gpu-compositing', '--disable-dev-shm-usage', ...sandbox] });
}

/** A page of its own profile. What it complains of is collected. @param {import('playwright-core').Browser} browser */
export async function openPage(browser, address, { scheme = 'dark', name, first, view = VIEW, touch = false } = {}) {
  const context = await browser.newContext({ viewport: view, colorScheme: scheme, reducedMotion: 'reduce', hasTouch: touch });
  context.setDefaultTimeout(PATIENCE_MS);
  const page = await context.newPage();
  if (first) await page.addInitScript(first);
  page.complaints = [];
  page.on('pageerror', (error) => page.complaints.push(`${error}`));
  page.on('console', (message) => message.type() === 'error' && page.complaints.push(message.text()));
  await page.goto(address);
  if (name) await joinAs(page, name);
  return page;
}

export async function joinAs(page, name) {
  await page.fill('#join_name', name);
  await page.click('#join_go');
  // Several browsers draw without a graphics card on two cores: the first picture may take half a minute.
  await page.waitForFunction((n) => document.getElementById('status_server')?.textContent === `You are ${n}`, name, { timeout: PATIENCE_MS });
}
