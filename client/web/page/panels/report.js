// What is kept of a session as a file: its report as one page, and the session itself, as a scenario or with all that was done, from which `mortise open` goes on.
import { byId } from './dom.js';

/** @param {import('../desk.js').Desk} desk */
export function makeReport({ session, connection, say }) {
  const report = /** @type {HTMLButtonElement} */ (byId('do_report'));
  const save = /** @type {HTMLButtonElement} */ (byId('do_save'));
  session.on('welcome', () => {
    report.hidden = !session.hasReport;
    save.hidden = !session.hasLog;
  });

  /** @param {HTMLButtonElement} button @param {'report.html' | 'session.mcap' | 'scenario.zip'} file @param {string} name @param {string} done */
  async function download(button, file, name, done) {
    button.disabled = true;
    try {
      const link = document.createElement('a');
      link.href = URL.createObjectURL(await connection.download(file));
      link.download = name;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
      say(done, 'good');
    } catch (error) {
      say(error instanceof Error ? error.message : `${error}`, 'bad');
    }
    button.disabled = false;
  }

  report.onclick = () => {
    say('The report is being made');
    download(report, 'report.html', `${session.name || 'session'} report.html`, 'The report is downloaded');
  };
  const dialog = /** @type {HTMLDialogElement} */ (byId('save_as'));
  save.onclick = () => {
    dialog.returnValue = '';
    dialog.showModal();
  };
  byId('save_cancel').onclick = () => dialog.close('');
  dialog.addEventListener('close', () => {
    const asked = { scenario: /** @type {const} */ (['scenario.zip', 'zip']), log: /** @type {const} */ (['session.mcap', 'mcap']) }[dialog.returnValue];
    if (!asked) return;
    const [file, ending] = asked;
    const name = `${session.name || 'session'}.${ending}`;
    say('The session is being saved');
    download(save, file, name, `Saved: mortise open ${name} goes on from here`);
  });
}
