// Parts that people bring as files: dropped on the page or chosen; units are asked once, and what comes of each file is told in its row.
import { ACCEPTED, UNITS, extentOf, extentSaid, formatOf, freeName, partNameOf, statedUnit } from '../session/mesh_file.js';
import { byId, el, inputById, selectById, setText } from './dom.js';
import { icon } from './icons.js';

const WITHOUT_UNIT_READ_BYTES = 64 << 20; // larger ones are not searched for their extent

/** @param {import('../desk.js').Desk} desk */
export function makeAddParts({ session, choice, partsView, commands, uploads, showAll }) {
  const rows = byId('arriving');
  const button = byId('add_parts');
  const chooser = inputById('add_files');
  const dialog = /** @type {HTMLDialogElement} */ (byId('units'));
  const list = byId('units_list');
  const unit = selectById('units_unit');
  const moves = inputById('units_move');
  /** Names of parts that are on their way. @type {Set<string>} */
  const coming = new Set();
  /** Names of parts that are added and not in the picture yet. @type {Set<string>} */
  const unseen = new Set();
  /** @type {Array<{file: File, extent: [number, number, number] | null}>} */
  let asked = [];
  chooser.accept = ACCEPTED;
  unit.append(...UNITS.map(([name]) => el('option', { value: name }, name)));

  const unitOf = () => UNITS.find(([name]) => name === unit.value)?.[1] ?? 1;

  function showExtents() {
    list.replaceChildren(...asked.map(({ file, extent }) => el('li', {}, el('span', { class: 'grow' }, file.name), el('span', { class: 'quiet' }, extentSaid(extent, statedUnit(file.name) || unitOf())))));
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

  /** @param {File[]} files */
  async function take(files) {
    if (!session.mayAct) {
      if (files.length > 0) addRow(files[0].name).refuse('join as a designer to add parts');
      return;
    }
    const good = [];
    for (const file of files) {
      if (formatOf(file.name)) good.push(file);
      else addRow(file.name).refuse('neither a mesh nor an assembly: STL, OBJ, GLB or STEP');
    }
    if (good.length === 0) return;
    asked = await Promise.all(good.map(async (file) => ({ file, extent: file.size <= WITHOUT_UNIT_READ_BYTES ? extentOf(file.name, await file.arrayBuffer()) : null })));
    const unitless = good.some((file) => !statedUnit(file.name));
    byId('units_row').hidden = !unitless;
    setText(byId('units_text'), unitless ? 'These files do not say in which unit they are.' : '');
    showExtents();
    dialog.returnValue = '';
    dialog.showModal();
  }

  const isTaken = (/** @type {string} */ name) => coming.has(name) || unseen.has(name) || [...session.parts.values()].some((part) => part.name === name);

  /** @param {{name: string, mesh: string}} part @param {boolean} moving @returns {Promise<string>} why not; empty: it is there */
  async function add(part, moving) {
    unseen.add(part.name);
    const reply = await commands.ask('add_part', { ...part, moving });
    if (!reply.done) unseen.delete(part.name);
    return reply.done ? '' : reply.text || reply.refusal || 'refused';
  }

  /** Of one file, each where the file has it. @param {import('../session/uploads.js').Brought[]} parts @param {boolean} moving @param {(said: string) => void} say */
  async function addAll(parts, moving, say) {
    for (const [i, part] of parts.entries()) {
      say(`part ${i + 1} of ${parts.length} is added`);
      const name = freeName(part.name, isTaken);
      const why = await add({ ...part, name }, moving);
      if (why) return `${name}: ${why}`;
    }
    return '';
  }

  /** Files come at one time, parts in the order of their files. @param {File} file @param {number} unit_mm @param {boolean} moving @param {Promise<void>} before */
  async function bring(file, unit_mm, moving, before) {
    const name = partNameOf(file.name, isTaken);
    const row = addRow(name);
    coming.add(name);
    try {
      const { mesh, parts, text } = await uploads.bring(file, unit_mm, row.say);
      row.say('is added');
      await before;
      const why = parts ? await addAll(parts, moving, row.say) : await add({ name, mesh }, moving);
      if (why || text) row.refuse(why || text); // what was found in it stays until it has been read
      else row.end();
    } catch (error) {
      const why = error instanceof Error ? error.message : `${error}`;
      row.refuse(why.startsWith(`${file.name}: `) ? why.slice(file.name.length + 2) : why);
    }
    coming.delete(name);
    lookAtAdded();
  }

  unit.onchange = showExtents;
  dialog.addEventListener('close', () => {
    if (dialog.returnValue !== 'add') return;
    let before = Promise.resolve();
    for (const { file } of asked) before = bring(file, statedUnit(file.name) || unitOf(), moves.checked, before);
  });
  byId('units_cancel').onclick = () => dialog.close('');
  button.onclick = () => chooser.click();
  chooser.onchange = () => {
    take([...(chooser.files ?? [])]);
    chooser.value = '';
  };
  const bringsFiles = (/** @type {DragEvent} */ event) => event.dataTransfer?.types.includes('Files') === true;
  document.addEventListener('dragover', (event) => {
    if (!bringsFiles(event)) return;
    event.preventDefault();
    document.body.classList.add('dropping');
  });
  document.addEventListener('dragleave', (event) => event.relatedTarget === null && document.body.classList.remove('dropping'));
  document.addEventListener('drop', (event) => {
    if (!bringsFiles(event)) return;
    event.preventDefault();
    document.body.classList.remove('dropping');
    take([...(event.dataTransfer?.files ?? [])]);
  });

  /** Who has added parts looks at all of them once they are in the picture. */
  function lookAtAdded() {
    const seen = new Set([...partsView.shown.values()].map(({ part }) => part.name));
    if (unseen.size === 0 || coming.size > 0 || [...unseen].some((name) => !seen.has(name))) return;
    unseen.clear();
    showAll();
  }

  function refresh() {
    button.hidden = !session.mayAct;
    byId('no_parts').hidden = session.parts.size > 0 || !session.mayAct;
  }
  choice.on('framed', lookAtAdded);
  session.on('upload', (told) => uploads.take(told));
  session.on('scene', refresh);
  session.on('me', refresh);
}
