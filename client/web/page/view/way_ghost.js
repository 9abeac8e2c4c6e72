// The way out of the chosen clash: the part that moves, seen through, goes from where it stands to where it is free. True to scale.
import * as THREE from 'three';
import { displacement, poseOnWay } from '../session/way_out.js';

/** @typedef {import('../session/session.js').Part} Part */
/** @typedef {import('../session/session.js').Clash} Clash */

const PLAY_MS = 1600;
const COLOUR = 0x4fd08a; // of the arrow that separates

export class WayGhost {
  /** @type {{part: Part, separation: Clash['separation'], begin: number, mesh: THREE.Mesh, edges: THREE.LineSegments | null} | null} */
  #shown = null;
  #faces = new THREE.MeshStandardMaterial({ color: COLOUR, roughness: 0.7, transparent: true, opacity: 0.4, depthWrite: false, side: THREE.DoubleSide });
  #lines = new THREE.LineBasicMaterial({ color: COLOUR });
  #group = new THREE.Group();
  /** Where its name stands. @type {Array<{at: THREE.Vector3, text: string}>} */
  notes = [];

  /** @param {import('./stage.js').Stage} stage @param {import('./parts_view.js').PartsView} partsView */
  constructor(stage, partsView) {
    this.stage = stage;
    this.partsView = partsView;
    stage.scene.add(this.#group);
    stage.beforePicture((now) => this.#turn(now));
  }

  /** Of which part; 0 none. */
  get part() {
    return this.#shown?.part.id ?? 0;
  }

  /** @param {Part} part @param {Clash} clash @param {boolean} [atOnce] only the end @returns {boolean} whether the part has a shape to be shown */
  play(part, { separation }, atOnce = matchMedia('(prefers-reduced-motion: reduce)').matches) {
    this.stop();
    const like = this.partsView.shown.get(part.id);
    if (!like) return false;
    const mesh = new THREE.Mesh(like.faces.geometry, this.#faces);
    const edges = like.shape.edges && new THREE.LineSegments(like.shape.edges, this.#lines);
    mesh.renderOrder = 2; // after the parts that are seen through
    this.#group.add(...[mesh, edges].filter((object) => object !== null));
    this.#shown = { part, separation, begin: atOnce ? -Infinity : performance.now(), mesh, edges };
    this.stage.ask();
    return true;
  }

  stop() {
    this.#group.clear();
    this.#shown = null;
    this.notes = [];
    this.stage.ask();
  }

  /** How many pixels the way is long, as the eye stands. @param {Part} part @param {Clash} clash */
  pixels(part, { separation, point }) {
    const size = this.stage.pixelSize(new THREE.Vector3(...point));
    return Math.max(Math.hypot(...displacement(separation, point)), part.radius * Math.hypot(...separation.r)) / size;
  }

  /** @param {number} now */
  #turn(now) {
    if (!this.#shown) return false;
    const { part, separation, begin, mesh, edges } = this.#shown;
    const s = Math.min(1, Math.max(0, (now - begin) / PLAY_MS));
    const eased = s * s * (3 - 2 * s);
    const pose = poseOnWay(part, separation, eased);
    for (const object of [mesh, edges]) {
      object?.position.set(...pose.p);
      object?.quaternion.set(...pose.q);
    }
    const box = mesh.geometry.boundingBox;
    if (box) this.notes = [{ at: box.getCenter(new THREE.Vector3()).applyQuaternion(mesh.quaternion).add(mesh.position), text: `${part.name}, free` }];
    return s < 1;
  }
}
