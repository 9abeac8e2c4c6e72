// Where one looks from: the sides, and views that were saved under a name; each of them has a link.
import { linkOf } from '../session/link.js';
import { SavedViews } from '../session/saved_views.js';
import { byId, el, inputById, keepRows, selectById, setText } from './dom.js';
import { icon } from './icons.js';

const SAVE = 'save';

/** @typedef {import('../session/saved_views.js').SavedView} SavedView */

/** @param {import('../desk.js').Desk} desk */
export function makeViews({ session, choice, camera, showAll, say }) {
  const from = selectById('view_from');
  const dialog = /** @type {HTMLDialogElement} */ (byId('views'));
  const list = byId('views_list');
  const name = inputById('view_name');
  const saved = new SavedViews(localStorage);
  const group = el('optgroup', { label: 'Saved' });
  from.append(group);

  function refresh() {
    const views = saved.of(session.name);
    group.replaceChildren(...views.map((view, i) => el('option', { value: `saved ${i}` }, view.name)), el('option', { value: SAVE }, 'Save this view…'));
    keepRows(list, views, (view) => view.name, make, (row, view) => setText(/** @type {Element} */ (row.firstElementChild), view.name));
  }

  /** @param {SavedView} view */
  function make(view) {
    const copy = el('button', { type: 'button', class: 'small', 'aria-label': `Copy the link to ${view.name}`, title: 'Copy its link', onclick: () => copyLink(view) }, icon('link'));
    const forget = el('button', { type: 'button', class: 'small', 'aria-label': `Forget ${view.name}`, title: 'Forget it', onclick: () => {
      saved.forget(session.name, view.name);
      refresh();
    } }, icon('close'));
    return el('li', {}, el('span', { class: 'grow' }), copy, forget);
  }

  /** @param {SavedView} view */
  async function copyLink({ eye, at, clash }) {
    const text = linkOf(location.href, { session: session.name, clash, tick: session.tick, eye, at });
    await navigator.clipboard.writeText(text).then(() => say('The link to the view is copied', 'good'), () => say(text));
  }

  /** @param {SavedView} view */
  function show({ eye, at, clash }) {
    if (clash && session.clashes.has(clash)) choice.chooseClash(clash);
    camera.stand(eye, at);
  }

  from.onchange = () => {
    const { value } = from;
    from.value = '';
    if (value === SAVE) {
      name.value = choice.clash ? `Clash ${choice.clash}` : `View ${saved.of(session.name).length + 1}`;
      dialog.showModal();
      name.select();
    } else if (value.startsWith('saved ')) show(saved.of(session.name)[Number(value.slice(6))]);
    else if (value) showAll(value);
  };
  byId('view_save').addEventListener('click', (event) => {
    event.preventDefault();
    if (!name.value.trim()) return;
    saved.save(session.name, { name: name.value.trim(), eye: camera.eye, at: camera.at, clash: choice.clash });
    refresh();
  });
  byId('views_close').onclick = () => dialog.close();
  session.on('scene', refresh);
}
