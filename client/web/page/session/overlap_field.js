// How deep a face lies inside another part, point by point: the field that heat shows. Pure; in the frame of the other part, mm.
// Shown, not judged: the class of a clash is the session's word alone.
import { cross, dot } from './slice.js';

/** @typedef {import('./motion.js').Vec3} Vec3 */
/** @typedef {import('./frames.js').Mesh} Mesh */
/**
 * A face cut into triangles so small that the field is nearly linear on each.
 * @typedef {object} Field
 * @property {Float32Array} points x, y, z in the frame of the face's own part
 * @property {Float32Array} overlap of each point: how deep it lies in the other part, negative outside
 * @property {Uint32Array} triangles @property {number} deepest @property {boolean} cut short of what was asked for
 */

const LEAF = 6;
/** Two facets are equally near when they differ by less: at an edge or a corner. */
const ALIKE = 1e-7;

/** The facets of a mesh by boxes, for the nearest of them. Built once a mesh. */
export class SurfaceTree {
  /** @param {Mesh} mesh */
  constructor({ points, triangles }) {
    const count = triangles.length / 3;
    this.points = points;
    this.triangles = triangles;
    this.order = Uint32Array.from({ length: count }, (_, k) => k);
    this.boxes = new Float64Array(6 * count);
    for (let k = 0; k < count; ++k) {
      for (let axis = 0; axis < 3; ++axis) {
        const [a, b, c] = [0, 1, 2].map((i) => points[3 * triangles[3 * k + i] + axis]);
        this.boxes[6 * k + axis] = Math.min(a, b, c);
        this.boxes[6 * k + 3 + axis] = Math.max(a, b, c);
      }
    }
    this.root = this.#node(0, count);
  }

  /** @param {number} from @param {number} to of `order` @returns {any} */
  #node(from, to) {
    const box = [Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity];
    for (let at = from; at < to; ++at) {
      for (let i = 0; i < 3; ++i) {
        box[i] = Math.min(box[i], this.boxes[6 * this.order[at] + i]);
        box[3 + i] = Math.max(box[3 + i], this.boxes[6 * this.order[at] + 3 + i]);
      }
    }
    if (to - from <= LEAF) return { box, from, to };
    const sizes = [0, 1, 2].map((i) => box[3 + i] - box[i]);
    const axis = sizes.indexOf(Math.max(...sizes));
    const middle = (/** @type {number} */ k) => this.boxes[6 * k + axis] + this.boxes[6 * k + 3 + axis];
    this.order.subarray(from, to).sort((a, b) => middle(a) - middle(b));
    const half = (from + to) >> 1;
    return { box, children: [this.#node(from, half), this.#node(half, to)] };
  }

  /** Negative inside; `far` where no facet is nearer than that. @param {Vec3} x @param {number} far */
  signedDistance(x, far) {
    const best = { d2: far * far, lean: -1, side: 1 };
    this.#visit(this.root, x, best);
    return best.lean < 0 ? far : best.side * Math.sqrt(best.d2);
  }

  /** @param {any} node @param {Vec3} x @param {{d2: number, lean: number, side: number}} best */
  #visit(node, x, best) {
    if (apart2(node.box, x) > best.d2 * (1 + ALIKE)) return;
    if (node.children) {
      const [a, b] = node.children;
      const aFirst = apart2(a.box, x) <= apart2(b.box, x);
      this.#visit(aFirst ? a : b, x, best);
      this.#visit(aFirst ? b : a, x, best);
      return;
    }
    for (let at = node.from; at < node.to; ++at) this.#look(this.order[at], x, best);
  }

  /** @param {number} k @param {Vec3} x @param {{d2: number, lean: number, side: number}} best */
  #look(k, x, best) {
    const [a, b, c] = [0, 1, 2].map((i) => {
      const p = 3 * this.triangles[3 * k + i];
      return /** @type {Vec3} */ ([this.points[p], this.points[p + 1], this.points[p + 2]]);
    });
    const normal = cross(minus(b, a), minus(c, a));
    const length = Math.hypot(...normal);
    if (length === 0) return;
    const off = minus(x, nearestOn(x, a, b, c));
    const d2 = dot(off, off);
    if (d2 > best.d2 * (1 + ALIKE)) return;
    // Of facets that share the nearest edge or corner the one that is looked at most squarely says on which side x is.
    const height = dot(off, normal) / length;
    const lean = d2 > 0 ? Math.abs(height) / Math.sqrt(d2) : 1;
    if (best.lean >= 0 && d2 >= best.d2 * (1 - ALIKE) && lean <= best.lean) return;
    Object.assign(best, { d2: Math.min(d2, best.d2), lean, side: height < 0 ? -1 : 1 });
  }
}

/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];

/** @param {number[]} box @param {Vec3} x */
function apart2(box, x) {
  let sum = 0;
  for (let i = 0; i < 3; ++i) {
    const out = Math.max(box[i] - x[i], 0, x[i] - box[3 + i]);
    sum += out * out;
  }
  return sum;
}

