// Another mesh for a part that is there: a file is chosen, the part keeps its name, its place and who holds it.
import { ACCEPTED } from '../session/mesh_file.js';
import { whyNot } from './arriving.js';
import { inputById } from './dom.js';

/** @typedef {import('../session/session.js').Part} Part */

/**
 * @param {import('../desk.js').Desk} desk @param {ReturnType<typeof import('./arriving.js').makeArriving>} arriving
 * @param {(part: number, what: string) => void} offerUndo
 * @returns {(part: Part) => void} asks for the file
 */
export function makeReplacePart({ commands, uploads }, arriving, offerUndo) {
  const chooser = inputById('replace_file');
  chooser.accept = ACCEPTED;
  /** @type {Part | null} */
  let part = null;

  /** Of a file with several parts the one of this name is meant. @param {import('../session/uploads.js').Brought[]} parts @param {string} name */
  function meshAmong(parts, name) {
    const meant = parts.length === 1 ? parts[0] : parts.find((brought) => brought.name === name);
    if (!meant) throw new Error(`it has ${parts.length} parts, and none is called ${name}: choose a file of one part`);
    return meant.mesh;
  }

  /** @param {Part} part @param {File} file */
  async function take({ id, name }, file) {
    const [good] = arriving.readable([file]);
    const asked = good && await arriving.ask([good], { title: `Replace ${name}`, go: 'Replace', asksMoving: false });
    if (!asked) return;
    const row = arriving.addRow(name);
    try {
      const { mesh, parts } = await uploads.bring(file, asked.unitOf(file), row.say);
      row.say('is replaced');
      const reply = await commands.ask('replace_part', { part: id, mesh: parts ? meshAmong(parts, name) : mesh });
      if (!reply.done) return row.refuse(reply.text || reply.refusal || 'refused');
      row.end();
      offerUndo(id, `${name} is replaced`);
    } catch (error) {
      row.refuse(whyNot(error, file));
    }
  }

  chooser.onchange = () => {
    const file = chooser.files?.[0];
    if (part && file) take(part, file);
    chooser.value = '';
  };
  return (chosen) => {
    part = chosen;
    chooser.click();
  };
}
