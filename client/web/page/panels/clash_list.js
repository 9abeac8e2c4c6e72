// The list of clashes: worst first, filtered by class, state of review and person; a click flies there.
import { GROUPINGS, inGroups } from '../session/groups.js';
import { CLASSES, STATUSES, bracket, plain, rankOf, small } from '../session/words.js';
import { byId, el, keepRows, seldom, setPressed, setText } from './dom.js';
import { fillDepthBar } from './depth_bar.js';
import { classMark } from './icons.js';
import { markChosen, walkable } from './list_keys.js';

/** @typedef {import('../session/session.js').Clash} Clash */

/** @param {import('../desk.js').Desk} desk */
export function makeClashList({ session, choice, flyToClash, heat }) {
  const list = byId('clashes');
  const classes = new Set(/** @type {string[]} */ (['real', 'potential', 'fake']));
  const [status, who, grouping] = makeFilters();

  function makeFilters() {
    const box = byId('clash_filters');
    const chips = CLASSES.map((name) => {
      const chip = el('button', { class: 'chip', type: 'button', title: `Show ${name} clashes`, 'aria-label': `Show ${name} clashes`, 'aria-pressed': 'true' }, classMark(name), name);
      chip.onclick = () => {
        if (!classes.delete(name)) classes.add(name);
        setPressed(chip, classes.has(name));
        refresh();
      };
      return chip;
    });
    const states = el('select', { 'aria-label': 'State', onchange: () => refresh() },
      el('option', { value: 'open' }, 'Open'), el('option', { value: 'todo' }, 'To review'), el('option', { value: 'ended' }, 'Ended'), el('option', { value: 'all' }, 'All'),
      ...STATUSES.map((name) => el('option', { value: name }, plain(name))));
    const people = el('select', { 'aria-label': 'Whose', onchange: () => refresh() },
      el('option', { value: 'all' }, 'Anybody'), el('option', { value: 'mine' }, 'My parts'), el('option', { value: 'task' }, 'My task'), el('option', { value: 'chosen' }, 'This part'));
    const groups = el('select', { 'aria-label': 'Groups', onchange: () => refresh() }, ...GROUPINGS.map(([value, text]) => el('option', { value }, text)));
    const faces = el('button', { class: 'chip', type: 'button', 'aria-pressed': 'true', title: 'Colour the faces that clash' }, 'Heat');
    faces.onclick = () => {
      heat.on = !heat.on;
      setPressed(faces, heat.on);
      showHeat();
    };
    box.append(...chips, states, people, groups, faces);
    return [states, people, groups];
  }

  /** @param {Clash} clash */
  function wanted(clash) {
    if (!classes.has(clash.ended ? clash.worst_class : clash.class)) return false;
    const open = !clash.ended;
    const review = clash.review?.status ?? 'new';
    const rightState = { open, todo: open && (review === 'new' || review === 'active'), ended: !open, all: true }[status.value] ?? review === status.value;
    if (!rightState) return false;
    const parts = [session.parts.get(clash.a), session.parts.get(clash.b)];
    if (who.value === 'task') return session.me !== 0 && session.assigneeOf(clash.clash) === session.me;
    if (who.value === 'mine') return clash.mover === session.me || parts.some((part) => part && session.isMine(part));
    return who.value !== 'chosen' || clash.a === choice.part || clash.b === choice.part;
  }

  function make(/** @type {Clash} */ clash) {
    return el('li', { role: 'option', id: `clash_${clash.clash}` },
      el('span'), el('span', { class: 'quiet' }), el('span', { class: 'grow' }), el('span', { class: 'tag' }),
      el('span', { class: 'figures' }, el('span'), el('span', { class: 'depth' }), el('span')));
  }

  function fill(/** @type {HTMLElement} */ row, /** @type {Clash} */ clash) {
    const task = session.assigneeOf(clash.clash);
    const figure = `${clash.seq} ${clash.ended} ${task} ${session.partName(clash.a)} ${session.partName(clash.b)}`;
    if (row.dataset.figure === figure) return;
    row.dataset.figure = figure;
    const [mark, number, name, tag, figures] = /** @type {HTMLElement[]} */ ([...row.children]);
    const of = clash.ended ? clash.worst_class : clash.class;
    mark.replaceChildren(classMark(of));
    const pair = `${session.partName(clash.a)} × ${session.partName(clash.b)}`;
    setText(number, `#${clash.clash}`);
    setText(name, pair);
    name.title = pair;
    const review = clash.review?.status ?? 'new';
    const state = clash.ended ? 'ended' : clash.approval_lost ? 'approval lost' : review;
    setText(tag, task ? `${state}, ${session.userName(task)}` : state);
    row.classList.toggle('ended', clash.ended === true);
    const [depth, bar, margin] = /** @type {HTMLElement[]} */ ([...figures.children]);
    setText(depth, small(clash.delta[1]));
    fillDepthBar(bar, clash);
    const chance = clash.probability === null ? '–' : `P ${(100 * clash.probability).toFixed(0)} %`;
    setText(margin, of === 'potential' ? chance : `${small(clash.margin)} ${of === 'real' ? 'beyond' : 'spare'}`);
    row.setAttribute('aria-label', `${of}, ${pair}, overlap ${bracket(clash.delta)}, margin ${small(clash.margin)}, ${clash.ended ? 'ended' : review}, number ${clash.clash}`);
  }

  /** @typedef {{head: string, clashes: Clash[]}} Head of a group */
  /** @param {Head | Clash} row @returns {row is Head} */
  const isHead = (row) => 'head' in row;

  function fillHead(/** @type {HTMLElement} */ row, /** @type {Head} */ { head, clashes }) {
    const [name, counts] = /** @type {HTMLElement[]} */ ([...row.children]);
    setText(name, head);
    name.title = head;
    const of = (/** @type {string} */ wanted) => clashes.filter((clash) => (clash.ended ? clash.worst_class : clash.class) === wanted).length;
    setText(counts, CLASSES.filter((wanted) => of(wanted) > 0).map((wanted) => `${wanted[0].toUpperCase()} ${of(wanted)}`).join(' · '));
  }

  function refresh() {
    const clashes = [...session.clashes.values()].filter(wanted);
    clashes.sort((a, b) => Number(a.ended ?? false) - Number(b.ended ?? false) || rankOf(b.class) - rankOf(a.class) || b.margin - a.margin || a.clash - b.clash);
    list.querySelector('.empty')?.remove();
    const rows = inGroups(clashes, grouping.value, (id) => session.partName(id)).flatMap(({ name, clashes: of }) => /** @type {Array<Head | Clash>} */ (name ? [{ head: name, clashes: of }, ...of] : of));
    keepRows(list, rows, (row) => (isHead(row) ? `head ${row.head}` : `${row.clash}`),
      (row) => (isHead(row) ? el('li', { class: 'head', role: 'presentation' }, el('span', { class: 'grow' }), el('span', { class: 'quiet' })) : make(row)),
      (row, of) => (isHead(of) ? fillHead(row, of) : fill(row, of)));
    if (clashes.length === 0) {
      const open = session.openClashes().length;
      list.append(el('li', { class: 'empty', role: 'option', 'aria-disabled': 'true' }, open ? `${open} open, none that these filters show` : 'No clash is open'));
    }
    markChosen(list, `${choice.clash}`);
    const count = (/** @type {string} */ name) => session.openClashes().filter((clash) => clash.class === name).length;
    const text = CLASSES.map((name) => `${name[0].toUpperCase()} ${count(name)}`).join(' · ');
    setText(byId('clash_counts'), text);
    byId('clash_counts').setAttribute('aria-label', CLASSES.map((name) => `${count(name)} ${name}`).join(', '));
  }

  function showHeat() {
    const open = session.openClashes().filter(({ clash, a, b }) => clash === choice.clash || !(choice.hidden.has(a) || choice.hidden.has(b)));
    open.sort((a, b) => rankOf(a.class) - rankOf(b.class));
    heat.show(choice.clash ? open.filter((clash) => clash.clash === choice.clash) : open, choice.clash !== 0);
  }

  const soon = seldom(() => {
    refresh();
    showHeat();
  }, 60);
  walkable(list, () => `${choice.clash}`, (key) => choice.chooseClash(Number(key)), (key) => flyToClash(Number(key)));
  for (const what of /** @type {const} */ (['clashes', 'scene', 'remarks', 'users'])) session.on(what, soon);
  session.on('features', () => {
    heat.clear();
    soon();
  });
  session.on('poses', seldom(() => heat.follow(), 150));
  session.on('me', soon);
  choice.on('part', soon);
  choice.on('hidden', showHeat);
  choice.on('clash', (clash) => {
    markChosen(list, `${clash}`, true);
    showHeat();
  });
}
