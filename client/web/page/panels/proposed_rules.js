// Fits that nobody has stated: bores and shafts that lie in each other. Those of one pattern and size are one group; one code for all, for a group, or for one.
import { fitGroups, proposedFits, setFits, sizeText } from '../session/proposed_fits.js';
import { plain, small } from '../session/words.js';
import { byId, el, keepRows, setText } from './dom.js';

/** @typedef {import('../session/proposed_fits.js').ProposedFit} ProposedFit */
/** @typedef {import('../session/proposed_fits.js').FitGroup} FitGroup */

const NAMED = 3; // of those that could not be set; the others are counted

/** @param {import('../desk.js').Desk} desk */
export function makeProposedRules({ session, commands, say }) {
  const panel = byId('rules_panel');
  const count = el('span', { class: 'count' });
  const code = el('input', { type: 'text', class: 'grow', maxLength: 60, placeholder: 'H7/g6', 'aria-label': 'Fit for what is proposed' });
  const all = el('button', { type: 'submit' }, 'Set for all');
  const back = el('button', { type: 'button', hidden: true });
  const rows = el('ul', { class: 'list', 'aria-label': 'Proposed fits' });
  const asked = el('div', { class: 'row' }, code, all);
  const box = el('form', { class: 'rule', hidden: true }, el('h2', {}, 'Proposed ', count), asked, back, rows);
  panel.append(box);
  /** @type {ProposedFit[]} */
  let proposed = [];
  /** Set by the last press; what has become another one since is left out where they are taken back. @type {ProposedFit[]} */
  let last = [];
  let busy = false;

  /** @param {import('../session/proposed_fits.js').End} end */
  const place = ({ part, feature }) => `${session.partName(part)}.${plain(feature)}`;
  /** @param {ProposedFit} fit */
  const nameOf = (fit) => `${place(fit.bore)} × ${place(fit.shaft)}`;
  /** @param {ProposedFit} fit @param {string} [own] of the group */
  const codeOf = (fit, own = '') => own || code.value.trim() || fit.code;

  /** What could not be done, with the reasons. @param {import('../session/proposed_fits.js').SetFits['missed']} missed @param {string} failed */
  function sayMissed(missed, failed) {
    const named = missed.slice(0, NAMED).map(({ fit, why }) => `${nameOf(fit)} (${why})`).join('; ');
    say(`${failed} ${missed.length}: ${named}${missed.length > NAMED ? `; and ${missed.length - NAMED} more` : ''}`, 'bad');
  }

  /** @param {ProposedFit[]} wanted @param {string} [own] */
  async function set(wanted, own = '') {
    if (busy) return;
    busy = true;
    refresh();
    const { done, missed } = await setFits((what, keys) => commands.request(what, keys), wanted, (fit) => codeOf(fit, own));
    busy = false;
    last = done;
    if (done.length > 0) say(missed.length > 0 ? `Fits set: ${done.length} of ${wanted.length}` : `Fits set: ${done.length}`, 'good');
    if (missed.length > 0) sayMissed(missed, 'Fits not set:');
    refresh();
  }

  /** Whether it is still the fit that was set here: what others said since is theirs. @param {ProposedFit} fit */
  const isMine = ({ bore, shaft }) => session.standing.some((d) => d.kind === 'set tolerance' && d.text && d.user === session.me
    && d.part === bore.part && d.feature === bore.feature && d.other === shaft.part && d.other_feature === shaft.feature);

  /** As one step: the session takes back motion by itself, not rules. */
  async function takeBack() {
    const wanted = last.filter(isMine);
    last = [];
    const { done, missed } = await setFits((what, keys) => commands.request(what, keys), wanted, () => '');
    if (done.length > 0) say(`Fits taken back: ${done.length}`, 'good');
    if (missed.length > 0) sayMissed(missed, 'Fits not taken back:');
    refresh();
  }

  /** @param {ProposedFit} fit */
  function playOf(fit) {
    return Math.abs(fit.clearance) < 5e-5 ? 'of one size' : `${small(Math.abs(fit.clearance))} ${fit.clearance < 0 ? 'too thick' : 'of play'}`;
  }

  /** @param {HTMLElement} row @param {ProposedFit} fit @param {string} [own] */
  function fillOne(row, fit, own = '') {
    const [name, clearance, one] = /** @type {[HTMLElement, HTMLElement, HTMLButtonElement]} */ ([...row.children]);
    setText(name, nameOf(fit));
    name.title = name.textContent ?? '';
    setText(clearance, fit.code && codeOf(fit, own) === fit.code ? `${fit.code}, as declared elsewhere` : playOf(fit));
    one.disabled = busy || codeOf(fit, own) === '';
    one.setAttribute('aria-label', `Set: ${name.title}`);
    one.onclick = () => set([fit], own);
  }

  const oneRow = () => el('li', {}, el('span', { class: 'grow' }), el('span', { class: 'quiet' }), el('button', { type: 'button' }, 'Set'));

  /** @param {FitGroup} group */
  const keyOf = ({ key, fits: [{ bore, shaft }, ...more] }) => (more.length > 0 ? key : [bore.part, bore.feature, shaft.part, shaft.feature].join(' '));

  function groupRow() {
    const own = el('input', { type: 'text', class: 'grow', maxLength: 60, oninput: () => refresh() });
    own.addEventListener('keydown', (event) => {
      if (event.key !== 'Enter') return;
      event.preventDefault(); // not the form: that sets all groups
      own.parentElement?.querySelector('button')?.click();
    });
    return el('li', { class: 'several' }, el('span', { class: 'grow' }), el('div', { class: 'row' }, own, el('button', { type: 'button' })),
      el('details', {}, el('summary', {}, 'Single pairs'), el('ul', { class: 'list short' })));
  }

  /** @param {HTMLElement} row @param {FitGroup} group */
  function fillGroup(row, { places, fits }) {
    const [name, line, single] = /** @type {[HTMLElement, HTMLElement, HTMLElement]} */ ([...row.children]);
    const [own, button] = /** @type {[HTMLInputElement, HTMLButtonElement]} */ ([...line.children]);
    const [fit] = fits;
    setText(name, `${fits.length} × ${sizeText(fit.pin)} in ${sizeText(fit.hole)}: ${places.join(' × ')}`);
    own.placeholder = codeOf(fit) || 'H7/g6';
    own.setAttribute('aria-label', `Fit for ${name.textContent}`);
    setText(button, `Set for all ${fits.length}`);
    button.setAttribute('aria-label', `Set for all ${fits.length}: ${places.join(' × ')}`);
    button.disabled = busy || codeOf(fit, own.value.trim()) === '';
    button.onclick = () => set(fits, own.value.trim());
    keepRows(/** @type {HTMLElement} */ (single.lastElementChild), fits, (one) => [one.bore.part, one.bore.feature, one.shaft.part, one.shaft.feature].join(' '),
      oneRow, (inner, one) => fillOne(inner, one, own.value.trim()));
  }

  function refresh() {
    if (panel.hidden) return;
    proposed = session.mayAct ? proposedFits(session) : [];
    const mine = last.filter(isMine).length;
    box.hidden = proposed.length === 0 && mine === 0;
    asked.hidden = rows.hidden = proposed.length === 0;
    back.hidden = busy || mine === 0;
    setText(back, mine === 1 ? 'Take back what was set' : `Take back the ${mine} that were set`);
    setText(count, `${proposed.length}`);
    all.disabled = busy || proposed.some((fit) => codeOf(fit) === '');
    keepRows(rows, fitGroups(proposed, (id) => session.partName(id)), keyOf, (group) => (group.fits.length > 1 ? groupRow() : oneRow()),
      (row, group) => (group.fits.length > 1 ? fillGroup(row, group) : fillOne(row, group.fits[0])));
  }

  box.addEventListener('submit', (event) => {
    event.preventDefault();
    set(proposed);
  });
  back.onclick = takeBack;
  code.oninput = refresh;
  for (const what of /** @type {const} */ (['scene', 'features', 'me', 'standing'])) session.on(what, refresh);
  return { refresh };
}
