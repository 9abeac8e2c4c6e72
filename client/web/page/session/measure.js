// Distances, angles and diameters between what was picked: points, axes, planes, centres, in the frame of the world, mm and rad.
import { cross, dot, unit } from './slice.js';
import { knownFake, knownReal, small } from './words.js';

/** @typedef {import('./motion.js').Vec3} Vec3 */
/**
 * @typedef {object} Picked
 * @property {'point' | 'plane' | 'cylinder' | 'cone' | 'sphere' | 'torus'} kind @property {Vec3} at a point of it: on the plane, on the axis, the centre
 * @property {Vec3} axis unit; of a point of no meaning @property {number} radius 0: none
 * @property {boolean} inward a bore
 */
/** @typedef {{name: string, mm?: number, rad?: number}} Figure */
/** @typedef {{figures: Figure[], from: Vec3, to: Vec3}} Measured the line from `from` to `to` is what the first figure measures */

/** Faces that are parallel up to this are parallel: about the turn that moves the rim of a large part by a micrometre. */
const PARALLEL_RAD = 1e-5;

const minus = (/** @type {Vec3} */ a, /** @type {Vec3} */ b) => /** @type {Vec3} */ ([a[0] - b[0], a[1] - b[1], a[2] - b[2]]);
const along = (/** @type {Vec3} */ p, /** @type {Vec3} */ v, /** @type {number} */ s) => /** @type {Vec3} */ ([p[0] + s * v[0], p[1] + s * v[1], p[2] + s * v[2]]);
const length = (/** @type {Vec3} */ v) => Math.hypot(...v);

/** Of two directions without a sense, 0 to pi/2. @param {Vec3} a @param {Vec3} b */
const angleOf = (a, b) => Math.atan2(length(cross(a, b)), Math.abs(dot(a, b)));

const hasAxis = (/** @type {Picked} */ p) => p.kind === 'cylinder' || p.kind === 'cone' || p.kind === 'torus';
const isRound = (/** @type {Picked} */ p) => p.kind === 'cylinder' || p.kind === 'sphere';

/**
 * The gap of the real surfaces of a pair that the session has judged, where its two parts are deepest in each other: the overlap that is told, with what deviation and
 * tolerances of both add to it. The thresholds are where that would begin to be possible, and be certain. Below 0: an overlap. null: that end was left open.
 * @param {import('./session.js').Clash} clash @returns {[number | null, number | null]}
 */
export function realGap(clash) {
  const [fake, real] = [knownFake(clash), knownReal(clash)];
  return [fake === null ? null : fake - clash.delta[1], real === null ? null : real - clash.delta[0]];
}

/** @param {import('./session.js').Clash} clash */
export function realGapSaid(clash) {
  const [lo, hi] = realGap(clash);
  if (lo === null && hi === null) return 'their real gap was not decided beyond the class';
  if (lo === null) return `real gap at most ${small(hi)}`;
  return hi === null ? `real gap at least ${small(lo)}` : `real gap ${small(lo)} to ${small(hi)}`;
}

/** Intervals narrower than this are told to a tenth of a micrometre, mm. */
const NARROW_MM = 0.02;

/**
 * How far two parts are apart: their meshes, and in brackets the least and the most that their real surfaces may be.
 * @param {{mesh_mm: number, real_mm: [number, number]}} gap as the gateway tells it @returns {string} "0.100 mm (0.079 to 0.121)"
 */
export function gapSaid({ mesh_mm, real_mm: [lo, hi] }) {
  const told = (/** @type {number} */ mm) => mm.toFixed(hi - lo < NARROW_MM ? 4 : 3).replace(/^-(0\.0+)$/, '$1');
  return `${told(mesh_mm)} mm (${told(lo)} to ${told(hi)})`;
}

/** What one of them has by itself. @param {Picked} picked @returns {Figure[]} */
export function ofOne(picked) {
  return isRound(picked) ? [{ name: 'Diameter', mm: 2 * picked.radius }] : [];
}

