// The parts in the picture: geometry once a mesh, a pose for each part, how it looks (plain, chosen, ghost), and what a ray hits.
import * as THREE from 'three';
import { toCreasedNormals } from 'three/addons/utils/BufferGeometryUtils.js';
import { readMesh } from '../session/frames.js';
import { Bodies } from './bodies.js';
import { Looks } from './looks.js';

/** @typedef {import('../session/session.js').Part} Part */
/** @typedef {import('./looks.js').Look} Look */
/** @typedef {{mesh: import('../session/frames.js').Mesh, faces: THREE.BufferGeometry, edges: THREE.BufferGeometry | null}} Shape */
/** @typedef {{part: Part, shape: Shape, faces: THREE.Mesh, look: Look}} Shown its faces are where it stands and what rays hit; it is drawn with all others */

/** Facets that meet at less are one round face: 24 facets meet at 15°. */
const CREASE = THREE.MathUtils.degToRad(32);
/** Above, edges and creases cost more than they show. */
const MOST_CREASED = 150_000;

export class PartsView {
  /** @type {Map<string, Promise<Shape>>} */
  #shapes = new Map();
  /** @type {Map<number, Shown>} */
  shown = new Map();
  looks = new Looks();
  #bodies = new Bodies(this.looks);
  #gathered = true;
  /** Another one whenever what is shown stands or looks otherwise. */
  version = 0;
  #generation = 0;

  /**
   * @param {import('./stage.js').Stage} stage
   * @param {(hash: string) => Promise<ArrayBuffer>} fetchMesh
   * @param {(text: string) => void} problem
   */
  constructor(stage, fetchMesh, problem) {
    this.stage = stage;
    this.fetchMesh = fetchMesh;
    this.problem = problem;
    stage.scene.add(this.#bodies.group);
    stage.beforePicture(() => this.#gather());
  }

  /** @param {string} hash @returns {Promise<Shape>} */
  #shapeOf(hash) {
    let shape = this.#shapes.get(hash);
    if (!shape) {
      shape = this.fetchMesh(hash).then(shapeOf);
      shape.catch(() => this.#shapes.delete(hash));
      this.#shapes.set(hash, shape);
    }
    return shape;
  }

  /** All parts anew; those with a known mesh stand in the next picture. @param {Iterable<Part>} parts @returns {Promise<void>} */
  async setParts(parts) {
    const generation = ++this.#generation;
    this.shown.clear();
    this.#gatherAgain();
    const waiting = [...parts].map(async (part) => {
      try {
        const shape = await this.#shapeOf(part.mesh);
        if (generation === this.#generation) this.#add(part, shape);
      } catch (error) {
        this.problem(`${part.name || `part ${part.id}`} is not shown: ${error instanceof Error ? error.message : error}`);
      }
    });
    await Promise.all(waiting);
  }

  /** @param {Part} part @param {Shape} shape */
  #add(part, shape) {
    const faces = new THREE.Mesh(shape.faces, unseen);
    faces.userData.part = part.id;
    const shown = { part, shape, faces, look: /** @type {Look} */ ('plain') };
    this.shown.set(part.id, shown);
    place(shown);
    this.#gatherAgain();
  }

  /** In the next picture. */
  #gatherAgain() {
    this.#gathered = false;
    this.stage.ask();
  }

  #gather() {
    if (this.#gathered) return;
    this.#gathered = true;
    ++this.version;
    this.#bodies.gather(this.shown.values());
  }

  /** @param {Iterable<Part>} parts */
  movePoses(parts) {
    for (const part of parts) {
      const shown = this.shown.get(part.id);
      if (!shown) continue;
      place(shown);
      this.#bodies.place(shown);
    }
    ++this.version;
    this.stage.ask();
  }

  /** @param {(part: Part) => Look} lookOf */
  setLooks(lookOf) {
    for (const shown of this.shown.values()) {
      const look = lookOf(shown.part);
      if (look === shown.look) continue;
      shown.look = look;
      this.#gatherAgain();
    }
  }

  /** @param {THREE.Plane[]} planes */
  cutBy(planes) {
    this.looks.cutBy(planes);
    this.#bodies.showInsides();
    this.stage.ask();
  }

  /** The nearest part that is not ghosted or cut away. @param {THREE.Raycaster} ray */
  hit(ray) {
    const solid = [...this.shown.values()].filter((shown) => shown.look !== 'ghost' && shown.look !== 'hidden').map((shown) => shown.faces);
    const hits = ray.intersectObjects(solid, false);
    return hits.find(({ point }) => this.looks.clipping.every((plane) => plane.distanceToPoint(point) >= 0)) ?? null;
  }

  /** Boxes of these parts as they stand, of those that are shown. @param {Iterable<Part>} parts @returns {THREE.Box3[]} */
  boxesOf(parts) {
    const shown = [...parts].flatMap((part) => this.shown.get(part.id) ?? []);
    return shown.flatMap(({ faces }) => faces.geometry.boundingBox?.clone().applyMatrix4(faces.matrixWorld) ?? []);
  }

  /** What throws the shadow. */
  get casters() {
    return this.#bodies.casters;
  }

  /** Box of all parts. */
  bounds() {
    return this.boxesOf([...this.shown.values()].map(({ part }) => part)).reduce((sum, box) => sum.union(box), new THREE.Box3());
  }

  /** @param {Part} part @returns {Promise<import('../session/frames.js').Mesh | null>} */
  async meshOf(part) {
    return this.#shapeOf(part.mesh).then((shape) => shape.mesh, () => null);
  }
}

/** @param {ArrayBuffer} buffer @returns {Shape} */
function shapeOf(buffer) {
  const mesh = readMesh(buffer);
  if (!mesh) throw new Error('its mesh is not readable');
  const plain = new THREE.BufferGeometry();
  plain.setAttribute('position', new THREE.BufferAttribute(mesh.points, 3));
  plain.setIndex(new THREE.BufferAttribute(mesh.triangles, 1));
  const creased = mesh.triangles.length / 3 <= MOST_CREASED;
  if (!creased) plain.computeVertexNormals();
  const faces = creased ? toCreasedNormals(plain, CREASE) : plain;
  if (creased) indexed(faces);
  faces.computeBoundingBox();
  faces.computeBoundingSphere();
  const edges = creased ? indexed(new THREE.EdgesGeometry(plain, THREE.MathUtils.radToDeg(CREASE))) : null;
  return { mesh, faces, edges };
}

/** One vertex after another, as all that lies in one buffer. @param {THREE.BufferGeometry} geometry */
function indexed(geometry) {
  return geometry.setIndex(new THREE.BufferAttribute(Uint32Array.from({ length: geometry.attributes.position.count }, (_, i) => i), 1));
}

const unseen = new THREE.MeshBasicMaterial();
const position = new THREE.Vector3();
const turn = new THREE.Quaternion();
const one = new THREE.Vector3(1, 1, 1);

/** @param {Shown} shown */
function place({ part, faces }) {
  faces.matrixWorld.compose(position.fromArray(part.p), turn.fromArray(part.q), one);
}
