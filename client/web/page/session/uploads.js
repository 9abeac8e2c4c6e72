// Files on their way to the session: asked for over the line, sent by HTTP, told of until the session has read them.

/** @typedef {{name: string, mesh: string, p: [number, number, number], q: [number, number, number, number]}} Brought a part of a STEP file */
/** @typedef {{id: number, state: string, path?: string, received?: number, mesh?: string, parts?: Brought[], done?: number, of?: number, text?: string, refusal?: string}} UploadTold */

export class Uploads {
  #next = 1;
  /** @type {Map<number, (told: UploadTold) => void>} */
  #waiting = new Map();

  /** @param {(message: object) => boolean} send @param {(path: string, file: Blob) => Promise<string>} post why it was not taken; empty: it was */
  constructor(send, post) {
    this.send = send;
    this.post = post;
  }

  /**
   * @param {File} file @param {number} unit mm @param {(said: string) => void} progress
   * @returns {Promise<{mesh: string, parts?: Brought[], text: string}>} fails with a sentence
   */
  bring(file, unit, progress) {
    const id = this.#next++;
    return new Promise((done, fail) => {
      const end = (/** @type {() => void} */ how) => {
        this.#waiting.delete(id);
        how();
      };
      this.#waiting.set(id, (told) => {
        if (told.state === 'open' && told.path) {
          this.post(told.path, file).then((why) => why && end(() => fail(new Error(why))));
        } else if (told.state === 'sent') {
          progress(`${Math.round((100 * (told.received ?? 0)) / file.size)} %`);
        } else if (told.state === 'parts') {
          progress(told.of ? `${told.done} of ${told.of} parts` : 'is read');
        } else if (told.state === 'ready') {
          end(() => done({ mesh: told.mesh ?? '', parts: told.parts, text: told.text ?? '' }));
        } else {
          end(() => fail(new Error(told.text || told.refusal || 'refused')));
        }
      });
      if (!this.send({ type: 'upload', id, name: file.name, unit_mm: unit, bytes: file.size })) end(() => fail(new Error('not connected: nothing was sent')));
    });
  }

  /** @param {UploadTold} told */
  take(told) {
    this.#waiting.get(told.id)?.(told);
  }

  lost() {
    for (const id of [...this.#waiting.keys()]) this.take({ id, state: 'refused', text: 'the connection was lost before the file was there' });
  }
}
