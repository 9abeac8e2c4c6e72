// What one frame of the page costs in script: one message of poses taken in and one picture prepared, from the browser's own trace.
// Drawing itself (here by software, in another process) is not script and not counted.
// usage: node tests/web/frame_bench.mjs [--json FILE] [--quick]
import { writeFileSync } from 'node:fs';
import { openBrowser, openPage, whyNoBrowser } from './support/browser.mjs';
import { openFakeGateway } from './support/fake_gateway.mjs';

/** Parts that all move, and shapes among them: 200 are an assembly, 1000 with 550,000 triangles the most that is promised. */
const ROWS = [
  { parts: 50, shapes: 20 }, { parts: 200, shapes: 20, bound: 4 }, { parts: 200, shapes: 200, bound: 4 }, { parts: 400, shapes: 20 },
  { parts: 1000, shapes: 20, bound: 8 }, { parts: 1000, shapes: 1000, bound: 8 },
];
/** Code that ran a few times is interpreted still: what a user's second second costs is asked, not the first picture. */
const WARM_PICTURES = 25;
const quick = process.argv.includes('--quick');
const json = process.argv.includes('--json') ? process.argv[process.argv.indexOf('--json') + 1] : '';

const SCRIPT = new Set(['FunctionCall', 'EventDispatch', 'TimerFire', 'FireAnimationFrame', 'RunMicrotasks', 'V8.GC_SCAVENGER', 'MajorGC', 'MinorGC']);

/** Outermost script of the page's main thread, by what set it off; time on the processor where the trace has it. */
function scriptOf(events) {
  const main = events.find((e) => e.name === 'thread_name' && e.args?.name === 'CrRendererMain' && events.some((f) => f.pid === e.pid && f.name === 'FireAnimationFrame'));
  const own = events.filter((e) => e.ph === 'X' && e.pid === main.pid && e.tid === main.tid && SCRIPT.has(e.name));
  own.sort((a, b) => a.ts - b.ts || b.dur - a.dur);
  const outermost = [];
  let until = -1;
  for (const event of own) {
    if (event.ts < until) continue;
    until = event.ts + event.dur;
    outermost.push(event);
  }
  const cpu = outermost.every((e) => e.tdur !== undefined);
  const cost = (e) => (cpu ? e.tdur : e.dur) / 1000;
  const pictures = outermost.filter((e) => e.name === 'FireAnimationFrame').map(cost);
  const rest = outermost.filter((e) => e.name !== 'FireAnimationFrame').map(cost);
  return { pictures, rest, cpu };
}

const median = (list) => [...list].sort((a, b) => a - b)[Math.floor(list.length / 2)] ?? NaN;
const percentile = (list, share) => [...list].sort((a, b) => a - b)[Math.min(list.length - 1, Math.floor(list.length * share))] ?? NaN;
const total = (list) => list.reduce((sum, x) => sum + x, 0);

/** Counts the pictures that the page asks for. Each call draws one triangle of each part: the same script, and software is done with it at once. */
const counting = () => {
  const gl = WebGL2RenderingContext.prototype;
  const { drawArrays, drawElements, getExtension } = gl;
  const few = new Int32Array(1 << 16).fill(3);
  Object.assign(gl, {
    drawArrays(mode, first, count) { drawArrays.call(this, mode, first, Math.min(count, 3)); },
    drawElements(mode, count, type, offset) { drawElements.call(this, mode, Math.min(count, 3), type, offset); },
    getExtension(name) {
      const found = getExtension.call(this, name);
      const own = found && Object.getPrototypeOf(found).multiDrawElementsWEBGL;
      if (own) found.multiDrawElementsWEBGL = (mode, counts, from, ...rest) => {
        window.bodies = Math.max(window.bodies, rest.at(-1));
        own.call(found, mode, few, 0, ...rest);
      };
      return found;
    },
  });
  const ask = requestAnimationFrame;
  Object.assign(window, { pictures: 0, bodies: 0 });
  window.requestAnimationFrame = (what) => (++window.pictures, ask(what));
};

