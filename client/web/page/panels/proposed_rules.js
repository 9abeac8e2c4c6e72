// Fits that nobody has stated: bores and shafts that lie in each other. One code for all of them, or for one.
import { proposedFits } from '../session/proposed_fits.js';
import { plain, small } from '../session/words.js';
import { byId, el, keepRows, setText } from './dom.js';

/** @typedef {import('../session/proposed_fits.js').ProposedFit} ProposedFit */

/** @param {import('../desk.js').Desk} desk */
export function makeProposedRules({ session, commands, say }) {
  const panel = byId('rules_panel');
  const count = el('span', { class: 'count' });
  const code = el('input', { type: 'text', class: 'grow', maxLength: 60, placeholder: 'H7/g6', 'aria-label': 'Fit for what is proposed' });
  const all = el('button', { type: 'submit' }, 'Set for all');
  const rows = el('ul', { class: 'list', 'aria-label': 'Proposed fits' });
  const box = el('form', { class: 'rule', hidden: true }, el('h2', {}, 'Proposed ', count), el('div', { class: 'row' }, code, all), rows);
  panel.append(box);
  /** @type {ProposedFit[]} */
  let proposed = [];

  /** @param {{part: number, feature: string}} end */
  const place = ({ part, feature }) => `${session.partName(part)}.${plain(feature)}`;

  /** @param {ProposedFit} fit */
  async function set({ bore, shaft, code: declared }) {
    return (await commands.ask('fit', { part: bore.part, feature: bore.feature, other: shaft.part, other_feature: shaft.feature, text: code.value.trim() || declared })).done;
  }

  function refresh() {
    if (panel.hidden) return;
    proposed = session.mayAct ? proposedFits(session) : [];
    box.hidden = proposed.length === 0;
    setText(count, `${proposed.length}`);
    all.disabled = code.value.trim() === '' && proposed.some((fit) => fit.code === '');
    keepRows(rows, proposed, ({ bore, shaft }) => [bore.part, bore.feature, shaft.part, shaft.feature].join(' '),
      () => el('li', {}, el('span', { class: 'grow' }), el('span', { class: 'quiet' }), el('button', { type: 'button' }, 'Set')),
      (row, fit) => {
        const [name, clearance, one] = /** @type {[HTMLElement, HTMLElement, HTMLButtonElement]} */ ([...row.children]);
        setText(name, `${place(fit.bore)} × ${place(fit.shaft)}`);
        name.title = name.textContent ?? '';
        const size = Math.abs(fit.clearance) < 5e-5 ? 'of one size' : `${small(Math.abs(fit.clearance))} ${fit.clearance < 0 ? 'too thick' : 'of play'}`;
        setText(clearance, fit.code && code.value.trim() === '' ? `${fit.code}, as declared elsewhere` : size);
        one.disabled = code.value.trim() === '' && fit.code === '';
        one.setAttribute('aria-label', `Set: ${name.title}`);
        one.onclick = () => set(fit);
      });
  }

  box.addEventListener('submit', async (event) => {
    event.preventDefault();
    const wanted = proposed;
    for (const fit of wanted) if (!(await set(fit))) return; // why is said already
    say(`Fits set: ${wanted.length}`, 'good');
  });
  code.oninput = refresh;
  for (const what of /** @type {const} */ (['scene', 'features', 'me', 'standing'])) session.on(what, refresh);
  return { refresh };
}
