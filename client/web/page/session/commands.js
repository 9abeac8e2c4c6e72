// Asks the session for something and brings its answer. A refusal is said to the user where it is asked for here.

/** @typedef {import('./session.js').Reply} Reply */
/** @typedef {import('./session.js').Part} Part */

const PATIENCE_MS = 8000;

export class Commands {
  #next = 1;
  /** @type {Map<number, (reply: Reply) => void>} */
  #waiting = new Map();

  /**
   * @param {(message: object) => boolean} send
   * @param {(text: string, kind: 'bad' | 'good' | '') => void} say
   */
  constructor(send, say) {
    this.send = send;
    this.say = say;
  }

  /** @param {string} what of the table of commands in protocol.md @param {object} keys @returns {Promise<Reply>} */
  async ask(what, keys) {
    const reply = await this.request(what, keys);
    if (!reply.done) this.say(reply.text || `Refused: ${reply.refusal}`, 'bad');
    else if (reply.text) this.say(reply.text, '');
    return reply;
  }

  /** As ask, but nothing is said: for many commands of which the caller says one sum. @param {string} what @param {object} keys @returns {Promise<Reply>} */
  request(what, keys) {
    const id = this.#next++;
    return new Promise((/** @type {(reply: Reply) => void} */ done) => {
      if (!this.send({ type: 'command', id, do: what, ...keys })) {
        done({ id, done: false, refusal: 'not_connected', text: 'Not connected: nothing was sent' });
        return;
      }
      const late = setTimeout(() => this.take({ id, done: false, refusal: 'no_answer', text: `The session did not answer to "${what}"` }), PATIENCE_MS);
      this.#waiting.set(id, (answer) => {
        clearTimeout(late);
        done(answer);
      });
    });
  }

  /** @param {Reply} reply */
  take(reply) {
    const done = this.#waiting.get(reply.id);
    this.#waiting.delete(reply.id);
    done?.(reply);
  }

  lost() {
    for (const id of [...this.#waiting.keys()]) this.take({ id, done: false, refusal: 'not_connected', text: 'The connection was lost before the answer' });
  }
}
