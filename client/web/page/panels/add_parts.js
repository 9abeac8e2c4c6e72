// Parts that people bring as files: dropped on the page or chosen; units are asked once, and what comes of each file is told in its row.
import { ACCEPTED, freeName, partNameOf } from '../session/mesh_file.js';
import { whyNot } from './arriving.js';
import { byId, inputById } from './dom.js';

/** @param {import('../desk.js').Desk} desk @param {ReturnType<typeof import('./arriving.js').makeArriving>} arriving */
export function makeAddParts({ session, choice, partsView, commands, uploads, showAll }, arriving) {
  const button = byId('add_parts');
  const chooser = inputById('add_files');
  /** Names of parts that are on their way. @type {Set<string>} */
  const coming = new Set();
  /** Names of parts that are added and not in the picture yet. @type {Set<string>} */
  const unseen = new Set();
  chooser.accept = ACCEPTED;

  /** @param {File[]} files */
  async function take(files) {
    if (!session.mayAct) {
      if (files.length > 0) arriving.addRow(files[0].name).refuse('join as a designer to add parts');
      return;
    }
    const good = arriving.readable(files);
    const asked = good.length > 0 && await arriving.ask(good, { title: 'Add these parts', go: 'Add', asksMoving: true });
    if (!asked) return;
    let before = Promise.resolve();
    for (const file of good) before = bring(file, asked.unitOf(file), asked.moving, before);
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
    const row = arriving.addRow(name);
    coming.add(name);
    try {
      const { mesh, parts, text } = await uploads.bring(file, unit_mm, row.say);
      row.say('is added');
      await before;
      const why = parts ? await addAll(parts, moving, row.say) : await add({ name, mesh }, moving);
      if (why || text) row.refuse(why || text); // what was found in it stays until it has been read
      else row.end();
    } catch (error) {
      row.refuse(whyNot(error, file));
    }
    coming.delete(name);
    lookAtAdded();
  }

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
