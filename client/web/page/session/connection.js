// The line to the gateway: one WebSocket, opened again when it breaks, and meshes over HTTP. Knows the token and nothing of
// what the messages mean.

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 8000;
const PING_MS = 5000;
/** Pings without an answer, after which the line is broken. Not a time: a page that stood still has yet to read what came meanwhile. */
const MOST_UNANSWERED = 3;
const MESH_TRIES = 40;

/** @typedef {'connecting' | 'open' | 'waiting' | 'refused'} LineState */
/**
 * Why there is no line: the address has no token, or one that is not accepted; nobody answers; there are too many browsers already; the gateway has closed the
 * line and said why.
 * @typedef {'no_token' | 'token' | 'gateway' | 'full' | 'closed'} Trouble
 */
/** @typedef {{trouble: Trouble | '', why: string, retryAt: number}} LineTold why in words of the gateway, may be empty; retryAt by performance.now(), 0: not by itself */

const UNTROUBLED = /** @type {LineTold} */ ({ trouble: '', why: '', retryAt: 0 });

/** @param {string} hash of the address: `#token=T` */
export function tokenOf(hash) {
  const token = new URLSearchParams(hash.replace(/^#/, '')).get('token') ?? '';
  return /^[A-Za-z0-9_-]{1,128}$/.test(token) ? token : '';
}

/** What an attempt without success means, by the answer to a request with the same token. @param {number} status of HTTP; 0: no answer @returns {Trouble} */
export function troubleOf(status) {
  if (status === 401) return 'token';
  return status === 0 ? 'gateway' : 'full';
}

export class Connection {
  /** @type {WebSocket | null} */
  #socket = null;
  #wait = FIRST_WAIT_MS;
  #unanswered = 0;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #again;

  /**
   * @param {string} token
   * @param {{message: (message: any) => void, poses: (buffer: ArrayBuffer) => void,
   *          state: (state: LineState, told: LineTold) => void, roundTrip: (ms: number) => void}} on
   */
  constructor(token, on) {
    this.token = token;
    this.on = on;
    setInterval(() => this.#ping(), PING_MS);
  }

  open() {
    clearTimeout(this.#again);
    this.#socket?.close();
    this.#socket = null;
    if (!this.token) {
      this.on.state('refused', { ...UNTROUBLED, trouble: 'no_token' });
      return;
    }
    this.on.state('connecting', UNTROUBLED);
    const address = new URL('ws', location.href.replace(/#.*$/, ''));
    address.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
    const socket = new WebSocket(address, ['mortise.1', `token.${this.token}`]);
    socket.binaryType = 'arraybuffer';
    let opened = false;
    socket.onopen = () => {
      opened = true;
      this.#wait = FIRST_WAIT_MS;
      this.#unanswered = 0;
      this.on.state('open', UNTROUBLED);
    };
    socket.onmessage = ({ data }) => this.#take(data);
    socket.onclose = async ({ code, reason }) => {
      if (this.#socket !== socket) return;
      this.#socket = null;
      // A browser does not tell why it could not open a WebSocket: a request with the same token is told.
      const trouble = opened ? (code === 1006 ? 'gateway' : 'closed') : troubleOf(await this.#statusOf());
      if (this.#socket !== null) return;
      if (trouble === 'token') {
        this.on.state('refused', { ...UNTROUBLED, trouble });
        return;
      }
      this.on.state('waiting', { trouble, why: reason, retryAt: performance.now() + this.#wait });
      this.#again = setTimeout(() => this.open(), this.#wait);
      this.#wait = Math.min(this.#wait * 2, LONGEST_WAIT_MS);
    };
    this.#socket = socket;
  }

  /** Of HTTP, for this token; 0: no answer. @returns {Promise<number>} */
  async #statusOf() {
    try {
      return (await fetch('statistics', { headers: { Authorization: `Bearer ${this.token}` }, cache: 'no-store' })).status;
    } catch {
      return 0;
    }
  }

  /** @param {string | ArrayBuffer} data */
  #take(data) {
    this.#unanswered = 0;
    if (typeof data !== 'string') {
      this.on.poses(data);
      return;
    }
    const message = JSON.parse(data);
    if (message.type === 'pong') this.on.roundTrip(performance.now() - message.at);
    else this.on.message(message);
  }

  #ping() {
    if (this.#socket?.readyState !== WebSocket.OPEN) return;
    if (this.#unanswered >= MOST_UNANSWERED) {
      this.#socket.close(4000, 'silent');
      return;
    }
    ++this.#unanswered;
    this.send({ type: 'ping', at: performance.now() });
  }

  /** @param {object} message @returns {boolean} whether there was a line to send it on */
  send(message) {
    if (this.#socket?.readyState !== WebSocket.OPEN) return false;
    this.#socket.send(JSON.stringify(message));
    return true;
  }

  /** What the gateway makes of the session's log. @param {'report.html' | 'session.mcap' | 'scenario.zip'} file @returns {Promise<Blob>} */
  async download(file) {
    const answer = await fetch(file, { headers: { Authorization: `Bearer ${this.token}` } });
    if (!answer.ok) throw new Error((await answer.text()).trim() || `no ${file}: ${answer.status}`);
    return answer.blob();
  }

  /** A file. @param {string} path @param {Blob} file @returns {Promise<string>} why it was not taken; empty: it was */
  async post(path, file) {
    try {
      const answer = await fetch(path, { method: 'POST', headers: { Authorization: `Bearer ${this.token}` }, body: file });
      return answer.ok ? '' : (await answer.text()).trim() || `the file was refused: ${answer.status}`;
    } catch {
      return 'the connection broke before the file was there';
    }
  }

  /** Asked again while the gateway says "later". @param {string} path @param {string} what it is, for who waits @returns {Promise<Response>} */
  async #get(path, what) {
    const headers = { Authorization: `Bearer ${this.token}` };
    for (let tries = 0; tries < MESH_TRIES; ++tries) {
      const answer = await fetch(path, { headers });
      if (answer.ok && answer.status !== 202) return answer; // 202: what was asked for is on its way
      if (answer.status !== 202 && answer.status !== 503) throw new Error((await answer.text()).trim() || `${what}: ${answer.status}`);
      await new Promise((done) => setTimeout(done, 1000 * Number(answer.headers.get('Retry-After') ?? 1)));
    }
    throw new Error(`${what} did not come`);
  }

  /** @param {string} hash @returns {Promise<ArrayBuffer>} */
  async mesh(hash) {
    return (await this.#get(`mesh/${encodeURIComponent(hash)}.bin`, `mesh ${hash}`)).arrayBuffer();
  }

  /** Of a clash, as SVG. @param {number} clash @param {number} tick as it was judged up to then @returns {Promise<string>} */
  async picture(clash, tick) {
    return (await this.#get(`clash/${clash}.svg?tick=${tick}`, 'the picture')).text();
  }

  /** Of two parts. @param {number} a @param {number} b @param {number | null} tick as they stood after it; null: now @returns {Promise<{mesh_mm: number, real_mm: [number, number]}>} */
  async gap(a, b, tick) {
    return (await this.#get(`gap?a=${a}&b=${b}${tick === null ? '' : `&tick=${tick}`}`, 'the gap')).json();
  }
}
