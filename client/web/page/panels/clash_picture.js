// The picture of the verdict, as `judge --picture` draws it: made by the gateway from the session's log when it is asked for, small in the panel, and large.
import { pictureAge, pictureSaid } from '../session/picture_words.js';
import { el, setText } from './dom.js';

/** @typedef {import('../session/session.js').Clash} Clash */

/** @param {import('../desk.js').Desk} desk @param {() => Clash | null} current */
export function makeClashPicture({ session, connection }, current) {
  const small = el('img', {});
  const large = el('img', {});
  const enlarge = el('button', { type: 'button', 'aria-haspopup': 'dialog', title: 'Enlarge the picture' }, small);
  const line = el('p', { role: 'status' });
  const figure = el('div', { class: 'picture', hidden: true }, enlarge, line);
  const title = el('h2', { id: 'picture_title' });
  const sheet = el('div', { class: 'sheet', tabIndex: 0, role: 'group', 'aria-label': 'Picture, scrolls where it is larger than the window' }, large);
  const close = el('button', { type: 'button', onclick: () => dialog.close() }, 'Close');
  const dialog = el('dialog', { class: 'picture_large', 'aria-labelledby': 'picture_title' }, title, sheet, el('div', { class: 'row' }, close));
  document.body.append(dialog);
  enlarge.onclick = () => dialog.showModal();
  /** What is shown, as it was when it was asked for. @type {Clash | null} */
  let shown = null;
  let asked = 0;

  function drop() {
    ++asked;
    if (small.src) URL.revokeObjectURL(small.src);
    for (const img of [small, large]) img.removeAttribute('src');
    shown = null;
    figure.hidden = true;
    setText(line, '');
    if (dialog.open) dialog.close();
  }

  /** @param {Clash} clash @param {string} source */
  function put(clash, source) {
    if (small.src) URL.revokeObjectURL(small.src);
    shown = clash;
    const said = pictureSaid(clash, (id) => session.partName(id));
    for (const img of [small, large]) {
      img.src = source;
      img.alt = said;
    }
    enlarge.setAttribute('aria-label', `Enlarge the picture: ${said}`);
    setText(title, `#${clash.clash} ${session.partName(clash.a)} × ${session.partName(clash.b)}: ${clash.class}`);
    enlarge.hidden = false;
    refresh();
  }

  /** Asks the gateway for it; the line says how it goes. */
  async function ask() {
    const clash = current();
    if (!clash) return;
    figure.hidden = false;
    enlarge.hidden = shown === null;
    if (!session.hasReport) {
      setText(line, 'No picture: the gateway knows no log. Start it with mortise web --read-log FILE');
      return;
    }
    const mine = ++asked;
    setText(line, 'The picture is being drawn');
    try {
      const svg = await connection.picture(clash.clash, clash.tick);
      if (mine === asked) put({ ...clash }, URL.createObjectURL(new Blob([svg], { type: 'image/svg+xml' })));
    } catch (error) {
      if (mine === asked) setText(line, error instanceof Error ? error.message : `${error}`);
    }
    figure.scrollIntoView({ block: 'nearest' });
  }

  /** The clash of the panel has changed, or another one is there. */
  function refresh() {
    const clash = current();
    if (shown && clash) setText(line, pictureAge(shown, clash));
  }

  return { figure, ask, drop, refresh };
}
