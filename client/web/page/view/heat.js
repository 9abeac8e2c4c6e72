// Heat on faces: the faces that clash, coloured by how far the clash has gone between the two thresholds and beyond.
import * as THREE from 'three';
import { conjugate, rotate } from '../session/motion.js';
import { cross, dot, unit } from '../session/slice.js';

/** @typedef {import('../session/session.js').Clash} Clash */
/** @typedef {import('../session/session.js').Feature} Feature */
/** @typedef {import('../session/motion.js').Vec3} Vec3 */

/** Facets stand off their true face by up to this share of its radius: 24 facets by 1 - cos 7.5°. */
const SAG_SHARE = 0.012;
const FLAT_MM = 0.02;

/** How far a point is from the face's surface, mm; for a torus and what is unknown: not at all. @param {Feature} feature @param {Vec3} x */
export function offSurface(feature, x) {
  /** @type {Vec3} */
  const d = [x[0] - feature.point[0], x[1] - feature.point[1], x[2] - feature.point[2]];
  const h = dot(d, feature.axis);
  const r = Math.sqrt(Math.max(0, dot(d, d) - h * h));
  switch (feature.kind) {
    case 'plane':
      return Math.abs(h);
    case 'cylinder':
      return Math.abs(r - feature.radius);
    case 'cone':
      return Math.abs(r * Math.cos(feature.half_angle) - h * Math.sin(feature.half_angle));
    case 'sphere':
      return Math.abs(Math.sqrt(dot(d, d)) - feature.radius);
    case 'torus':
      return Math.abs(Math.hypot(r - feature.radius, h) - feature.tube_radius);
    default:
      return Infinity;
  }
}

/**
 * The triangles of a mesh that stand for a face.
 * @param {import('../session/frames.js').Mesh} mesh @param {Feature} feature @returns {number[]} first index of each
 */
export function facetsOf(mesh, feature) {
  const near = feature.kind === 'plane' ? FLAT_MM : Math.max(FLAT_MM, SAG_SHARE * Math.max(feature.radius, feature.tube_radius));
  const [lo, hi] = feature.along;
  const bounded = hi > lo;
  const found = [];
  for (let k = 0; k < mesh.triangles.length; k += 3) {
    const corners = [0, 1, 2].map((i) => pointOf(mesh, mesh.triangles[k + i]));
    const on = corners.every((x) => {
      const h = dot([x[0] - feature.point[0], x[1] - feature.point[1], x[2] - feature.point[2]], feature.axis);
      return offSurface(feature, x) <= near && (!bounded || feature.kind === 'plane' || (h >= lo - near && h <= hi + near));
    });
    if (on && facesAlike(feature, corners)) found.push(k);
  }
  return found;
}

/** A plane face has one side; the end of a bore lies on the bore's rim but is no part of it. @param {Feature} feature @param {Vec3[]} corners */
function facesAlike(feature, [a, b, c]) {
  const along = dot(normalOf([a, b, c]), feature.axis);
  if (feature.kind === 'plane') return along > 0.99;
  return feature.kind !== 'cylinder' || Math.abs(along) < 0.1;
}

/** @param {Vec3[]} corners */
function normalOf([a, b, c]) {
  return unit(cross([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]));
}

/** @param {import('../session/frames.js').Mesh} mesh @param {number} i @returns {Vec3} */
function pointOf(mesh, i) {
  return [mesh.points[3 * i], mesh.points[3 * i + 1], mesh.points[3 * i + 2]];
}

/**
 * Without a known face: what comes near the point and looks the way of the clash.
 * @param {import('../session/frames.js').Mesh} mesh @param {Vec3} point @param {Vec3} normal in the frame of the part @param {number} reach
 */
function facetsAbout(mesh, point, normal, reach) {
  const found = [];
  for (let k = 0; k < mesh.triangles.length; k += 3) {
    const corners = [0, 1, 2].map((i) => pointOf(mesh, mesh.triangles[k + i]));
    const beside = [0, 1, 2].some((axis) => {
      const along = corners.map((x) => x[axis] - point[axis]);
      return Math.min(...along) > reach || Math.max(...along) < -reach;
    });
    if (!beside && Math.abs(dot(normalOf(corners), normal)) > 0.5) found.push(k);
  }
  return found;
}

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

/** @param {{p: Vec3, q: import('../session/motion.js').Quat}} part @param {Vec3} point @returns {Vec3} */
function inPart(part, point) {
  return rotate(conjugate(part.q), [point[0] - part.p[0], point[1] - part.p[1], point[2] - part.p[2]]);
}
