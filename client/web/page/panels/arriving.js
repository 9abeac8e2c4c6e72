// Files on their way to the session: what is asked about them first, and a row for each until it is there.
import { extentOf, extentSaid, formatOf, statedUnit, UNITS } from '../session/mesh_file.js';
import { byId, el, inputById, selectById, setText } from './dom.js';
import { icon } from './icons.js';

const WITHOUT_UNIT_READ_BYTES = 64 << 20; // larger ones are not searched for their extent

/** @typedef {{unitOf: (file: File) => number, moving: boolean}} Asked mm of the numbers of a file; do its parts move? */

export function makeArriving() {
  const rows = byId('arriving');
  const dialog = /** @type {HTMLDialogElement} */ (byId('units'));
  const list = byId('units_list');
  const unit = selectById('units_unit');
  const moves = inputById('units_move');
  /** @type {Array<{file: File, extent: [number, number, number] | null}>} */
  let asked = [];
  /** @type {(go: boolean) => void} */
  let answer = () => {};
  unit.append(...UNITS.map(([name]) => el('option', { value: name }, name)));

  const chosenUnit = () => UNITS.find(([name]) => name === unit.value)?.[1] ?? 1;
  const unitOf = (/** @type {File} */ file) => statedUnit(file.name) || chosenUnit();

  function showExtents() {
    list.replaceChildren(...asked.map(({ file, extent }) => el('li', {}, el('span', { class: 'grow' }, file.name), el('span', { class: 'quiet' }, extentSaid(extent, unitOf(file))))));
  }

  /** @param {string} name */
  function addRow(name) {
    const text = el('span', { class: 'grow' }, `${name}: …`);
    const row = el('li', { role: 'status' }, text);
    rows.append(row);
    return {
      say: (/** @type {string} */ what) => setText(text, `${name}: ${what}`),
      end: () => row.remove(),
      refuse: (/** @type {string} */ why) => {
        row.setAttribute('role', 'alert');
        row.classList.add('bad');
        setText(text, `${name}: ${why}`);
        row.append(el('button', { type: 'button', class: 'small', 'aria-label': `Close: ${name}`, title: 'Close', onclick: () => row.remove() }, icon('close')));
      },
    };
  }

  /**
   * What the files do not say of themselves is asked once for all.
   * @param {File[]} files @param {{title: string, go: string, asksMoving: boolean}} how @returns {Promise<Asked | null>} null: not after all
   */
  async function ask(files, { title, go, asksMoving }) {
    answer(false);
    asked = await Promise.all(files.map(async (file) => ({ file, extent: file.size <= WITHOUT_UNIT_READ_BYTES ? extentOf(file.name, await file.arrayBuffer()) : null })));
    const unitless = files.some((file) => !statedUnit(file.name));
    setText(byId('units_title'), title);
    setText(byId('units_add'), go);
    byId('units_row').hidden = !unitless;
    byId('units_moving').hidden = !asksMoving;
    setText(byId('units_text'), unitless ? `${files.length > 1 ? 'These files do' : 'This file does'} not say in which unit ${files.length > 1 ? 'they are' : 'it is'}.` : '');
    showExtents();
    dialog.returnValue = '';
    dialog.showModal();
    const goes = await new Promise((/** @type {(go: boolean) => void} */ done) => (answer = done));
    const mm = chosenUnit();
    return goes ? { unitOf: (file) => statedUnit(file.name) || mm, moving: moves.checked } : null;
  }

  /** Those that can be read; each of the others has a row that says why not. @param {File[]} files */
  function readable(files) {
    return files.filter((file) => {
      if (formatOf(file.name)) return true;
      addRow(file.name).refuse('neither a mesh nor an assembly: STL, OBJ, GLB or STEP');
      return false;
    });
  }

  unit.onchange = showExtents;
  dialog.addEventListener('close', () => answer(dialog.returnValue === 'add'));
  byId('units_cancel').onclick = () => dialog.close('');
  return { addRow, ask, readable };
}

/** @param {unknown} error @param {File} file @returns {string} without the name, which stands before it */
export function whyNot(error, file) {
  const why = error instanceof Error ? error.message : `${error}`;
  return why.startsWith(`${file.name}: `) ? why.slice(file.name.length + 2) : why;
}
