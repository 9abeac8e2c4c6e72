// What is known of the session: parts, people, clashes, rules, as the gateway tells it. No picture, no network.
import { Signals } from './signals.js';
import { Unexamined } from './unexamined.js';

/** @typedef {import('./motion.js').Vec3} Vec3 */
/** @typedef {import('./motion.js').Quat} Quat */
/**
 * @typedef {object} Part
 * @property {number} id @property {string} name @property {string} mesh
 * @property {boolean} moving @property {number} holder user, 0 nobody
 * @property {Vec3} p @property {Quat} q pose in the world, mm
 * @property {number} radius @property {Vec3} reference @property {number} classes bits: 1 fake, 2 potential, 4 real
 * @property {string[]} [notes] what was found when its mesh was read
 */
/** @typedef {{id: number, name: string, present: boolean, role: string}} User */
/** @typedef {'real' | 'potential' | 'fake' | 'none'} ClashClass */
/**
 * @typedef {object} Clash an event of protocol.md, the latest of this clash
 * @property {string} kind @property {number} seq @property {number} tick @property {number} clash @property {number} a @property {number} b
 * @property {number} user @property {ClashClass} class @property {[number, number]} delta @property {[number, number]} gpd
 * @property {number} fake_below @property {number} real_above @property {number} margin @property {number | null} probability
 * @property {number} area @property {Vec3} point @property {Vec3} normal @property {Vec3 | null} witness
 * @property {{t: Vec3, r: Vec3, about: Vec3, moves: string, way: string, path: string, blocker: number}} separation @property {[string, string]} shapes @property {[string, string]} faces
 * @property {string} grade @property {string} explanation @property {number | null} t_contact @property {number | null} t_real
 * @property {number} begin_tick @property {ClashClass} worst_class @property {[number, number]} worst_delta @property {string} cause
 * @property {{status: string, comment: string, user: number, tick: number}} review @property {boolean} approval_lost
 * @property {boolean} [ended]
 * @property {number} [mover] who moved a part of it last, 0 not known @property {{user: number, cause: string}} [ruled] who changed a rule that it was judged by
 */
/** @typedef {{clash: number, user: number, assignee: number, status: string, tick: number, text: string}} Remark what was said with one review */
/**
 * @typedef {object} Feature of a part, in its frame
 * @property {string} name @property {string} origin @property {string} kind @property {boolean} inward
 * @property {Vec3} point @property {Vec3} axis @property {number} radius @property {number} tube_radius @property {number} half_angle
 * @property {[number, number]} along @property {Vec3} middle
 */
/** @typedef {{id: number, done: boolean, refusal: string, text: string, part?: number, holder?: number}} Reply */
/** @typedef {{user: number, p: Vec3, target: Vec3, up: Vec3}} View */

const MOST_ENDED = 200;
/** Decisions that put a part somewhere: whoever made one has moved it. The others of an event change rules. */
const MOTIONS = new Set(['unknown', 'undo', 'redo', 'reset', 'add part', 'replace part']);

/**
 * @typedef {object} Said
 * @property {void} scene @property {Iterable<Part>} poses @property {Part} holder @property {void} clashes @property {Clash} event
 * @property {void} users @property {any} decision @property {void} standing @property {any} pulse @property {void} server
 * @property {void} me @property {Array<{part: number, reason: string, count: number}>} refused @property {View[]} views
 * @property {void} features @property {any} timeline @property {any} replay @property {string} mesh @property {string} error
 * @property {Part[]} dropped held before the line or the server was gone, and not any more now that it is back
 * @property {void} welcome @property {string} join_refused @property {void} remarks @property {void} unexamined @property {import('./unexamined.js').Told} waits @property {void} draining @property {import('./uploads.js').UploadTold} upload
 */

/** @extends {Signals<Said>} */
export class Session extends Signals {
  name = '';
  mode = 'live';
  role = 'designer';
  hasReport = false;
  hasLog = false;
  boundName = ''; // the only one that this link lets us join under; empty: any
  policy = '';
  tick = 0;
  tickRate = 60;
  serverPresent = false;
  me = 0;
  myName = '';
  /** @type {Map<number, Part>} */ parts = new Map();
  /** @type {Map<number, User>} */ users = new Map();
  /** @type {Map<number, Clash>} */ clashes = new Map();
  /** @type {any[]} */ standing = [];
  /** @type {Remark[]} */ remarks = [];
  unexamined = new Unexamined();
  draining = false; // its server has said that it ends
  /** @type {Map<number, Feature[]>} */ features = new Map();
  /** @type {Map<number, View>} */ views = new Map();
  /** @type {any} */ timeline = null;
  /** @type {any} */ replay = null;

  get mayAct() {
    return this.mode === 'live' && this.role === 'designer' && this.me !== 0;
  }

  /** @param {number} id */
  userName(id) {
    return this.users.get(id)?.name ?? (id ? `user ${id}` : 'nobody');
  }