/** On a segment. @param {Vec3} x @param {Vec3} a @param {Vec3} b @returns {Vec3} */
function nearestOnEdge(x, a, b) {
  const along = minus(b, a);
  const length2 = dot(along, along);
  const s = length2 === 0 ? 0 : Math.min(1, Math.max(0, dot(minus(x, a), along) / length2));
  return [a[0] + s * along[0], a[1] + s * along[1], a[2] + s * along[2]];
}

/** On a triangle: its plane's foot where that is inside, else on the nearest edge. @param {Vec3} x @param {Vec3} a @param {Vec3} b @param {Vec3} c @returns {Vec3} */
export function nearestOn(x, a, b, c) {
  const normal = cross(minus(b, a), minus(c, a));
  const height = dot(minus(x, a), normal) / dot(normal, normal);
  const foot = /** @type {Vec3} */ ([x[0] - height * normal[0], x[1] - height * normal[1], x[2] - height * normal[2]]);
  const corners = [a, b, c];
  let nearest = foot;
  let least = Infinity;
  for (let i = 0; i < 3; ++i) {
    const [from, to] = [corners[i], corners[(i + 1) % 3]];
    if (dot(cross(minus(to, from), minus(foot, from)), normal) >= 0) continue;
    const on = nearestOnEdge(x, from, to);
    const off = minus(x, on);
    if (dot(off, off) < least) [nearest, least] = [on, dot(off, off)];
  }
  return nearest;
}

/**
 * The field over facets. Edges are halved where the other part may be near (the distance changes by no more than one goes) and the
 * field bends; an edge is halved for both its triangles or for none, so nothing tears.
 * @param {Mesh} mesh @param {number[]} facets first index of each
 * @param {(x: Vec3) => number} overlap of a point in the frame of this part
 * @param {{bend: number, finest: number, coarsest: number, most: number}} how mm, mm, mm, points
 * @returns {Field}
 */
export function fieldOver(mesh, facets, overlap, { bend, finest, coarsest, most }) {
  /** @type {Vec3[]} */ const points = [];
  /** @type {number[]} */ const depths = [];
  const add = (/** @type {Vec3} */ x) => (depths.push(overlap(x)), points.push(x) - 1);
  /** @type {Map<number, number>} */ const known = new Map();
  const corner = (/** @type {number} */ i) => {
    let at = known.get(i);
    if (at === undefined) known.set(i, (at = add([mesh.points[3 * i], mesh.points[3 * i + 1], mesh.points[3 * i + 2]])));
    return at;
  };
  let triangles = facets.map((k) => [0, 1, 2].map((i) => corner(mesh.triangles[k + i])));
  /** @type {Map<string, number>} */ const halves = new Map();
  /** The point in the middle where an edge is to be halved, else -1. @param {number} i @param {number} j */
  const half = (i, j) => {
    const key = i < j ? `${i} ${j}` : `${j} ${i}`;
    let at = halves.get(key);
    if (at === undefined) halves.set(key, (at = halved(i, j)));
    return at;
  };
  /** @param {number} i @param {number} j */
  const halved = (i, j) => {
    const length = Math.hypot(...minus(points[i], points[j]));
    if (length < 2 * finest || Math.max(depths[i], depths[j]) < -length || points.length >= most) return -1;
    const middle = /** @type {Vec3} */ ([0, 1, 2].map((k) => (points[i][k] + points[j][k]) / 2));
    const depth = overlap(middle);
    if (length <= coarsest && Math.abs(depth - (depths[i] + depths[j]) / 2) <= bend) return -1;
    depths.push(depth);
    return points.push(middle) - 1;
  };
  for (let before = -1; triangles.length !== before;) {
    before = triangles.length;
    triangles = triangles.flatMap(([a, b, c]) => pieces(a, b, c, half(a, b), half(b, c), half(c, a)));
  }
  const deepest = depths.reduce((most, depth) => Math.max(most, depth), -Infinity);
  return { points: Float32Array.from(points.flat()), overlap: Float32Array.from(depths), triangles: Uint32Array.from(triangles.flat()), deepest, cut: points.length >= most };
}

/** A triangle whose edges are halved at these points, -1 where not. @param {number} a @param {number} b @param {number} c @param {number} ab @param {number} bc @param {number} ca @returns {number[][]} */
function pieces(a, b, c, ab, bc, ca) {
  const count = Number(ab >= 0) + Number(bc >= 0) + Number(ca >= 0);
  if (count === 0) return [[a, b, c]];
  if (count === 3) return [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
  // Turned so that the first edge is halved, and of two the first and the second.
  if (ab < 0 || (count === 2 && bc < 0)) return pieces(b, c, a, bc, ca, ab);
  if (count === 1) return [[a, ab, c], [ab, b, c]];
  return [[a, ab, c], [ab, b, bc], [ab, bc, c]];
}
