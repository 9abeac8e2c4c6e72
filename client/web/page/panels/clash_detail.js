// One clash in full: why it is of its class, the section through it, and what people say of it.
import { STATUSES, bracket, percent, plain, small } from '../session/words.js';
import { byId, el, setText } from './dom.js';
import { fillDepthBar, fillScale } from './depth_bar.js';
import { classMark, icon } from './icons.js';
import { SectionDrawing } from './section_drawing.js';

/** @typedef {import('../session/session.js').Clash} Clash */

/** @param {import('../desk.js').Desk} desk */
export function makeClashDetail(desk) {
  const { session, choice, commands, flyToClash, cutAtClash, say } = desk;
  const panel = byId('clash');
  const title = el('span', { class: 'grow' });
  const mark = el('span');
  const close = el('button', { class: 'small', type: 'button', 'aria-label': 'Close', title: 'Close', onclick: () => choice.chooseClash(0) }, icon('close'));
  const bar = el('div', { class: 'depth' });
  const scale = el('div', { class: 'scale' });
  const figures = el('dl');
  const why = el('p');
  const drawing = new SectionDrawing(desk);
  const status = el('select', { 'aria-label': 'Review status' }, ...STATUSES.map((name) => el('option', { value: name }, plain(name))));
  const comment = el('input', { type: 'text', 'aria-label': 'Comment', placeholder: 'Comment', maxLength: 500 });
  const save = el('button', { type: 'button', class: 'primary' }, 'Save');
  const by = el('span', { class: 'quiet' });
  const fly = el('button', { type: 'button', class: 'small', 'aria-label': 'Fly there', title: 'Fly there (Enter)', onclick: () => flyToClash(choice.clash) }, icon('zoom'));
  const cut = el('button', { type: 'button', class: 'small', 'aria-label': 'Cut the view here', title: 'Cut the view here', onclick: () => cutAtClash(choice.clash) }, icon('section'));
  const turn = el('button', { type: 'button', class: 'small', 'aria-label': 'Section across or along', title: 'Section across or along', onclick: () => drawing.turn() }, icon('rotate'));
  panel.append(el('h3', {}, mark, title, close), bar, scale, figures, drawing.canvas,
    el('div', { class: 'row' }, drawing.caption, fly, cut, turn), el('div', { class: 'row' }, status, comment, save), by, why);
  let edited = false;

  function current() {
    return session.clashes.get(choice.clash) ?? null;
  }

  /** @param {Clash} clash */
  function rows(clash) {
        const margin = { real: 'beyond the real threshold', fake: 'to spare', potential: 'to the nearer threshold', none: '' }[clash.class];
    const faces = clash.faces.map((face) => face || 'unnamed face').join(' × ');
    const moved = clash.user ? `, moved by ${session.userName(clash.user)}` : '';
    const worst = clash.worst_class !== clash.class ? `${clash.worst_class}, ${bracket(clash.worst_delta)}` : '';
    return [
      ['Overlap', bracket(clash.delta)],
      ['Margin', `${small(clash.margin)} ${margin}`],
      ['Interference', clash.class === 'potential' && clash.probability !== null ? percent(clash.probability) : ''],
      ['Faces', faces],
      ['Comes free', clash.separation.way === 'none' ? '' : `${bracket(clash.gpd)} ${clash.separation.way}`],
      ['Worst so far', worst],
      ['Since', `${Math.max(0, (session.tick - clash.begin_tick) / session.tickRate).toFixed(1)} s${moved}`],
    ].filter(([, text]) => text);
  }

  function refresh() {
    const clash = current();
    panel.hidden = clash === null;
    if (!clash) return;
    mark.replaceChildren(classMark(clash.class));
    setText(title, `${session.partName(clash.a)} × ${session.partName(clash.b)}`);
    title.title = title.textContent ?? '';
    panel.setAttribute('aria-label', `${clash.ended ? 'Ended' : clash.class} clash of ${title.title}`);
    fillDepthBar(bar, clash);
    fillScale(scale, clash);
    figures.replaceChildren(...rows(clash).flatMap(([name, text]) => [el('dt', {}, name), el('dd', {}, text)]));
    setText(why, clash.explanation);
    const review = clash.review ?? { status: 'new', comment: '', user: 0, tick: 0 };
    if (!edited) {
      status.value = review.status;
      comment.value = review.comment;
    }
    const reviewer = review.user ? `${review.status} by ${session.userName(review.user)}` : clash.approval_lost ? 'approval lost: it got worse' : '';
    by.hidden = reviewer === '';
    setText(by, reviewer);
    for (const control of [status, comment, save]) control.disabled = !session.mayAct || clash.ended === true;
    drawing.show(clash);
  }

  save.onclick = async () => {
    const reply = await commands.ask('review', { clash: choice.clash, status: status.value, text: comment.value });
    if (!reply.done) return;
    edited = false;
    say('Review saved', 'good');
  };
  for (const control of [status, comment]) control.addEventListener('input', () => (edited = true));
  choice.on('clash', () => {
    edited = false;
    refresh();
    // The list has become shorter.
    document.querySelector('#clashes [aria-selected="true"]')?.scrollIntoView({ block: 'nearest' });
  });
  session.on('event', (event) => event.clash === choice.clash && refresh());
  session.on('scene', refresh);
  session.on('me', refresh);
  session.on('features', refresh);
}
