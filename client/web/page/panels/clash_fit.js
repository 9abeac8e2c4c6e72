// A fit of the two faces of the chosen clash, set where one sees what it does.
import { plain } from '../session/words.js';
import { el, setText } from './dom.js';

/** @typedef {import('../session/session.js').Clash} Clash */

/** From loose to tight, of a hole H7. */
const CODES = ['H7/f7', 'H7/g6', 'H7/h6', 'H7/js6', 'H7/k6', 'H7/m6', 'H7/n6', 'H7/p6', 'H7/r6', 'H7/s6'];

/** @param {import('../desk.js').Desk} desk */
export function makeClashFit({ session, choice, commands, say }) {
  const codes = el('datalist', { id: 'fit_codes' }, ...CODES.map((value) => el('option', { value })));
  const text = el('input', { type: 'text', maxLength: 200, 'aria-label': 'Fit of the two faces', placeholder: 'H7/g6, ±0.05; empty: none' });
  text.setAttribute('list', 'fit_codes');
  const set = el('button', { type: 'submit' }, 'Set fit');
  const where = el('span', { class: 'quiet' });
  const form = el('form', { class: 'review' }, where, el('div', { class: 'row' }, text, set), codes);
  let shown = 0;

  /** The fit in force of these faces, from either end. @param {Clash} clash */
  function inForce(clash) {
    const ends = [`${clash.a} ${clash.faces[0]}`, `${clash.b} ${clash.faces[1]}`];
    return session.standing.find((d) => d.kind === 'set tolerance' && d.other && [0, 1].every((i) => ends[i] === `${i === 0 ? d.part : d.other} ${(i === 0 ? d.feature : d.other_feature) ?? ''}`
      || ends[1 - i] === `${i === 0 ? d.part : d.other} ${(i === 0 ? d.feature : d.other_feature) ?? ''}`));
  }

  /** @param {Clash} clash */
  function show(clash) {
    form.hidden = !session.mayAct || clash.ended === true || clash.faces.some((face) => !face);
    if (form.hidden) return;
    const now = inForce(clash)?.text ?? '';
    setText(where, `Fit of ${plain(clash.faces[0])} × ${plain(clash.faces[1])}: ${now || 'none'}`);
    if (shown === clash.clash && document.activeElement === text) return;
    if (shown !== clash.clash || !text.dataset.edited) text.value = now;
    if (shown !== clash.clash) delete text.dataset.edited;
    shown = clash.clash;
  }

  text.addEventListener('input', () => (text.dataset.edited = 'yes'));
  form.addEventListener('submit', async (event) => {
    event.preventDefault();
    const clash = session.clashes.get(choice.clash);
    if (!clash) return;
    const reply = await commands.ask('fit', { part: clash.a, feature: clash.faces[0], other: clash.b, other_feature: clash.faces[1], text: text.value.trim() });
    delete text.dataset.edited;
    if (reply.done && !reply.text) say('Fit set; the clash is judged by it for everybody', 'good');
  });
  return { form, show };
}
