// The report of the session as one page, to be kept.
import { byId } from './dom.js';

/** @param {import('../desk.js').Desk} desk */
export function makeReport({ session, connection, say }) {
  const button = /** @type {HTMLButtonElement} */ (byId('do_report'));
  session.on('welcome', () => {
    button.hidden = !session.hasReport;
  });
  button.onclick = async () => {
    button.disabled = true;
    say('The report is being made');
    try {
      const link = document.createElement('a');
      link.href = URL.createObjectURL(await connection.report());
      link.download = `${session.name || 'session'} report.html`;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
      say('The report is downloaded', 'good');
    } catch (error) {
      say(error instanceof Error ? error.message : `${error}`, 'bad');
    }
    button.disabled = false;
  };
}
