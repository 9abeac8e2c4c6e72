// What may be changed of the chosen part itself: whether it moves, and whether it is there. What was done can be taken back.
import { byId, el, setPressed } from './dom.js';
import { icon } from './icons.js';

const MOST_ROWS = 3;

/** @param {import('../desk.js').Desk} desk @returns {{buttons: HTMLElement[], refresh: (part: import('../session/session.js').Part) => void}} */
export function makePartEdit({ session, choice, commands }) {
  const rows = byId('edits');
  const moves = el('button', { type: 'button', class: 'small look', 'aria-label': 'May be moved', title: 'May be moved', onclick: toggle }, icon('move'));
  const remove = el('button', { type: 'button', class: 'small look', 'aria-label': 'Remove the part', title: 'Remove the part', onclick: take }, icon('remove'));

  /** @param {number} part @param {string} what */
  function offerUndo(part, what) {
    const row = el('li', { role: 'status' }, el('span', { class: 'grow' }, what));
    row.append(el('button', { type: 'button', class: 'small', 'aria-label': `Undo: ${what}`, onclick: async () => (await commands.ask('undo', { part })).done && row.remove() }, 'Undo'));
    rows.append(row);
    while (rows.children.length > MOST_ROWS) rows.firstElementChild?.remove();
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
    buttons: [moves, remove],
    refresh: ({ moving }) => {
      for (const button of [moves, remove]) button.hidden = !session.mayAct;
      setPressed(moves, moving);
    },
  };
}
