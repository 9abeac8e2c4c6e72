// What is asked of parts: fits, tolerances, pairs that are left out. The list is what is in force, of the scenario and since; the form asks for more.
import { plain } from '../session/words.js';
import { byId, el, keepRows, setText } from './dom.js';

/** @typedef {import('../session/session.js').Part} Part */

const KINDS = /** @type {const} */ ([['fit', 'Fit', 'Ø20 H7/g6, empty: none'], ['tolerance', 'Tolerance', '±0.05 or H7, empty: none'], ['exclude', 'Leave out', 'Why']]);

/** @param {import('../desk.js').Desk} desk */
export function makeRules({ session, commands, say }) {
  const panel = byId('rules_panel');
  const kind = el('select', { 'aria-label': 'Kind of rule' }, ...KINDS.map(([value, text]) => el('option', { value }, text)));
  const list = () => el('select', { class: 'grow' });
  const [part, feature, other, otherFeature] = [list(), list(), list(), list()];
  const text = el('input', { type: 'text', maxLength: 200, 'aria-label': 'Value' });
  const set = el('button', { type: 'submit', class: 'primary' }, 'Set');
  for (const [select, name] of /** @type {const} */ ([[part, 'Part'], [feature, 'Feature'], [other, 'Second part'], [otherFeature, 'Feature of the second part']])) {
    select.setAttribute('aria-label', name);
  }
  const first = el('div', { class: 'row' }, part, feature);
  const second = el('div', { class: 'row' }, other, otherFeature);
  const form = el('form', { class: 'rule' }, kind, first, second, el('div', { class: 'row' }, text, set));
  const title = el('h2', {}, 'In force ', el('span', { class: 'count' }));
  const search = el('input', { type: 'search', placeholder: 'Search rules', 'aria-label': 'Search rules', oninput: () => refreshList() });
  const rules = el('ul', { class: 'list', 'aria-label': 'Rules in force' });
  panel.append(form, title, search, rules);

  /** @param {HTMLSelectElement} select @param {string} none @param {Array<[string, string]>} options */
  function fill(select, none, options) {
    const before = select.value;
    select.replaceChildren(el('option', { value: '' }, none), ...options.map(([value, name]) => el('option', { value }, name)));
    select.value = options.some(([value]) => value === before) ? before : '';
  }

  /** @param {HTMLSelectElement} of */
  function features(of) {
    return (session.features.get(Number(of.value)) ?? []).map(({ name }) => /** @type {[string, string]} */ ([name, plain(name)]));
  }

  function refreshForm() {
    const parts = [...session.parts.values()].map(({ id, name }) => /** @type {[string, string]} */ ([`${id}`, name]));
    parts.sort(([, a], [, b]) => a.localeCompare(b, 'en', { numeric: true }));
    fill(part, 'part', parts);
    fill(other, 'with part', parts.filter(([id]) => id !== part.value));
    fill(feature, 'all faces', features(part));
    fill(otherFeature, 'all faces', features(other));
    feature.hidden = otherFeature.hidden = kind.value === 'exclude';
    second.hidden = kind.value === 'tolerance';
    text.placeholder = KINDS.find(([value]) => value === kind.value)?.[2] ?? '';
    for (const control of [kind, part, feature, other, otherFeature, text]) control.disabled = !session.mayAct;
    set.disabled = !session.mayAct || !part.value || (kind.value !== 'tolerance' && !other.value);
  }

  /** Each with a key of what it is about. */
  function inForce() {
    return session.standing.filter((d) => d.kind === 'set exclusion' || (d.kind === 'set tolerance' && d.text))
      .map((d) => /** @type {[string, any]} */ ([[d.kind, d.part, d.feature, d.other, d.other_feature].join(' '), d]));
  }

  /** @param {number} id @param {string} name */
  const place = (id, name) => `${session.partName(id)}${name ? `.${plain(name)}` : ''}`;

  /** @param {any} d */
  function sentence(d) {
    const where = d.other ? `${place(d.part, d.feature)} × ${place(d.other, d.other_feature)}` : place(d.part, d.feature);
    const what = d.kind === 'set exclusion' ? `left out${d.text ? `: ${d.text}` : ''}` : d.text;
    return `${where} ${what}`;
  }

  function refreshList() {
    rules.querySelector('.empty')?.remove();
    const all = inForce();
    const wanted = search.value.trim().toLowerCase();
    const rows = all.filter(([, d]) => sentence(d).toLowerCase().includes(wanted));
    // What was decided here stands before what the scenario says.
    rows.sort(([, x], [, y]) => Number(y.user !== 0) - Number(x.user !== 0) || sentence(x).localeCompare(sentence(y), 'en', { numeric: true }));
    setText(/** @type {Element} */ (title.lastElementChild), rows.length === all.length ? `${all.length}` : `${rows.length} of ${all.length}`);
    keepRows(rules, rows, ([key]) => key, ([key]) => el('li', { id: `rule_${key.replaceAll(' ', '_')}` }, el('span', { class: 'grow' }), el('span', { class: 'quiet' }), el('button', { type: 'button' })),
      (row, [, d]) => {
        const [name, by, drop] = /** @type {[HTMLElement, HTMLElement, HTMLButtonElement]} */ ([...row.children]);
        setText(name, sentence(d));
        setText(by, d.user ? session.userName(d.user) : 'scenario');
        name.title = name.textContent ?? '';
        setText(drop, d.kind === 'set exclusion' ? 'Judge again' : 'Drop');
        drop.setAttribute('aria-label', `${drop.textContent}: ${name.title}`);
        drop.disabled = !session.mayAct;
        drop.onclick = () => take(d);
      });
    if (all.every(([, d]) => !d.user)) rules.append(el('li', { class: 'empty' }, 'Nothing was changed since the scenario'));
  }

  /** @param {any} d */
  function take(d) {
    if (d.kind === 'set exclusion') return commands.ask('include', { part: d.part, other: d.other });
    return d.other ? commands.ask('fit', keysOf(d.part, d.feature, d.other, d.other_feature, '')) : commands.ask('tolerance', { part: d.part, ...(d.feature ? { feature: d.feature } : {}), text: '' });
  }

  /** @param {number} a @param {string} face @param {number} b @param {string} otherFace @param {string} value */
  function keysOf(a, face, b, otherFace, value) {
    return { part: a, ...(face ? { feature: face } : {}), other: b, ...(otherFace ? { other_feature: otherFace } : {}), text: value };
  }

  form.addEventListener('submit', async (event) => {
    event.preventDefault();
    const [a, b] = [Number(part.value), Number(other.value)];
    const value = text.value.trim();
    const keys = kind.value === 'fit' ? keysOf(a, feature.value, b, otherFeature.value, value)
      : kind.value === 'exclude' ? { part: a, other: b, text: value } : { part: a, ...(feature.value ? { feature: feature.value } : {}), text: value };
    const reply = await commands.ask(kind.value, keys);
    if (reply.done && !reply.text) say('Set', 'good');
  });
  const refresh = () => {
    if (panel.hidden) return;
    refreshForm();
    refreshList();
  };
  for (const select of [kind, part, other]) select.onchange = refreshForm;
  for (const what of /** @type {const} */ (['scene', 'features', 'me', 'standing'])) session.on(what, refresh);
  return { refresh };
}
