// The outline in which a plane cuts a mesh: for the section drawing of a clash. Pure, single meshes of the page's size.
import { conjugate, rotate } from './motion.js';

/** @typedef {import('./motion.js').Vec3} Vec3 */
/** @typedef {import('./motion.js').Quat} Quat */
/** @typedef {[number, number, number, number]} Segment x0, y0, x1, y1 in the plane, mm */
/**
 * A plane of the world with axes: u to the right, v up, seen against u × v.
 * @typedef {{origin: Vec3, u: Vec3, v: Vec3}} Plane
 */

/** @param {Readonly<Vec3>} a @param {Readonly<Vec3>} b */
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** @param {Readonly<Vec3>} a @param {Readonly<Vec3>} b @returns {Vec3} */
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** @param {Readonly<Vec3>} v @returns {Vec3} */
export function unit(v) {
  const length = Math.hypot(...v) || 1;
  return [v[0] / length, v[1] / length, v[2] / length];
}

/** A unit vector across `v`, the same for the same v. @param {Readonly<Vec3>} v @returns {Vec3} */
export function across(v) {
  const least = Math.abs(v[2]) < 0.9 ? /** @type {Vec3} */ ([0, 0, 1]) : /** @type {Vec3} */ ([1, 0, 0]);
  return unit(cross(least, v));
}

/**
 * Where the plane cuts the mesh, as directed segments with the material on their left. A corner in the plane counts as above it, so that no segment comes twice.
 * @param {import('./frames.js').Mesh} mesh @param {{p: Vec3, q: Quat}} pose @param {Plane} plane
 * @returns {Segment[]}
 */
export function slice(mesh, pose, plane) {
  // The plane goes into the frame of the part: three vectors instead of all points.
  const back = conjugate(pose.q);
  const origin = rotate(back, [plane.origin[0] - pose.p[0], plane.origin[1] - pose.p[1], plane.origin[2] - pose.p[2]]);
  const u = rotate(back, plane.u);
  const v = rotate(back, plane.v);
  const n = cross(u, v);
  const { points, triangles } = mesh;
  /** @param {number} i @returns {Vec3} */
  const seen = (i) => {
    /** @type {Vec3} */
    const d = [points[3 * i] - origin[0], points[3 * i + 1] - origin[1], points[3 * i + 2] - origin[2]];
    return [dot(d, u), dot(d, v), dot(d, n)];
  };
  /** @type {Segment[]} */
  const segments = [];
  for (let k = 0; k < triangles.length; k += 3) {
    const corners = [seen(triangles[k]), seen(triangles[k + 1]), seen(triangles[k + 2])];
    const segment = cut(corners);
    if (segment) segments.push(segment);
  }
  return segments;
}

/** @param {Vec3[]} corners with the height over the plane last @returns {Segment | null} */
function cut(corners) {
  /** @type {Array<[number, number]>} */
  let down = [];
  /** @type {Array<[number, number]>} */
  let up = [];
  for (let i = 0; i < 3; ++i) {
    const a = corners[i];
    const b = corners[(i + 1) % 3];
    if (a[2] >= 0 === b[2] >= 0) continue;
    const s = a[2] / (a[2] - b[2]);
    (a[2] >= 0 ? down : up).push([a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])]);
  }
  if (down.length !== 1 || up.length !== 1) return null;
  return [...down[0], ...up[0]];
}

/**
 * The point of the segments that is nearest to `to`, and how far it is; infinitely far without any.
 * @param {Segment[]} segments @param {[number, number]} [to]
 */
export function nearest(segments, [x, y] = [0, 0]) {
  let apart = Infinity;
  /** @type {[number, number]} */
  let at = [x, y];
  for (const [x0, y0, x1, y1] of segments) {
    const length2 = (x1 - x0) ** 2 + (y1 - y0) ** 2;
    const s = length2 === 0 ? 0 : Math.min(1, Math.max(0, ((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / length2));
    const [px, py] = [x0 + s * (x1 - x0), y0 + s * (y1 - y0)];
    const off = Math.hypot(px - x, py - y);
    if (off < apart) [apart, at] = [off, [px, py]];
  }
  return { apart, at };
}

/**
 * Segments joined end to end: closed loops, and open chains where the reach cut them off.
 * @param {Segment[]} segments @param {number} apart ends closer than this are one, mm
 * @returns {Array<Array<[number, number]>>}
 */
export function chains(segments, apart = 1e-4) {
  /** @param {number} x @param {number} y */
  const key = (x, y) => `${Math.round(x / apart)},${Math.round(y / apart)}`;
  /** @type {Map<string, Segment[]>} */
  const from = new Map();
  const ends = new Set();
  for (const s of segments) {
    if (key(s[0], s[1]) === key(s[2], s[3])) continue;
    const at = key(s[0], s[1]);
    const known = from.get(at);
    if (known) known.push(s);
    else from.set(at, [s]);
    ends.add(key(s[2], s[3]));
  }
  // Open chains begin where nothing ends; what is left are loops.
  const starts = [...from.keys()].filter((at) => !ends.has(at));
  /** @type {Array<Array<[number, number]>>} */
  const found = [];
  for (const start of [...starts, ...from.keys()]) {
    /** @type {Array<[number, number]>} */
    const chain = [];
    let next = from.get(start)?.pop();
    while (next) {
      if (chain.length === 0) chain.push([next[0], next[1]]);
      chain.push([next[2], next[3]]);
      next = from.get(key(next[2], next[3]))?.pop();
    }
    if (chain.length > 1) found.push(chain);
  }
  return found;
}
