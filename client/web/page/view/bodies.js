// All parts are drawn by a few calls, whatever their shapes: for each look one list of faces, of insides and of edges.
import * as THREE from 'three';

/** @typedef {import('./parts_view.js').Shown} Shown */
/** @typedef {import('./looks.js').Look} Look */
/** @typedef {{faces: THREE.Mesh, inside: THREE.Mesh, edges: THREE.LineSegments, caster: THREE.Mesh}} Drawn */

const LEAST_VERTICES = 1 << 17; // above 65,536: an index of a shape never changes its size
const INDEX_BYTES = 4;

/** Shapes in one buffer, one after another, and poses and colours of parts: three's, not drawn itself. None of its shapes goes: who comes again finds it. */
class Store extends THREE.BatchedMesh {
  /** @type {Map<THREE.BufferGeometry, number>} */
  #shapes = new Map();

  constructor() {
    super(1, LEAST_VERTICES, LEAST_VERTICES);
  }

  /** @param {THREE.BufferGeometry} shape with an index @returns {number} its number here */
  shape(shape) {
    const known = this.#shapes.get(shape);
    if (known !== undefined) return known;
    const [vertices, indices] = [shape.attributes.position.count, /** @type {THREE.BufferAttribute} */ (shape.index).count];
    if (vertices > this.unusedVertexCount || indices > this.unusedIndexCount) {
      const { _maxVertexCount, _maxIndexCount } = /** @type {any} */ (this);
      this.setGeometrySize(2 * _maxVertexCount + vertices, 2 * _maxIndexCount + indices);
    }
    const id = this.addGeometry(shape);
    this.#shapes.set(shape, id);
    return id;
  }
}

export class Bodies {
  /** Nothing in it has a pose of its own: no walk over it in each picture. */
  group = new THREE.Group();
  /** All faces but those that are seen through, once more: they throw the shadow. */
  casters = new THREE.Scene();
  #faces = new Store();
  #edges = new Store();
  /** @type {Map<Shown, number>} */
  #places = new Map();
  /** @type {Map<Look, Drawn>} */
  #drawn = new Map();

  /** @param {import('./looks.js').Looks} looks */
  constructor(looks) {
    this.looks = looks;
    this.group.updateMatrixWorld = this.casters.updateMatrixWorld = () => {};
  }

  /** Anew where somebody came, went or looks otherwise. @param {Iterable<Shown>} all */
  gather(all) {
    /** @type {Map<Look, Shown[]>} */
    const alike = new Map([...this.#drawn.keys()].map((look) => [look, []]));
    const gone = new Set(this.#places.keys());
    for (const shown of all) {
      gone.delete(shown);
      if (!this.#places.has(shown)) this.#add(shown);
      if (shown.look === 'hidden') continue;
      const list = alike.get(shown.look);
      if (list) list.push(shown);
      else alike.set(shown.look, [shown]);
    }
    for (const shown of gone) {
      this.#faces.deleteInstance(/** @type {number} */ (this.#places.get(shown)));
      this.#places.delete(shown);
    }
    for (const [look, list] of alike) this.#list(look, list);
    this.showInsides();
  }

  /** Takes the pose of a part. @param {Shown} shown */
  place(shown) {
    const at = this.#places.get(shown);
    if (at !== undefined) this.#faces.setMatrixAt(at, shown.faces.matrixWorld);
  }

  /** The cut face of a ghost says nothing. */
  showInsides() {
    for (const [look, { inside }] of this.#drawn) inside.visible = this.looks.clipping.length > 0 && look !== 'ghost';
  }

  /** @param {Shown} shown */
  #add(shown) {
    const store = this.#faces;
    if (store.instanceCount === store.maxInstanceCount) store.setInstanceCount(2 * store.maxInstanceCount);
    const at = store.addInstance(store.shape(shown.shape.faces));
    store.setColorAt(at, new THREE.Color(this.looks.colourOf(shown.part)));
    this.#places.set(shown, at);
    this.place(shown);
  }

  /** Who is drawn like this. @param {Look} look @param {Shown[]} list */
  #list(look, list) {
    const drawn = this.#drawn.get(look) ?? this.#make(look);
    const side = Math.max(1, Math.ceil(Math.sqrt(list.length)));
    const places = new Uint32Array(side * side);
    for (const [i, shown] of list.entries()) places[i] = /** @type {number} */ (this.#places.get(shown));
    const texture = new THREE.DataTexture(places, side, side, THREE.RedIntegerFormat, THREE.UnsignedIntType);
    texture.needsUpdate = true;
    /** @type {any} */ (drawn.faces)._indirectTexture?.dispose();
    const faces = pieces(this.#faces, list.map(({ shape }) => shape.faces));
    for (const object of [drawn.faces, drawn.inside, drawn.caster]) fill(object, this.#faces, this.#faces, texture, faces);
    fill(drawn.edges, this.#edges, this.#faces, texture, pieces(this.#edges, list.map(({ shape }) => shape.edges)));
  }

  /** @param {Look} look @returns {Drawn} */
  #make(look) {
    const { looks } = this;
    const drawn = { faces: new THREE.Mesh(undefined, looks.faces(look)), inside: new THREE.Mesh(undefined, looks.inside(look)), edges: new THREE.LineSegments(undefined, looks.edges(look)), caster: new THREE.Mesh(undefined, looks.faces(look)) };
    // What is seen through is drawn after what is not.
    drawn.faces.renderOrder = look === 'ghost' ? 1 : 0;
    for (const object of Object.values(drawn)) Object.assign(object, { matrixAutoUpdate: false, matrixWorldAutoUpdate: false, frustumCulled: false });
    this.group.add(drawn.faces, drawn.inside, drawn.edges);
    if (look !== 'ghost') this.casters.add(drawn.caster);
    this.#drawn.set(look, drawn);
    return drawn;
  }
}

/** Where in the buffer these shapes lie. @param {Store} store @param {Array<THREE.BufferGeometry | null>} shapes */
function pieces(store, shapes) {
  const starts = new Int32Array(shapes.length);
  const counts = new Int32Array(shapes.length);
  for (const [i, shape] of shapes.entries()) {
    const range = shape && store.getGeometryRangeAt(store.shape(shape));
    if (!range) continue;
    starts[i] = INDEX_BYTES * range.start;
    counts[i] = range.count;
  }
  return { starts, counts };
}

/**
 * What three's renderer asks of a BatchedMesh. The class itself has one list for one material; lists of all looks share its buffers here, and edges are lines.
 * @param {THREE.Mesh | THREE.LineSegments} object @param {Store} shapes @param {Store} poses @param {THREE.Texture} places @param {{starts: Int32Array, counts: Int32Array}} pieces
 */
function fill(object, { geometry }, poses, places, { starts, counts }) {
  geometry.boundingSphere ??= new THREE.Sphere(); // of no use: where the parts stand is not in it
  const { _matricesTexture, _colorsTexture } = /** @type {any} */ (poses);
  Object.assign(object, {
    isBatchedMesh: true, geometry, _matricesTexture, _colorsTexture: 'isLine' in object ? null : _colorsTexture,
    _indirectTexture: places, _multiDrawStarts: starts, _multiDrawCounts: counts, _multiDrawCount: starts.length,
  });
}
