// Heat on faces: the faces that clash, coloured by how far the clash has gone between the two thresholds and beyond.
import * as THREE from 'three';
import { conjugate, inPart, rotate } from '../session/motion.js';
import { facetsAbout, facetsOf } from '../session/surfaces.js';

/** @typedef {import('../session/session.js').Clash} Clash */
/** @typedef {import('../session/motion.js').Vec3} Vec3 */

/** Only what is within reach of the centre is drawn, fading towards its rim. @param {THREE.Material} material @param {Vec3} centre @param {number} reach */
function fade(material, centre, reach) {
  material.transparent = true;
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, { centre: { value: new THREE.Vector3(...centre) }, reach: { value: reach } });
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', '#include <common>\nvarying vec3 inPart;')
      .replace('#include <begin_vertex>', '#include <begin_vertex>\ninPart = position;');
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', '#include <common>\nvarying vec3 inPart;\nuniform vec3 centre;\nuniform float reach;')
      .replace('#include <opaque_fragment>', '#include <opaque_fragment>\ngl_FragColor.a *= 1.0 - smoothstep(0.55, 1.0, distance(inPart, centre) / reach);');
  };
}

/** 0 … 1 blue to amber between nothing and the upper threshold, to red beyond. @param {Clash} clash */
export function heatOf(clash) {
  const depth = (clash.delta[0] + clash.delta[1]) / 2;
  if (clash.class === 'fake') return Math.min(0.3, Math.max(0, (0.3 * depth) / (clash.fake_below || 1)));
  if (clash.class === 'potential') {
    const width = clash.real_above - clash.fake_below;
    return 0.4 + 0.25 * Math.min(1, Math.max(0, width > 0 ? (depth - clash.fake_below) / width : 0.5));
  }
  return 0.8 + 0.2 * Math.min(1, Math.max(0, clash.margin / 0.5));
}

const SCALE = [
  [0, new THREE.Color(0x3f97e0)],
  [0.35, new THREE.Color(0x49c3b1)],
  [0.5, new THREE.Color(0xf0c02e)],
  [0.65, new THREE.Color(0xf0892e)],
  [0.8, new THREE.Color(0xe5484d)],
  [1, new THREE.Color(0xa3123a)],
];

/** @param {number} heat */
export function colourOfHeat(heat) {
  for (let i = 1; i < SCALE.length; ++i) {
    const [hi, to] = /** @type {[number, THREE.Color]} */ (SCALE[i]);
    const [lo, from] = /** @type {[number, THREE.Color]} */ (SCALE[i - 1]);
    if (heat <= hi) return from.clone().lerp(to, (heat - lo) / (hi - lo));
  }
  return /** @type {THREE.Color} */ (SCALE[SCALE.length - 1][1]).clone();
}

export class Heat {
  on = true;
  group = new THREE.Group();
  /** @type {Map<string, THREE.Mesh>} */
  #patches = new Map();
  #generation = 0;

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

  /** @param {Clash[]} clashes the worse ones last, so that they lie on top */
  async show(clashes) {
    const generation = ++this.#generation;
    const wanted = new Map();
    for (const clash of this.on ? clashes : []) {
      if (clash.class === 'none' || clash.ended) continue;
      wanted.set(`${clash.a} ${clash.faces[0] || `at ${clash.clash}`}`, { part: clash.a, face: clash.faces[0], clash });
      wanted.set(`${clash.b} ${clash.faces[1] || `at ${clash.clash}`}`, { part: clash.b, face: clash.faces[1], clash });
    }
    for (const [key, patch] of this.#patches) if (!wanted.has(key)) this.#drop(key, patch);
    for (const [key, { part, face, clash }] of wanted) {
      const patch = this.#patches.get(key) ?? (await this.#make(key, part, face, clash));
      if (generation !== this.#generation) return;
      const material = /** @type {THREE.MeshStandardMaterial | undefined} */ (patch?.material);
      if (!material) continue;
      material.color = colourOfHeat(heatOf(clash));
      material.clippingPlanes = this.partsView.looks.clipping;
    }
    this.stage.ask();
  }

  /** @param {string} key @param {THREE.Mesh} patch */
  #drop(key, patch) {
    this.group.remove(patch);
    patch.geometry.dispose();
    this.#patches.delete(key);
  }

  clear() {
    for (const [key, patch] of this.#patches) this.#drop(key, patch);
  }

  /** @param {string} key @param {number} id @param {string} face @param {Clash} clash */
  async #make(key, id, face, clash) {
    const part = this.session.parts.get(id);
    const shown = this.partsView.shown.get(id);
    const mesh = part && (await this.partsView.meshOf(part));
    if (!mesh || !shown || this.#patches.has(key)) return this.#patches.get(key);
    const feature = this.session.features.get(id)?.find((f) => f.name === face);
    const point = inPart(part, clash.point);
    const normal = rotate(conjugate(part.q), clash.normal);
    const reach = Math.max(2, part.radius * 0.15);
    const facets = feature ? facetsOf(mesh, feature) : facetsAbout(mesh, point, normal, reach);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(mesh.points, 3));
    geometry.setIndex(facets.flatMap((k) => [mesh.triangles[k], mesh.triangles[k + 1], mesh.triangles[k + 2]]));
    const material = new THREE.MeshStandardMaterial({
      roughness: 0.6, flatShading: true, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1,
    });
    if (!feature) fade(material, point, reach);
    const patch = new THREE.Mesh(geometry, material);
    patch.matrixAutoUpdate = patch.matrixWorldAutoUpdate = false;
    patch.matrixWorld = shown.faces.matrixWorld;
    patch.frustumCulled = false;
    this.#patches.set(key, patch);
    this.group.add(patch);
    return patch;
  }
}