/** @param {Picked} a @param {Picked} b @returns {Measured} */
export function between(a, b) {
  if (a.kind === 'plane' && b.kind === 'plane') return planes(a, b);
  if (a.kind === 'plane') return planeAndOther(a, b);
  if (b.kind === 'plane') return planeAndOther(b, a);
  if (hasAxis(a) && hasAxis(b)) return axes(a, b);
  if (hasAxis(a)) return axisAndPoint(a, b);
  if (hasAxis(b)) return axisAndPoint(b, a);
  return points(a, b);
}

/** @param {Picked} a @param {Picked} b @returns {Measured} */
function points(a, b) {
  const mm = length(minus(b.at, a.at));
  const gap = a.radius || b.radius ? [{ name: 'Between surfaces', mm: mm - a.radius - b.radius }] : [];
  return { figures: [{ name: 'Distance', mm }, ...gap], from: a.at, to: b.at };
}

/** @param {Picked} plane @param {Picked} other @returns {Measured} */
function planeAndOther(plane, other) {
  const off = dot(minus(other.at, plane.at), plane.axis);
  const foot = along(other.at, plane.axis, -off);
  /** @type {Figure[]} */
  const figures = [];
  if (hasAxis(other)) {
    const rad = Math.PI / 2 - angleOf(plane.axis, other.axis);
    if (rad > PARALLEL_RAD) return { figures: [{ name: 'Angle of the axis to the plane', rad }], from: other.at, to: foot };
    figures.push({ name: 'Axis to plane', mm: Math.abs(off) });
  } else {
    figures.push({ name: other.kind === 'sphere' ? 'Centre to plane' : 'Point to plane', mm: Math.abs(off) });
  }
  if (isRound(other)) figures.push({ name: 'Surface to plane', mm: Math.abs(off) - other.radius });
  return { figures, from: other.at, to: foot };
}

/** @param {Picked} a @param {Picked} b @returns {Measured} */
function planes(a, b) {
  const rad = angleOf(a.axis, b.axis);
  const off = dot(minus(b.at, a.at), a.axis);
  const figures = rad <= PARALLEL_RAD ? [{ name: 'Distance', mm: Math.abs(off) }] : [{ name: 'Angle', rad }];
  return { figures, from: a.at, to: rad <= PARALLEL_RAD ? along(a.at, a.axis, off) : b.at };
}

/** @param {Picked} axis @param {Picked} other a point, or a sphere @returns {Measured} */
function axisAndPoint(axis, other) {
  const foot = along(axis.at, axis.axis, dot(minus(other.at, axis.at), axis.axis));
  const mm = length(minus(other.at, foot));
  const gap = axis.kind === 'cylinder' ? [{ name: 'To the surface', mm: (axis.inward ? axis.radius - mm : mm - axis.radius) - other.radius }] : [];
  return { figures: [{ name: 'To the axis', mm }, ...gap], from: other.at, to: foot };
}

/** @param {Picked} a @param {Picked} b @returns {Measured} */
function axes(a, b) {
  const rad = angleOf(a.axis, b.axis);
  const d = minus(b.at, a.at);
  if (rad > PARALLEL_RAD) {
    const n = unit(cross(a.axis, b.axis));
    return { figures: [{ name: 'Angle', rad }, { name: 'Axes apart', mm: Math.abs(dot(d, n)) }], from: a.at, to: b.at };
  }
  const foot = along(a.at, a.axis, dot(d, a.axis));
  const mm = length(minus(b.at, foot));
  /** @type {Figure[]} */
  const figures = [{ name: 'Axes apart', mm }];
  if (a.kind === 'cylinder' && b.kind === 'cylinder') {
    if (a.inward !== b.inward) {
      const [bore, shaft] = a.inward ? [a, b] : [b, a];
      figures.push({ name: 'Bore less shaft, diameters', mm: 2 * (bore.radius - shaft.radius) }, { name: 'Least gap', mm: bore.radius - shaft.radius - mm });
    } else if (!a.inward) {
      figures.push({ name: 'Least gap', mm: mm - a.radius - b.radius });
    }
  }
  return { figures, from: foot, to: b.at };
}
