// The list of parts: search, who holds what, what moves and what stands, what clashes.
import { rankOf, worstOf } from '../session/words.js';
import { byId, el, inputById, keepRows, seldom, selectById, setText } from './dom.js';
import { classMark } from './icons.js';
import { markChosen, walkable } from './list_keys.js';

/** @typedef {import('../session/session.js').Part} Part */

/** @param {import('../desk.js').Desk} desk */
export function makeTree({ session, choice, partsView, showPart }) {
  const list = byId('parts');
  const search = inputById('parts_search');
  const filter = selectById('parts_filter');

  /** @param {Part} part */
  function wanted(part) {
    const text = search.value.trim().toLowerCase();
    if (text && !part.name.toLowerCase().includes(text)) return false;
    switch (filter.value) {
      case 'moving':
        return part.moving;
      case 'held':
        return part.holder !== 0;
      case 'mine':
        return session.isMine(part);
      case 'clash':
        return part.classes !== 0;
      default:
        return true;
    }
  }

  function make(/** @type {Part} */ part) {
    const colour = `#${partsView.looks.colourOf(part).toString(16).padStart(6, '0')}`;
    const swatch = el('span', { class: part.moving ? 'swatch' : 'swatch fixed' });
    swatch.style.backgroundColor = colour;
    return el('li', { role: 'option', id: `part_${part.id}` }, swatch, el('span', { class: 'grow' }), el('span', { class: 'tag' }), el('span'));
  }

  function fill(/** @type {HTMLElement} */ row, /** @type {Part} */ part) {
    const [, name, tag, marks] = /** @type {HTMLElement[]} */ ([...row.children]);
    const notes = part.notes ?? [];
    setText(name, notes.length ? `${part.name} ⚠` : part.name);
    name.title = [part.name, ...notes].join('\n');
    const mine = session.isMine(part);
    const holder = part.holder ? (mine ? 'you' : session.userName(part.holder)) : part.moving ? '' : 'fixed';
    setText(tag, holder);
    tag.className = mine ? 'tag mine' : part.holder ? 'tag' : 'quiet';
    tag.title = part.holder ? `held by ${holder}` : '';
    const worst = worstOf(part.classes);
    if (marks.dataset.worst !== worst) {
      marks.dataset.worst = worst;
      marks.replaceChildren(...(rankOf(worst) ? [classMark(worst)] : []));
    }
    const words = [part.name, part.moving ? 'moving' : 'fixed', part.holder ? `held by ${holder}` : '', rankOf(worst) ? `${worst} clash` : '', choice.group.has(part.id) ? 'gathered' : '', choice.hidden.has(part.id) ? 'hidden' : '', ...notes];
    row.classList.toggle('gathered', choice.group.has(part.id));
    row.classList.toggle('hidden', choice.hidden.has(part.id));
    const label = words.filter(Boolean).join(', ');
    if (row.getAttribute('aria-label') !== label) row.setAttribute('aria-label', label);
  }

  function refresh() {
    const parts = [...session.parts.values()].filter(wanted);
    parts.sort((a, b) => Number(b.moving) - Number(a.moving) || a.name.localeCompare(b.name, 'en', { numeric: true }));
    keepRows(list, parts, (part) => `${part.id}`, make, fill);
    markChosen(list, `${choice.part}`);
    const all = session.parts.size;
    byId('hidden_row').hidden = choice.hidden.size === 0;
    setText(byId('hidden_count'), `${choice.hidden.size} hidden`);
    setText(byId('parts_count'), parts.length === all ? `${all}` : `${parts.length} of ${all}`);
  }

  const soon = seldom(refresh, 80);
  walkable(list, () => `${choice.part}`, (key) => choice.choosePart(Number(key)), (key) => showPart(Number(key)), (key) => choice.gather(Number(key)));
  search.addEventListener('input', refresh);
  filter.addEventListener('change', refresh);
  session.on('scene', () => {
    list.replaceChildren();
    refresh();
  });
  session.on('holder', soon);
  session.on('clashes', soon);
  session.on('me', soon);
  session.on('users', soon);
  choice.on('group', refresh);
  choice.on('hidden', refresh);
  byId('show_hidden').onclick = () => choice.showAll();
  choice.on('part', (part) => markChosen(list, `${part}`, true));
  // Class bits come with poses, many times a second.
  const classes = seldom(refresh, 400);
  session.on('poses', classes);
}