async function drawn(page, count) {
  await page.waitForFunction((n) => window.pictures >= n, count, { timeout: 60_000, polling: 250 });
}

async function measure(browser, parts, shapes) {
  const gateway = await openFakeGateway(parts, shapes, 8);
  const page = await openPage(browser, gateway.address, { first: counting });
  // Script does not depend on the size of the picture, drawing by software does: a small one is drawn often enough to run warm.
  await page.setViewportSize({ width: 760, height: 300 });
  await page.waitForFunction((n) => document.querySelectorAll('#parts > li').length === n, parts, { timeout: 60_000 });
  await page.waitForFunction((n) => window.bodies >= n, parts, { timeout: 60_000, polling: 250 });
  await drawn(page, WARM_PICTURES + (await page.evaluate(() => window.pictures)));
  const frames = () => page.evaluate(() => Number(document.getElementById('status_tick')?.textContent?.slice(5)));
  const line = await page.context().newCDPSession(page);
  const events = [];
  line.on('Tracing.dataCollected', ({ value }) => events.push(...value));
  const done = new Promise((end) => line.once('Tracing.tracingComplete', end));
  const first = await frames();
  await line.send('Tracing.start', { transferMode: 'ReportEvents', traceConfig: { includedCategories: ['devtools.timeline', 'disabled-by-default-v8.gc'] } });
  await page.waitForTimeout(quick ? 5000 : 15_000);
  await line.send('Tracing.end');
  await done;
  const messages = (await frames()) - first;
  await page.context().close();
  gateway.close();
  if (page.complaints.length > 0) throw new Error(page.complaints.join('\n'));
  const { pictures, rest, cpu } = scriptOf(events);
  // All script beside the pictures is laid to the messages: lists and fields that follow them, and collection of garbage.
  const message = total(rest) / messages;
  return { parts, shapes, clock: cpu ? 'processor' : 'wall', pictures: pictures.length, messages, picture_ms: median(pictures), picture_p90_ms: percentile(pictures, 0.9), message_ms: message, frame_ms: median(pictures) + message };
}

const why = await whyNoBrowser();
if (why) {
  console.error(`SKIPPED: ${why}`);
  process.exit(0);
}
const browser = await openBrowser();
const rows = [];
console.log('parts  shapes  pictures  messages  picture ms (p90)  message ms  frame ms');
for (const { parts, shapes } of ROWS.filter(({ bound }) => bound || !quick)) {
  const row = await measure(browser, parts, shapes);
  rows.push(row);
  const { pictures, messages, picture_ms, picture_p90_ms, message_ms, frame_ms } = row;
  console.log(`${`${parts}`.padStart(5)}  ${`${shapes}`.padStart(6)}  ${`${pictures}`.padStart(8)}  ${`${messages}`.padStart(8)}  ${picture_ms.toFixed(2).padStart(7)} (${picture_p90_ms.toFixed(2)})  ${message_ms.toFixed(2).padStart(10)}  ${frame_ms.toFixed(2).padStart(8)}   ${row.clock} time`);
}
await browser.close();
const bars = rows.flatMap(({ parts, shapes, frame_ms: figure }, i) => {
  const { bound } = ROWS.filter((row) => row.bound || !quick)[i];
  return bound ? { name: `script of a page frame with ${parts} moving parts of ${shapes} shapes, ms`, figure, kind: 'at most', bound, holds: figure <= bound } : [];
});
for (const { name, figure, bound, holds } of bars) console.log(`${holds ? 'holds ' : 'MISSED'}  ${name}: ${figure.toFixed(2)}, bound ${bound}`);
if (json) writeFileSync(json, `${JSON.stringify({ tables: [{ title: 'Script of a frame of the page', rows }], notes: [], bars }, null, 2)}\n`);
process.exit(bars.every(({ holds }) => holds) ? 0 : 5);