  /** @param {number} id */
  partName(id) {
    return this.parts.get(id)?.name || `part ${id}`;
  }

  /** @param {Part} part */
  isMine(part) {
    return this.me !== 0 && part.holder === this.me;
  }

  heldByMe() {
    return [...this.parts.values()].filter((part) => this.isMine(part));
  }

  /** What was said of a clash, in order. @param {number} clash */
  remarksOf(clash) {
    return this.remarks.filter((remark) => remark.clash === clash);
  }

  /** Whose task a clash is; 0 nobody's. @param {number} clash */
  assigneeOf(clash) {
    return this.remarksOf(clash).at(-1)?.assignee ?? 0;
  }

  /** A time of the session as it is told beside a picture that goes on. @param {number} tick */
  ago(tick) {
    return Math.max(0, (this.tick - tick) / this.tickRate);
  }

  openClashes() {
    return [...this.clashes.values()].filter((clash) => !clash.ended);
  }

  /** Held when the line or the server was lost, and whether a scene has come since. @type {{parts: number[], told: boolean}} */
  #before = { parts: [], told: false };

  #nobody() {
    if (this.me !== 0) this.#before = { parts: this.heldByMe().map(({ id }) => id), told: false };
    this.me = 0;
  }

  /** Back again: what of it is still held? */
  #again() {
    if (this.me === 0 || !this.#before.told) return;
    const dropped = this.#before.parts.flatMap((id) => this.parts.get(id) ?? []).filter((part) => !this.isMine(part));
    this.#before = { parts: [], told: false };
    if (dropped.length > 0) this.emit('dropped', dropped);
  }

  /** The line broke: nobody is joined and nothing is held until a scene says so again. */
  lost() {
    this.#nobody();
    this.serverPresent = false;
    this.views.clear();
    this.emit('me', undefined);
    this.emit('server', undefined);
  }

  /** @param {import('./frames.js').PoseFrame} frame */
  applyPoses(frame) {
    this.tick = Math.max(this.tick, frame.tick);
    const changed = [];
    for (let k = 0; k < frame.count; ++k) {
      const part = this.parts.get(frame.words[16 * k]);
      if (!part) continue;
      for (let i = 0; i < 3; ++i) part.p[i] = frame.doubles[8 * k + 1 + i];
      for (let i = 0; i < 4; ++i) part.q[i] = frame.floats[16 * k + 8 + i];
      part.classes = frame.words[16 * k + 12];
      this.#hold(part, frame.words[16 * k + 1]);
      changed.push(part);
    }
    this.unexamined.moved(changed);
    this.emit('poses', changed);
  }

  /** @param {Part} part @param {number} holder */
  #hold(part, holder) {
    if (part.holder === holder) return;
    part.holder = holder;
    this.emit('holder', part);
  }

  /** @param {any} message */
  apply(message) {
    const apply = this.#ways[message.type];
    if (apply) apply(message); // what is not known is skipped: the gateway may be newer
  }

  /** @type {Record<string, (message: any) => void>} */
  #ways = {
    welcome: (m) => {
      this.mode = m.mode;
      this.role = m.role;
      this.hasReport = m.report === true;
      this.hasLog = m.log === true;
      this.boundName = m.name ?? '';
      this.emit('me', undefined);
      this.emit('welcome', undefined);
    },
    join_refused: (m) => this.emit('join_refused', m.text),
    server: (m) => {
      this.serverPresent = m.present;
      if (!m.present) this.#nobody();
      if (m.present) this.draining = false;
      this.emit('server', undefined);
      this.emit('me', undefined);
    },
    scene: (m) => this.#scene(m),
    joined: (m) => {
      this.me = m.user;
      this.myName = m.name;
      if (m.role) this.role = m.role;
      this.emit('me', undefined);
      this.#again();
    },
    events: (m) => m.events.forEach((/** @type {Clash} */ event) => this.#event(event)),
    decisions: (m) => m.decisions.forEach((/** @type {any} */ decision) => this.#decision(decision)),
    standing: (m) => {
      this.standing = m.standing;
      this.emit('standing', undefined);
    },
    users: (m) => {
      for (const user of m.users) this.users.set(user.id, user);
      this.emit('users', undefined);
    },
    features: (m) => this.#features(m),
    views: (m) => {
      for (const view of m.views) this.views.set(view.user, view);
      this.emit('views', m.views);
    },
    refused: (m) => this.emit('refused', m.increments),
    remarks: (m) => {
      this.remarks = m.remarks;
      this.emit('remarks', undefined);
    },
    upload: (m) => this.emit('upload', m),
    pulse: (m) => this.#pulse(m),
    mesh: (m) => this.emit('mesh', m.hash),
    error: (m) => this.emit('error', m.text),
    timeline: (m) => {
      this.timeline = m;
      this.mode = 'replay';
      this.emit('timeline', m);
    },
    replay: (m) => {
      this.replay = m;
      this.emit('replay', m);
    },
  };

  /** @param {any} m */
  #scene(m) {
    this.name = m.session;
    this.tick = m.tick;
    this.tickRate = m.tick_rate_hz;
    this.policy = m.policy;
    this.parts = new Map(m.parts.map((/** @type {Part} */ part) => [part.id, part]));
    for (const user of m.users) this.users.set(user.id, user);
    const known = this.clashes;
    this.clashes = new Map();
    for (const clash of m.clashes) {
      tellMovers(clash, known.get(clash.clash));
      this.clashes.set(clash.clash, clash);
    }
    this.standing = m.standing ?? [];
    this.remarks = m.remarks ?? [];
    this.unexamined.clear();
    this.draining = false;
    for (const part of m.parts) if (part.features?.length) this.features.set(part.id, part.features);
    this.serverPresent = true;
    this.#before.told = true;
    for (const what of /** @type {const} */ (['scene', 'server', 'users', 'clashes', 'standing', 'remarks', 'unexamined'])) this.emit(what, undefined);
    this.#tellNamed();
    this.#again();
  }

  /** @param {any} m */
  #features(m) {
    this.features = new Map();
    for (const set of m.sets) {
      for (const part of set.parts) {
        this.features.set(part, [...(this.features.get(part) ?? []), ...set.features]);
      }
    }
    this.emit('features', undefined);
  }

  /** @param {Clash} event */
  #event(event) {
    event.ended = event.kind === 'end' || (event.kind === 'review' && this.clashes.get(event.clash)?.ended);
    // The end of a clash says nothing of how it looked: what it was stays to be read.
    const before = this.clashes.get(event.clash);
    tellMovers(event, before);
    this.clashes.set(event.clash, event.kind === 'end' && before ? { ...before, kind: 'end', ended: true, review: event.review } : event);
    const ended = [...this.clashes.values()].filter((clash) => clash.ended);
    for (const clash of ended.slice(0, Math.max(0, ended.length - MOST_ENDED))) this.clashes.delete(clash.clash);
    if (event.ended || this.#isNamed(event)) this.emit('event', event);
    else this.#unnamed.push(event);
    this.emit('clashes', undefined);
  }

  /** Of a part that was added just now: clashes and parts come by ways of their own, so a clash may be here before the name. It is told when the name is. @type {Clash[]} */
  #unnamed = [];

  /** @param {Clash} clash */
  #isNamed({ a, b }) {
    return this.parts.has(a) && this.parts.has(b);
  }

  #tellNamed() {
    const named = this.#unnamed.filter((event) => this.#isNamed(event) && this.clashes.has(event.clash) && !this.clashes.get(event.clash)?.ended);
    this.#unnamed = [];
    for (const event of named) this.emit('event', event);
  }

  /** @param {any} m */
  #pulse(m) {
    this.tick = Math.max(this.tick, m.tick ?? 0);
    if (this.unexamined.take(m)) this.emit('unexamined', undefined);
    const waits = this.unexamined.news(m, this.tickRate);
    if (waits) this.emit('waits', waits);
    const begins = m.draining === true && !this.draining;
    this.draining = m.draining === true;
    if (begins) this.emit('draining', undefined);
    this.emit('pulse', m);
  }

  /** @param {any} decision */
  #decision(decision) {
    if (decision.kind === 'set policy') this.policy = decision.text;
    const parts = decision.parts?.length ? decision.parts : [decision.part];
    for (const id of parts) this.#holders(decision, id);
    if (decision.kind === 'join' && decision.text) this.#forgetUser(decision.user);
    this.emit('decision', decision);
  }

  /** Somebody else has the id now. @param {number} id */
  #forgetUser(id) {
    for (const clash of this.clashes.values()) {
      if (clash.user === id) clash.user = 0;
      if (clash.mover === id) clash.mover = 0;
      if (clash.ruled?.user === id) clash.ruled.user = 0;
      if (clash.review?.user === id) clash.review.user = 0;
    }
    this.emit('clashes', undefined);
  }

  /** @param {any} decision @param {number} id */
  #holders(decision, id) {
    const part = this.parts.get(id);
    if (!part) return;
    if (decision.kind === 'grab') this.#hold(part, decision.user);
    if (decision.kind === 'hand-over') this.#hold(part, decision.other_user);
    if (['release', 'lease end'].includes(decision.kind)) this.#hold(part, 0);
  }
}

/**
 * An event tells one user: who moved, or who decided. Both stay to be told.
 * @param {Clash} event is filled in @param {Clash | undefined} before the same clash as it was
 */
function tellMovers(event, before) {
  const motion = MOTIONS.has(event.cause ?? 'unknown') && event.kind !== 'review';
  event.mover = motion ? event.user : before?.mover;
  event.ruled = motion || event.cause === 'review' || event.kind === 'review' ? before?.ruled : { user: event.user, cause: event.cause };
}
