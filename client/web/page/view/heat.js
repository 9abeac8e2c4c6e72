// Heat on faces: how deep each point of the faces that clash lies in the other part, on the scale of the clash's two thresholds.
import * as THREE from 'three';
import { liftOf, scaleOf } from '../session/heat_scale.js';
import { conjugate, inPart, rotate } from '../session/motion.js';
import { HeatMaterial } from './heat_material.js';

/** @typedef {import('../session/session.js').Clash} Clash */
/** @typedef {import('../session/session.js').Part} Part */
/**
 * One face of one clash.
 * @typedef {object} Patch
 * @property {THREE.Mesh} mesh @property {THREE.Mesh | null} behind the same, seen through what covers it
 * @property {Clash} clash @property {number} part @property {number} other @property {string} face
 * @property {string} asked the poses and the clash that were asked for last @property {number} deepest
 */

/** The worst ones have it; a picture of more would say nothing. */
const MOST_CLASHES = 24;
const POINTS = { one: 24_000, many: 5_000 };
/** What is no nearer than this share of the part, or than what the clash is deep, needs no figure. */
const FAR_SHARE = 0.15;
const BEND_SHARE = 0.03;
const LEAST_PAUSE_MS = 50;
const PAUSE_SHARE = 2;

export class Heat {
  on = true;
  group = new THREE.Group();
  /** @type {Map<string, Patch>} */
  #patches = new Map();
  #sent = new Set();
  /** @type {Worker | null} */
  #worker = null;
  #alone = false;
  /** @type {Set<string>} */
  #queue = new Set();
  #busy = false;
  #began = 0;
  /** @type {() => void} when what is shown has changed */
  onChange = () => {};

  /**
   * @param {import('./stage.js').Stage} stage @param {import('./parts_view.js').PartsView} partsView
   * @param {import('../session/session.js').Session} session
   */
  constructor(stage, partsView, session) {
    this.stage = stage;
    this.partsView = partsView;
    this.session = session;
    stage.scene.add(this.group);
  }

