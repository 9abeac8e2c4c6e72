// What people say of the chosen clash: its thread, its state, whose task it is.
import { STATUSES, plain, span } from '../session/words.js';
import { el, keepRows, setText } from './dom.js';

/** @typedef {import('../session/session.js').Clash} Clash */
/** @typedef {import('../session/session.js').Remark} Remark */

/** @param {import('../desk.js').Desk} desk */
export function makeClashReview({ session, choice, commands, say }) {
  const thread = el('ol', { class: 'thread', 'aria-label': 'What was said of it' });
  const status = el('select', { 'aria-label': 'Review status' }, ...STATUSES.map((name) => el('option', { value: name }, plain(name))));
  const assignee = el('select', { 'aria-label': 'Whose task' });
  const comment = el('input', { type: 'text', 'aria-label': 'Comment', placeholder: 'Comment', maxLength: 500 });
  const save = el('button', { type: 'submit', class: 'primary' }, 'Save');
  const form = el('form', { class: 'review' }, el('div', { class: 'row' }, status, assignee), el('div', { class: 'row' }, comment, save));
  let edited = false;

  /** @param {number} clash */
  function fillAssignees(clash) {
    const now = session.assigneeOf(clash);
    const people = [...session.users.values()].filter((user) => user.id === now || (user.present && user.role !== 'observer'));
    people.sort((a, b) => a.name.localeCompare(b.name, 'en', { numeric: true }));
    const before = assignee.value;
    assignee.replaceChildren(el('option', { value: '0' }, 'nobody’s task'), ...people.map(({ id, name }) => el('option', { value: `${id}` }, name)));
    assignee.value = edited ? before : `${now}`;
    if (!assignee.value) assignee.value = '0';
  }

  /** The remarks, and what the session itself said where an approval lapsed. @param {Clash} clash @returns {Remark[]} */
  function saidOf(clash) {
    const remarks = session.remarksOf(clash.clash);
    const { review } = clash;
    const last = remarks.at(-1);
    const known = !review?.comment || (last && last.text === review.comment && last.user === review.user);
    return known ? remarks : [...remarks, { clash: clash.clash, user: review.user, assignee: 0, status: review.status, tick: review.tick, text: review.comment }];
  }

  /** @param {HTMLElement} row @param {Remark} remark @param {number} before whose task it was */
  function fillRemark(row, remark, before) {
    const [head, text] = /** @type {HTMLElement[]} */ ([...row.children]);
    const who = remark.user ? session.userName(remark.user) : 'the session';
    const task = remark.assignee === before ? '' : remark.assignee ? `, task of ${session.userName(remark.assignee)}` : ', nobody’s task';
    setText(head, `${who}, ${span(session.ago(remark.tick))} ago: ${plain(remark.status)}${task}`);
    setText(text, remark.text);
    text.hidden = remark.text === '';
  }

  /** @param {Clash} clash */
  function showTimes(clash) {
    const remarks = saidOf(clash);
    thread.hidden = remarks.length === 0;
    let before = 0;
    keepRows(thread, remarks.map((remark, i) => ({ remark, i })), ({ remark, i }) => `${clash.clash} ${i} ${remark.user} ${remark.text}`, () => el('li', {}, el('span', { class: 'quiet' }), el('p')),
      (row, { remark }) => {
        fillRemark(row, remark, before);
        before = remark.assignee;
      });
  }

  /** @param {Clash} clash */
  function show(clash) {
    fillAssignees(clash.clash);
    if (!edited) status.value = clash.review?.status ?? 'new';
    showTimes(clash);
    for (const control of [status, assignee, comment, save]) control.disabled = !session.mayAct || clash.ended === true;
  }

  form.addEventListener('submit', async (event) => {
    event.preventDefault();
    const task = Number(assignee.value);
    const reply = await commands.ask('review', { clash: choice.clash, status: status.value, text: comment.value.trim(), ...(task ? { assignee: task } : {}) });
    if (!reply.done) return;
    edited = false;
    comment.value = '';
    say('Review saved', 'good');
  });
  for (const control of [status, assignee, comment]) control.addEventListener('input', () => (edited = true));
  choice.on('clash', () => {
    edited = false;
    comment.value = '';
  });
  return { thread, form, show, showTimes };
}
