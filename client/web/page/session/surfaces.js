// The surfaces that faces stand for, and which facets stand for them. In the frame of the part, mm.
import { cross, dot, unit } from './slice.js';

/** @typedef {import('./session.js').Feature} Feature */
/** @typedef {import('./frames.js').Mesh} Mesh */
/** @typedef {import('./motion.js').Vec3} Vec3 */

/** Facets stand off their true face by up to this share of its radius: 24 facets by 1 - cos 7.5°. */
const SAG_SHARE = 0.012;
const FLAT_MM = 0.02;

/** How far a point is from the face's surface, mm; infinite for what is unknown. @param {Feature} feature @param {Vec3} x */
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
 * @param {Mesh} mesh @param {Feature} feature @returns {number[]} first index of each
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

/** @param {Mesh} mesh @param {number} i @returns {Vec3} */
function pointOf(mesh, i) {
  return [mesh.points[3 * i], mesh.points[3 * i + 1], mesh.points[3 * i + 2]];
}

/**
 * Without a known face: what comes near the point and looks the way of the clash.
 * @param {Mesh} mesh @param {Vec3} point @param {Vec3} normal in the frame of the part @param {number} reach
 */
export function facetsAbout(mesh, point, normal, reach) {
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