  /** @param {Clash[]} clashes the worse ones last, so that they lie on top @param {boolean} alone the one that is chosen: finer, and seen through what covers it */
  show(clashes, alone) {
    if (alone !== this.#alone) this.clear();
    this.#alone = alone;
    const wanted = new Map();
    const shown = this.on ? clashes.filter((clash) => clash.class !== 'none' && !clash.ended).slice(-MOST_CLASHES) : [];
    for (const clash of shown) {
      wanted.set(`${clash.clash} ${clash.a}`, { clash, part: clash.a, other: clash.b, face: clash.faces[0] });
      wanted.set(`${clash.clash} ${clash.b}`, { clash, part: clash.b, other: clash.a, face: clash.faces[1] });
    }
    for (const [key, patch] of this.#patches) if (wanted.get(key)?.face !== patch.face) this.#drop(key, patch);
    for (const [key, want] of wanted) {
      const patch = this.#patches.get(key) ?? this.#make(key, want);
      patch.clash = want.clash;
      this.#colour(patch);
      this.#ask(key, patch);
    }
    this.stage.ask();
    this.onChange();
  }

  /** Parts have moved: the fields of those are worked out anew. */
  follow() {
    for (const [key, patch] of this.#patches) this.#ask(key, patch);
  }

  clear() {
    for (const [key, patch] of this.#patches) this.#drop(key, patch);
  }

  /** The chosen clash, where its heat is shown; the deepest point of its faces, and by how much the field was lifted, mm. @returns {{clash: Clash, deepest: number, lift: number} | null} */
  get legend() {
    const [patch] = this.#patches.values();
    return this.#alone && patch ? { clash: patch.clash, deepest: this.#deepestOf(patch.clash), lift: this.#liftOf(patch.clash) } : null;
  }

  get empty() {
    return this.#patches.size === 0;
  }

  /** @param {string} key @param {Patch} patch */
  #drop(key, patch) {
    for (const mesh of [patch.mesh, patch.behind]) {
      if (!mesh) continue;
      this.group.remove(mesh);
      /** @type {THREE.Material} */ (mesh.material).dispose();
    }
    patch.mesh.geometry.dispose();
    this.#patches.delete(key);
  }

  /** @param {string} key @param {{clash: Clash, part: number, other: number, face: string}} want @returns {Patch} */
  #make(key, want) {
    const geometry = new THREE.BufferGeometry();
    const add = (/** @type {boolean} */ behind) => {
      const mesh = new THREE.Mesh(geometry, new HeatMaterial(behind));
      mesh.matrixAutoUpdate = mesh.matrixWorldAutoUpdate = false;
      mesh.frustumCulled = false;
      mesh.visible = false;
      mesh.renderOrder = behind ? 3 : 2;
      this.group.add(mesh);
      return mesh;
    };
    const patch = { ...want, mesh: add(false), behind: this.#alone ? add(true) : null, asked: '', deepest: NaN };
    this.#patches.set(key, patch);
    return patch;
  }

  /** Of both faces; less than anything before the first field is there. @param {Clash} clash */
  #deepestOf(clash) {
    const both = [...this.#patches.values()].filter((patch) => patch.clash.clash === clash.clash && Number.isFinite(patch.deepest));
    return Math.max(...both.map(({ deepest }) => deepest));
  }

  /** The deeper face is as deep as the clash. @param {Clash} clash */
  #liftOf(clash) {
    return liftOf(clash, this.#deepestOf(clash));
  }

  /** @param {Patch} patch */
  #colour({ mesh, behind, clash }) {
    for (const drawn of [mesh, behind]) {
      const material = /** @type {HeatMaterial | undefined} */ (drawn?.material);
      material?.show(scaleOf(clash), this.#liftOf(clash));
      if (material) material.clippingPlanes = this.partsView.looks.clipping;
    }
  }

  /** Wants the field of a patch anew where what it was worked out from has changed. @param {string} key @param {Patch} patch */
  #ask(key, patch) {
    const [part, other] = [patch.part, patch.other].map((id) => this.session.parts.get(id));
    const shown = this.partsView.shown.get(patch.part);
    if (!part || !other || !shown) return;
    for (const mesh of [patch.mesh, patch.behind]) if (mesh) mesh.matrixWorld = shown.faces.matrixWorld;
    const asked = `${patch.clash.seq} ${part.p} ${part.q} ${other.p} ${other.q}`;
    if (asked === patch.asked) return;
    patch.asked = asked;
    this.#queue.add(key);
    this.#next();
  }

  /** One at a time, with pauses: however much moves, the worker leaves most of its core to others. */
  async #next() {
    if (this.#busy) return;
    const [key] = this.#queue;
    if (key === undefined) return;
    this.#queue.delete(key);
    const patch = this.#patches.get(key);
    const [part, other] = patch ? [patch.part, patch.other].map((id) => this.session.parts.get(id)) : [];
    if (!patch || !part || !other) {
      this.#next();
      return;
    }
    this.#busy = true;
    const there = await Promise.all([this.#send(part), this.#send(other)]);
    const { clash } = patch;
    const { from, real, top } = scaleOf(clash);
    this.#began = performance.now();
    if (!there.every(Boolean)) {
      this.#take({ key, field: null });
      return;
    }
    this.#work().postMessage({
      key, own: part.mesh, other: other.mesh, ownPose: { p: [...part.p], q: [...part.q] }, otherPose: { p: [...other.p], q: [...other.q] },
      feature: this.session.features.get(part.id)?.find((f) => f.name === patch.face) ?? null,
      point: inPart(part, clash.point), normal: rotate(conjugate(part.q), clash.normal), reach: Math.max(2, part.radius * 0.15),
      far: Math.max(1.5 * top, FAR_SHARE * Math.min(part.radius, other.radius)), bend: Math.max(2e-4, BEND_SHARE * (real - from)),
      most: this.#alone ? POINTS.one : POINTS.many,
    });
  }

  /** A mesh goes to the worker once. @param {Part} part @returns {Promise<boolean>} */
  async #send(part) {
    const mesh = await this.partsView.meshOf(part);
    if (mesh && !this.#sent.has(part.mesh)) {
      this.#sent.add(part.mesh);
      this.#work().postMessage({ mesh: part.mesh, points: mesh.points, triangles: mesh.triangles });
    }
    return mesh !== null;
  }

  #work() {
    if (!this.#worker) {
      this.#worker = new Worker(new URL('./field_worker.js', import.meta.url), { type: 'module' });
      this.#worker.onmessage = ({ data }) => this.#take(data);
    }
    return this.#worker;
  }

  /** @param {{key: string, field: import('../session/overlap_field.js').Field | null}} answer */
  #take({ key, field }) {
    setTimeout(() => {
      this.#busy = false;
      this.#next();
    }, Math.max(LEAST_PAUSE_MS, PAUSE_SHARE * (performance.now() - this.#began)));
    const patch = this.#patches.get(key);
    if (!patch) return;
    if (field) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(field.points, 3));
      geometry.setAttribute('overlap', new THREE.BufferAttribute(field.overlap, 1));
      geometry.setIndex(new THREE.BufferAttribute(field.triangles, 1));
      patch.mesh.geometry.dispose();
      patch.deepest = field.deepest;
      for (const mesh of [patch.mesh, patch.behind]) if (mesh) Object.assign(mesh, { geometry, visible: field.triangles.length > 0 });
    }
    for (const other of this.#patches.values()) if (other.clash.clash === patch.clash.clash) this.#colour(other);
    this.#ask(key, patch); // the parts may have moved on
    this.stage.ask();
    this.onChange();
  }
}
