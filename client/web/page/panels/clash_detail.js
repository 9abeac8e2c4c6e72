// One clash in full: why it is of its class, the section through it, what people say of it, and the link to it.
import { linkOf } from '../session/link.js';
import { hasWay, pathSaid, waySaid } from '../session/way_out.js';
import { bracket, percent, plain, small, span } from '../session/words.js';
import { byId, el, setPressed, setText } from './dom.js';
import { makeClashFit } from './clash_fit.js';
import { makeClashPicture } from './clash_picture.js';
import { makeClashReview } from './clash_review.js';
import { fillDepthBar, fillScale } from './depth_bar.js';
import { classMark, icon } from './icons.js';
import { SectionDrawing } from './section_drawing.js';

/** @typedef {import('../session/session.js').Clash} Clash */

/** @param {import('../desk.js').Desk} desk */
export function makeClashDetail(desk) {
  const { session, choice, camera, way, flyToClash, cutAtClash, say } = desk;
  const panel = byId('clash');
  const title = el('span', { class: 'grow' });
  const mark = el('span');
  const button = (/** @type {string} */ name, /** @type {string} */ drawn, /** @type {() => unknown} */ onclick, title = name) =>
    el('button', { type: 'button', class: 'small', 'aria-label': name, title, onclick }, icon(drawn));
  const link = button('Copy the link to this clash', 'link', copyLink);
  const close = button('Close', 'close', () => choice.chooseClash(0));
  const bar = el('div', { class: 'depth' });
  const scale = el('div', { class: 'scale' });
  const figures = el('dl');
  const why = el('p');
  const drawing = new SectionDrawing(desk);
  const review = makeClashReview(desk);
  const fit = makeClashFit(desk);
  const fly = button('Fly there', 'zoom', () => flyToClash(choice.clash), 'Fly there (Enter)');
  const out = button('Show the way out', 'play', showWay);
  const told = el('p', { class: 'way', role: 'status' });
  const cut = button('Cut the view here', 'section', () => cutAtClash(choice.clash));
  const turn = button('Section across or along', 'rotate', () => drawing.turn());
  const picture = makeClashPicture(desk, current);
  const draw = button('Picture of the verdict', 'page', () => picture.ask());
  panel.append(el('h3', {}, mark, title, link, close), bar, scale, figures, drawing.canvas,
    el('div', { class: 'row' }, drawing.caption, draw, fly, out, cut, turn), picture.figure, told, review.thread, review.form, fit.form, why);

  function current() {
    return session.clashes.get(choice.clash) ?? null;
  }

  async function copyLink() {
    const { clash } = choice;
    const place = { session: session.name, clash, tick: session.tick, eye: camera.eye, at: camera.at };
    const text = linkOf(location.href, place);
    try {
      await navigator.clipboard.writeText(text);
      say(`The link to clash ${clash} is copied; it holds no token, so whoever opens it needs an address of their own`, 'good');
    } catch {
      say(text);
    }
  }

  /** @param {Clash} clash @returns {Array<[string, string]>} */
  function people(clash) {
    const { review: said, ruled } = clash;
    const reviewer = said?.user ? `${session.userName(said.user)}: ${plain(said.status)}` : clash.approval_lost ? 'approval lost: it got worse' : '';
    const task = session.assigneeOf(clash.clash);
    return [
      ['Moved by', clash.mover ? session.userName(clash.mover) : ''],
      ['Rule by', ruled ? `${session.userName(ruled.user)} (${ruled.cause})` : ''],
      ['Reviewed by', reviewer],
      ['Task of', task ? session.userName(task) : ''],
      ['Since', span(session.ago(clash.begin_tick))],
    ];
  }

  /** @param {Clash} clash */
  function comesFree(clash) {
    if (clash.separation.way === 'none') return '';
    return [`${bracket(clash.gpd)} ${clash.separation.way}`, pathSaid(clash, (part) => session.partName(part))].filter(Boolean).join('; ');
  }

  /** The part that moves goes its way as a ghost, or the ghost goes. */
  function showWay() {
    const clash = current();
    if (way.part || !clash) {
      endWay();
      return;
    }
    const part = session.parts.get(clash.separation.moves === 'b' ? clash.b : clash.a);
    if (!part || !way.play(part, clash)) return;
    const small = way.pixels(part, clash) < 2 ? '. From here that is less than two pixels: fly nearer to see it' : '';
    setText(told, `${waySaid(clash, (id) => session.partName(id))}${small}`);
    told.scrollIntoView({ block: 'nearest' });
    setPressed(out, true);
  }

  function endWay() {
    if (way.part) way.stop();
    setText(told, '');
    setPressed(out, false);
  }

  /** @param {Clash} clash */
  function rows(clash) {
    const margin = { real: 'beyond the real threshold', fake: 'to spare', potential: 'to the nearer threshold', none: '' }[clash.class];
    const faces = clash.faces.map((face) => face || 'unnamed face').join(' × ');
    const worst = clash.worst_class !== clash.class ? `${clash.worst_class}, ${bracket(clash.worst_delta)}` : '';
    return [
      ['Overlap', bracket(clash.delta)],
      ['Margin', `${small(clash.margin)} ${margin}`],
      ['Interference', clash.class === 'potential' && clash.probability !== null ? percent(clash.probability) : ''],
      ['Faces', faces],
      ['Comes free', comesFree(clash)],
      ['Worst so far', worst],
      ...people(clash),
    ].filter(([, text]) => text);
  }

  /** @param {Clash} clash */
  function showFigures(clash) {
    const wanted = rows(clash);
    if (figures.children.length !== 2 * wanted.length) figures.replaceChildren(...wanted.flatMap(() => [el('dt'), el('dd')]));
    wanted.forEach(([name, text], i) => {
      setText(figures.children[2 * i], name);
      setText(figures.children[2 * i + 1], text);
    });
  }

  function refresh() {
    const clash = current();
    panel.hidden = clash === null;
    if (!clash) return;
    mark.replaceChildren(classMark(clash.class));
    setText(title, `#${clash.clash} ${session.partName(clash.a)} × ${session.partName(clash.b)}`);
    title.title = title.textContent ?? '';
    panel.setAttribute('aria-label', `${clash.ended ? 'Ended' : clash.class} clash ${title.title}`);
    fillDepthBar(bar, clash);
    fillScale(scale, clash);
    showFigures(clash);
    setText(why, clash.explanation);
    review.show(clash);
    fit.show(clash);
    out.hidden = clash.ended === true || !hasWay(clash);
    drawing.show(clash);
    picture.refresh();
  }

  /** What counts on while nothing happens. */
  function refreshTimes() {
    const clash = current();
    if (!clash) return;
    showFigures(clash);
    review.showTimes(clash);
  }

  choice.on('clash', () => {
    endWay();
    picture.drop();
    refresh();
    // The list has become shorter.
    document.querySelector('#clashes [aria-selected="true"]')?.scrollIntoView({ block: 'nearest' });
  });
  session.on('event', (event) => {
    if (event.clash !== choice.clash) return;
    if (event.kind !== 'review') endWay(); // it was the way out of what has changed
    refresh();
  });
  session.on('scene', () => {
    endWay();
    picture.drop();
  });
  session.on('pulse', refreshTimes);
  session.on('replay', refreshTimes);
  for (const what of /** @type {const} */ (['scene', 'me', 'features', 'remarks', 'standing', 'users'])) session.on(what, refresh);
}
