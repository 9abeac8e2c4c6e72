// What may be changed of the chosen part itself: whether it moves, what it is made of, and whether it is there. What was done can be taken back.
import { byId, el, setPressed } from './dom.js';
import { icon } from './icons.js';
import { makeReplacePart } from './replace_part.js';

const MOST_ROWS = 3;

/** @param {import('../desk.js').Desk} desk @param {ReturnType<typeof import('./arriving.js').makeArriving>} arriving @returns {{buttons: HTMLElement[], refresh: (part: import('../session/session.js').Part) => void}} */
export function makePartEdit(desk, arriving) {
  const { session, choice, commands } = desk;
  const rows = byId('edits');
  const moves = el('button', { type: 'button', class: 'small look', 'aria-label': 'May be moved', title: 'May be moved', onclick: toggle }, icon('move'));
  const replace = el('button', { type: 'button', class: 'small look', 'aria-label': 'Replace the part by a file', title: 'Replace the part by a file…', onclick: exchange }, icon('replace'));
  const remove = el('button', { type: 'button', class: 'small look', 'aria-label': 'Remove the part', title: 'Remove the part', onclick: take }, icon('remove'));

  /** @param {number} part @param {string} what */
  function offerUndo(part, what) {
    const row = el('li', { role: 'status' }, el('span', { class: 'grow' }, what));
    row.append(el('button', { type: 'button', class: 'small', 'aria-label': `Undo: ${what}`, onclick: async () => (await commands.ask('undo', { part })).done && row.remove() }, 'Undo'));
    rows.append(row);
    while (rows.children.length > MOST_ROWS) rows.firstElementChild?.remove();
  }

  const askForFile = makeReplacePart(desk, arriving, offerUndo);
  function exchange() {
    const part = session.parts.get(choice.part);
    if (part) askForFile(part);
  }

  async function toggle() {
    const part = session.parts.get(choice.part);
    if (!part) return;
    const { id, name, moving } = part;
    const reply = await commands.ask('set_moving', { part: id, moving: !moving });
    if (reply.done) offerUndo(id, `${name} ${moving ? 'stands' : 'may be moved'}`);
  }

  async function take() {
    const part = session.parts.get(choice.part);
    if (!part) return;
    const { id, name } = part;
    const reply = await commands.ask('remove_part', { part: id });
    if (reply.done) offerUndo(id, `${name} is removed`);
  }

  return {
    buttons: [moves, replace, remove],
    refresh: ({ moving }) => {
      for (const button of [moves, replace, remove]) button.hidden = !session.mayAct;
      setPressed(moves, moving);
    },
  };
}
