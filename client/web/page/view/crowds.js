// Parts of one shape that look alike are drawn at once: one call for their faces and one for their edges, however many they are.
import * as THREE from 'three';

/** @typedef {import('./parts_view.js').Shown} Shown */
/** @typedef {(THREE.Mesh | THREE.LineSegments) & {count: number}} Drawn */
/**
 * @typedef {object} Crowd
 * @property {THREE.InstancedBufferAttribute | null} poses of its parts; of a part alone none but its own
 * @property {Drawn[]} objects faces, insides, edges: all at the same poses
 */

/** One who comes or goes is not a new crowd. */
const ROOM = 16;

export class Crowds {
  /** Its children carry poses of their own: no walk over them in each picture. */
  group = new THREE.Group();
  /** @type {Map<string, Crowd>} */
  #crowds = new Map();
  /** @type {Map<Shown, {crowd: Crowd, at: number}>} */
  #places = new Map();

  /** @param {import('./looks.js').Looks} looks */
  constructor(looks) {
    this.looks = looks;
    this.group.updateMatrixWorld = () => {};
  }

  /** Anew where somebody came, went or looks otherwise. @param {Iterable<Shown>} all */
  gather(all) {
    /** @type {Map<string, Shown[]>} */
    const alike = new Map();
    for (const shown of all) {
      if (shown.look === 'hidden') continue;
      const { mesh, moving } = shown.part;
      const key = `${mesh} ${moving} ${shown.look}`;
      const list = alike.get(key);
      if (list) list.push(shown);
      else alike.set(key, [shown]);
    }
    const old = this.#crowds;
    this.#crowds = new Map();
    this.#places.clear();
    for (const [key, list] of alike) {
      const known = old.get(key);
      const crowd = known && fits(known, list.length) ? known : this.#make(list[0], list.length);
      if (crowd === known) old.delete(key);
      this.#crowds.set(key, crowd);
      for (const object of crowd.objects) Object.assign(object, crowd.poses ? { count: list.length } : { matrixWorld: list[0].faces.matrixWorld });
      for (const [at, shown] of list.entries()) {
        this.#places.set(shown, { crowd, at });
        this.place(shown);
      }
    }
    for (const { objects } of old.values()) {
      for (const object of objects) /** @type {THREE.InstancedMesh} */ (/** @type {unknown} */ (object)).dispatchEvent({ type: 'dispose' });
      this.group.remove(...objects);
    }
    this.showInsides();
  }

  /** Takes the pose of a part. @param {Shown} shown */
  place(shown) {
    const { crowd, at = 0 } = this.#places.get(shown) ?? {};
    if (!crowd?.poses) return;
    shown.faces.matrixWorld.toArray(crowd.poses.array, 16 * at);
    crowd.poses.needsUpdate = true;
  }

  /** The cut face of a ghost says nothing. */
  showInsides() {
    for (const [key, { objects: [, inside] }] of this.#crowds) inside.visible = this.looks.clipping.length > 0 && !key.endsWith(' ghost');
  }

  /** @param {Shown} one @param {number} count @returns {Crowd} */
  #make({ part, faces, edges, look }, count) {
    const colour = this.looks.colourOf(part);
    const drawn = [new THREE.Mesh(faces.geometry, this.looks.faces(colour, look)), new THREE.Mesh(faces.geometry, this.looks.inside(colour, look))];
    const objects = /** @type {Drawn[]} */ (edges ? [...drawn, new THREE.LineSegments(edges, this.looks.edges(look))] : drawn);
    const poses = count > 1 ? new THREE.InstancedBufferAttribute(new Float32Array(16 * (count + ROOM)), 16) : null;
    for (const object of objects) {
      object.matrixAutoUpdate = object.matrixWorldAutoUpdate = false;
      // What three looks for in an InstancedMesh, which has no lines.
      if (poses) Object.assign(object, { isInstancedMesh: true, instanceMatrix: poses, instanceColor: null, morphTexture: null, frustumCulled: false });
    }
    // What is seen through is drawn after what is not.
    objects[0].renderOrder = look === 'ghost' ? 1 : 0;
    this.group.add(...objects);
    return { poses, objects };
  }
}

/** @param {Crowd} crowd @param {number} count of parts */
function fits({ poses }, count) {
  return poses ? count > 1 && count <= poses.count : count === 1;
}
