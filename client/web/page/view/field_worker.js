// Works out fields of overlap beside the page, so that a picture never waits for one.
import { inPart, placed } from '../session/motion.js';
import { SurfaceTree, fieldOver } from '../session/overlap_field.js';
import { facetsAbout, facetsOf } from '../session/surfaces.js';

/** @typedef {import('../session/motion.js').Vec3} Vec3 */
/** @typedef {{p: Vec3, q: import('../session/motion.js').Quat}} Pose */
/**
 * @typedef {object} Ask for the field of one face inside another part
 * @property {string} key of the answer @property {string} own hash of the mesh @property {string} other
 * @property {Pose} ownPose @property {Pose} otherPose @property {import('../session/session.js').Feature | null} feature
 * @property {Vec3} point @property {Vec3} normal in the frame of the own part @property {number} reach about the point, without a feature
 * @property {number} far beyond which nothing is of interest @property {number} bend @property {number} most points
 */

/** A face is cut into about so many lengths at least, and into no finer ones than the second. */
const LENGTHS = { least: 10, most: 400 };

/** @type {Map<string, import('../session/frames.js').Mesh>} */
const meshes = new Map();
/** @type {Map<string, SurfaceTree>} */
const trees = new Map();

/** @param {string} hash */
function treeOf(hash) {
  const mesh = meshes.get(hash);
  let tree = trees.get(hash);
  if (!tree && mesh) trees.set(hash, (tree = new SurfaceTree(mesh)));
  return tree;
}

/** @param {import('../session/frames.js').Mesh} mesh @param {number[]} facets */
function extentOf(mesh, facets) {
  let extent = 0;
  for (let axis = 0; axis < 3; ++axis) {
    let [lo, hi] = [Infinity, -Infinity];
    for (const k of facets) {
      for (let i = 0; i < 3; ++i) {
        const x = mesh.points[3 * mesh.triangles[k + i] + axis];
        [lo, hi] = [Math.min(lo, x), Math.max(hi, x)];
      }
    }
    if (hi > lo) extent = Math.max(extent, hi - lo);
  }
  return extent;
}

/** @param {Ask} ask */
function answer(ask) {
  const mesh = meshes.get(ask.own);
  const tree = treeOf(ask.other);
  if (!mesh || !tree) return null;
  const facets = ask.feature ? facetsOf(mesh, ask.feature) : facetsAbout(mesh, ask.point, ask.normal, ask.reach);
  const extent = extentOf(mesh, facets);
  const overlap = (/** @type {Vec3} */ x) => -tree.signedDistance(inPart(ask.otherPose, placed(ask.ownPose, x)), ask.far);
  return fieldOver(mesh, facets, overlap, { bend: ask.bend, finest: extent / LENGTHS.most, coarsest: extent / LENGTHS.least, most: ask.most });
}

self.addEventListener('message', ({ data }) => {
  if (data.mesh) {
    meshes.set(data.mesh, { points: data.points, triangles: data.triangles });
    return;
  }
  const field = answer(data);
  const buffers = field ? [field.points.buffer, field.overlap.buffer, field.triangles.buffer] : [];
  /** @type {any} */ (self).postMessage({ key: data.key, field }, buffers);
});
