// Who are you? Asked once; a line that broke joins again by itself under the same name.
import { byId, inputById, setText } from './dom.js';

const KEPT = 'mortise.name';
/** Of this page alone, for as long as it is open: a new line goes on with what was held on the old one. */
const PAGE = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, '0')).join('');

/** @param {import('../session/session.js').Session} session @param {(message: object) => boolean} send */
export function makeJoin(session, send) {
  const dialog = /** @type {HTMLDialogElement} */ (byId('join'));
  const field = inputById('join_name');
  let name = '';
  field.value = localStorage.getItem(KEPT) ?? '';

  const join = () => name !== '' && send({ type: 'join', name, page: PAGE });

  byId('join_go').addEventListener('click', (event) => {
    event.preventDefault();
    name = field.value.trim();
    if (!name) {
      setText(byId('join_problem'), 'A name, please');
      return;
    }
    setText(byId('join_problem'), '');
    join();
  });
  byId('join_look').onclick = () => {
    name = '';
    dialog.close();
  };
  session.on('me', () => {
    if (session.me === 0) return;
    localStorage.setItem(KEPT, session.myName);
    dialog.close();
  });

  return {
    /** The gateway said welcome. */
    welcome() {
      if (session.boundName) name = session.boundName;
      const observer = session.role === 'observer';
      if (session.mode === 'replay' || (observer && name === '')) return;
      if (!join() && !dialog.open) dialog.showModal();
    },
    /** @param {string} text */
    refused(text) {
      name = '';
      setText(byId('join_problem'), text);
      if (!dialog.open) dialog.showModal();
    },
    ask() {
      if (session.me === 0 && session.role === 'designer' && session.mode === 'live' && !dialog.open) dialog.showModal();
    },
  };
}
