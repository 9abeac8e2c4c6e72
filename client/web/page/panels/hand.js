// The chosen part in hand: grab and release, where it is, steps by keys, and motion by numbers.
import { coordinate, degrees, radians } from '../session/words.js';
import { rotationVectorOf } from '../session/motion.js';
import { byId, el, seldom, setText } from './dom.js';
import { icon } from './icons.js';
import { makePartEdit } from './part_edit.js';
import { makeStopLine } from './stop_line.js';

/** @typedef {import('../session/motion.js').Vec3} Vec3 */
/** @typedef {import('../session/session.js').Part} Part */

/** mm of a shift, degrees of a turn. */
export const STEPS = /** @type {const} */ ([
  [0.001, 0.001, '1 µm'], [0.01, 0.01, '10 µm'], [0.1, 0.1, '0.1 mm'], [1, 1, '1 mm'], [10, 10, '10 mm'],
]);

/** @param {import('../desk.js').Desk} desk @param {ReturnType<typeof import('./arriving.js').makeArriving>} arriving */
export function makeHand(desk, arriving) {
  const { session, choice, commands, mover } = desk;
  const box = byId('hand');
  const name = el('strong');
  const state = el('span', { class: 'quiet' });
  const pose = el('span', { class: 'pose' });
  const small = (/** @type {string} */ name, /** @type {string} */ title, /** @type {() => void} */ onclick) => el('button', { type: 'button', class: 'small look', 'aria-label': title, title, onclick }, icon(name));
  const hide = small('hide', 'Hide it (D)', () => choice.hide(choice.together));
  const alone = small('isolate', 'Show it alone (I)', () => choice.isolate(choice.together, session.parts.keys()));
  const edit = makePartEdit(desk, arriving);
  const grab = el('button', { type: 'button', class: 'primary' }, icon('grab'), el('span'));
  const ask = el('button', { type: 'button' }, 'Ask for it');
  const kind = el('select', { 'aria-label': 'Shift or turn' }, el('option', { value: 'translate' }, 'Shift, mm'), el('option', { value: 'rotate' }, 'Turn, °'));
  const fields = ['X', 'Y', 'Z'].map((axis) => el('input', { type: 'text', inputMode: 'decimal', value: '0', 'aria-label': `By how much along or about ${axis}` }));
  const go = el('button', { type: 'submit' }, 'Move by');
  const step = el('select', { 'aria-label': 'Step of the arrow keys', title: 'Step of the arrow keys ([ and ])' }, ...STEPS.map(([mm, deg, text]) => el('option', { value: `${mm}` }, `${text} | ${deg}°`)));
  step.value = '1';
  const form = el('form', { class: 'fields' }, kind,
    ...['X', 'Y', 'Z'].flatMap((axis, i) => [el('label', {}, axis), fields[i]]), go, el('span', { class: 'gap' }), el('label', {}, 'Step'), step);
  box.append(el('div', { class: 'title' }, name, state, pose, el('span', { class: 'spring' }), ...edit.buttons, hide, alone, ask, grab), makeStopLine(desk), form);

  const part = () => session.parts.get(choice.part) ?? null;
  const asked = () => session.standing.find((d) => d.kind === 'ask for hand-over' && d.part === choice.part);

  function showPose() {
    const shown = part();
    if (!shown || box.hidden) return;
    const turn = rotationVectorOf(shown.q).map((x) => degrees(x).toFixed(2));
    setText(pose, `${shown.p.map(coordinate).join(', ')} mm · ${turn.join(', ')}°`);
  }

  function refresh() {
    const shown = part();
    box.hidden = !shown;
    if (!shown) return;
    const mine = session.isMine(shown);
    setText(name, shown.name);
    name.title = shown.name;
    setText(state, !shown.moving ? 'fixed' : mine ? 'in your hand' : shown.holder ? `held by ${session.userName(shown.holder)}` : 'free');
    const count = choice.together.length;
    setText(/** @type {Element} */ (grab.lastElementChild), `${mine ? 'Release' : 'Grab'}${count > 1 ? ` ${count} parts` : ''}`);
    grab.hidden = !session.mayAct || !shown.moving || (shown.holder !== 0 && !mine);
    ask.hidden = !session.mayAct || shown.holder === 0 || mine;
    const waits = asked()?.user === session.me;
    setText(ask, waits ? 'Ask no longer' : 'Ask for it');
    ask.onclick = () => commands.ask(waits ? 'withdraw' : 'ask', { part: shown.id });
    form.hidden = !mine;
    edit.refresh(shown);
    showPose();
  }

  /** @returns {Promise<void>} */
  async function toggle() {
    const shown = part();
    if (!shown || !session.mayAct) return;
    const mine = session.isMine(shown);
    if (mine) mover.drop(shown.id);
    const { tool } = choice; // who takes another one before the answer keeps it
    const parts = choice.together;
    const reply = await commands.ask(mine ? 'release' : 'grab', parts.length > 1 ? { parts } : { part: shown.id });
    if (!reply.done || choice.tool !== tool) return;
    if (mine) choice.chooseTool('select');
    else if (tool === 'select') choice.chooseTool('move');
  }

  /** One step along or about a world axis. @param {number} axis @param {number} sign @param {boolean} turn */
  function stepBy(axis, sign, turn) {
    const shown = part();
    if (!shown || !session.isMine(shown)) return false;
    const size = Number(step.value) * sign;
    const along = /** @type {Vec3} */ ([0, 1, 2].map((i) => (i === axis ? (turn ? radians(size) : size) : 0)));
    mover.glide(shown.id, turn ? { t: [0, 0, 0], r: along } : { t: along, r: [0, 0, 0] });
    return true;
  }

  /** @param {number} by places in the list of steps */
  function changeStep(by) {
    step.selectedIndex = Math.min(STEPS.length - 1, Math.max(0, step.selectedIndex + by));
  }

  form.addEventListener('submit', (event) => {
    event.preventDefault();
    const shown = part();
    const values = fields.map((field) => Number(field.value.replace(',', '.').replace('−', '-')));
    fields.forEach((field, i) => field.setAttribute('aria-invalid', String(!Number.isFinite(values[i]))));
    if (!shown || !values.every(Number.isFinite)) return;
    const vector = /** @type {Vec3} */ (kind.value === 'rotate' ? values.map(radians) : values);
    mover.glide(shown.id, kind.value === 'rotate' ? { t: [0, 0, 0], r: vector } : { t: vector, r: [0, 0, 0] });
    for (const field of fields) field.value = '0'; // a second Enter is no second move
  });
  kind.onchange = () => choice.chooseTool(kind.value === 'rotate' ? 'rotate' : 'move');
  choice.on('tool', (tool) => {
    if (tool === 'rotate' || tool === 'move') kind.value = tool === 'rotate' ? 'rotate' : 'translate';
  });
  grab.onclick = toggle;
  const poseSoon = seldom(showPose, 60);
  session.on('poses', poseSoon);
  for (const what of /** @type {const} */ (['scene', 'holder', 'me', 'standing', 'users'])) session.on(what, refresh);
  choice.on('part', refresh);
  choice.on('group', refresh);
  return { toggle, stepBy, changeStep };
}
