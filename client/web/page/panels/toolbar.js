// The bar above: tools, views, undo, what a contact does. Each button has its key in panels/keyboard.js.
import { POLICIES } from '../session/words.js';
import { byId, el, selectById, setPressed } from './dom.js';
import { drawIcons } from './icons.js';
import { pictureOf } from '../view/picture.js';

/** @typedef {import('../session/choice.js').Tool} Tool */

/** @param {import('../desk.js').Desk} desk */
export function makeToolbar({ session, choice, commands, section, mover, showAll, showPart, partsView, ground, stage, say }) {
  drawIcons(document);
  const policy = selectById('policy');
  policy.append(...POLICIES.map(([value, text]) => el('option', { value, title: text }, value[0].toUpperCase() + value.slice(1))));

  /** A tool of the hand takes the part in hand. @param {Tool} tool */
  async function chooseTool(tool) {
    const part = session.parts.get(choice.part);
    choice.chooseTool(tool);
    if (tool === 'select' || tool === 'measure' || !session.mayAct) return;
    if (!part) say('Choose a part first, in the list or in the view');
    else if (part.moving && part.holder === 0) await commands.ask('grab', { part: part.id });
  }

  /** @param {'undo' | 'redo' | 'reset'} what */
  function change(what) {
    if (!choice.part) {
      say(`Choose the part to ${what}`);
      return;
    }
    mover.drop(choice.part);
    commands.ask(what, { part: choice.part });
  }

  function toggleSection() {
    section.bounds = partsView.bounds();
    if (!section.on && section.across !== 'clash') section.centre();
    section.set(!section.on);
  }

  function toggleGround() {
    ground.set(!ground.on);
    setPressed(byId('view_ground'), ground.on);
  }

  async function takePicture() {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(await pictureOf(stage, byId('labels')));
    link.download = `${session.name || 'view'} tick ${session.tick}.png`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
    say('The picture of the view is saved', 'good');
  }

  function hide() {
    if (!choice.part) say('Choose the part to hide');
    else choice.hide(choice.together);
  }

  function isolate() {
    if (!choice.part) say('Choose the part to be shown alone');
    else choice.isolate(choice.together, session.parts.keys());
  }

  function cancel() {
    if (choice.tool !== 'select') choice.chooseTool('select');
    else if (choice.clash) choice.chooseClash(0);
    else if (section.on) section.set(false);
    else if (choice.group.size > 0) choice.ungather();
    else choice.choosePart(0);
  }

  function refresh() {
    policy.value = session.policy;
    policy.disabled = !session.mayAct;
    const part = session.parts.get(choice.part);
    const can = session.mayAct && part?.moving === true;
    for (const what of ['undo', 'redo', 'reset']) /** @type {HTMLButtonElement} */ (byId(`do_${what}`)).disabled = !can;
    for (const tool of ['move', 'rotate', 'align']) /** @type {HTMLButtonElement} */ (byId(`tool_${tool}`)).disabled = !session.mayAct;
    /** @type {HTMLButtonElement} */ (byId('view_part')).disabled = !part;
  }

  for (const tool of /** @type {const} */ (['select', 'move', 'rotate', 'align', 'measure'])) byId(`tool_${tool}`).onclick = () => chooseTool(tool);
  byId('view_fit').onclick = () => showAll();
  byId('view_part').onclick = () => showPart(choice.part);
  byId('view_section').onclick = toggleSection;
  byId('view_ghost').onclick = () => choice.setGhost(!choice.ghost);
  byId('view_ground').onclick = toggleGround;
  setPressed(byId('view_ground'), ground.on);
  byId('view_picture').onclick = takePicture;
  byId('do_undo').onclick = () => change('undo');
  byId('do_redo').onclick = () => change('redo');
  byId('do_reset').onclick = () => change('reset');
  const more = byId('more_tools');
  more.onclick = () => more.setAttribute('aria-expanded', String(more.getAttribute('aria-expanded') === 'false'));
  policy.onchange = async () => {
    await commands.ask('policy', { text: policy.value });
    refresh();
  };
  choice.on('tool', (tool) => {
    for (const name of ['select', 'move', 'rotate', 'align', 'measure']) setPressed(byId(`tool_${name}`), name === tool);
  });
  choice.on('ghost', (on) => setPressed(byId('view_ghost'), on));
  choice.on('part', refresh);
  for (const what of /** @type {const} */ (['me', 'scene', 'decision'])) session.on(what, refresh);
  refresh();
  return { chooseTool, change, toggleSection, toggleGround, cancel, takePicture, hide, isolate };
}
