// Who asks whom for which part: there until it is answered or withdrawn, whatever is chosen.
import { byId, el, keepRows, setText } from './dom.js';

/** @param {import('../desk.js').Desk} desk */
export function makeAsks({ session, choice, commands, showPart, say }) {
  const box = byId('asks');
  /** Parts that this user asks for. @type {Set<number>} */
  let mine = new Set();

  const standing = () => session.standing.filter((d) => d.kind === 'ask for hand-over' && session.me !== 0 && (d.user === session.me || d.other_user === session.me));

  function make() {
    return el('div', {}, el('span', {}), el('button', { type: 'button' }), el('button', { type: 'button', class: 'primary' }), el('button', { type: 'button' }));
  }

  /** @param {HTMLElement} row @param {any} d */
  function fill(row, d) {
    const [text, show, give, end] = /** @type {[HTMLElement, HTMLButtonElement, HTMLButtonElement, HTMLButtonElement]} */ ([...row.children]);
    const own = d.user === session.me;
    const part = session.partName(d.part);
    setText(text, own ? `You ask ${session.userName(d.other_user)} for ${part}` : `${session.userName(d.user)} asks you for ${part}`);
    setText(show, `Show ${part}`);
    show.onclick = () => {
      choice.choosePart(d.part);
      showPart(d.part);
    };
    give.hidden = own;
    setText(give, `Give it to ${session.userName(d.user)}`);
    give.onclick = () => commands.ask('consent', { part: d.part });
    setText(end, own ? 'Ask no longer' : 'Keep it');
    end.onclick = () => commands.ask(own ? 'withdraw' : 'decline', { part: d.part });
  }

  function refresh() {
    const rows = standing();
    box.hidden = rows.length === 0;
    keepRows(box, rows, (d) => `${d.user} ${d.part}`, make, fill);
    const now = new Set(rows.filter((d) => d.user === session.me).map((d) => d.part));
    for (const id of mine) {
      const part = session.parts.get(id);
      if (!now.has(id) && part?.holder === 0) say(`${part.name} is free now: you may grab it`, 'good');
    }
    mine = now;
  }

  for (const what of /** @type {const} */ (['standing', 'scene', 'me', 'users'])) session.on(what, refresh);
}
