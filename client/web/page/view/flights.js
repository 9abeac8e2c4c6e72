// To a part, to everything, to a clash; and the cut through one.
import * as THREE from 'three';
import { across, cross, unit } from '../session/slice.js';

/**
 * @param {{session: import('../session/session.js').Session, choice: import('../session/choice.js').Choice, camera: import('./camera.js').Camera,
 *   partsView: import('./parts_view.js').PartsView, section: import('./section_plane.js').SectionPlane}} desk
 */
export function makeFlights({ session, choice, camera, partsView, section }) {
  /** @param {string} [side] @param {boolean} [atOnce] */
  function showAll(side, atOnce) {
    const seen = [...session.parts.values()].filter((part) => !choice.hidden.has(part.id));
    const boxes = partsView.boxesOf(seen.length > 0 ? seen : session.parts.values());
    if (boxes.length > 0) camera.fit(boxes, side, atOnce);
  }

  /** @param {number} id */
  function showPart(id) {
    const part = session.parts.get(id);
    const boxes = part ? partsView.boxesOf([part]) : [];
    if (part && boxes.length > 0) camera.fit(boxes.map((box) => box.expandByScalar(part.radius * 0.35)));
  }

  /** So near that the smaller of the two parts fills the view, from where its point is not looked at along the face. @param {number} id */
  function flyToClash(id) {
    const clash = session.clashes.get(id);
    if (!clash) return;
    const radii = [session.parts.get(clash.a), session.parts.get(clash.b)].map((part) => part?.radius ?? 50);
    const { camera: eye } = camera.stage;
    const back = eye.position.clone().sub(camera.target).normalize();
    const normal = new THREE.Vector3(...clash.normal);
    // An arrow that points at the eye is a dot: look at it from the side.
    if (Math.abs(back.dot(normal)) > 0.9) back.addScaledVector(new THREE.Vector3(...across(clash.normal)), 0.8).normalize();
    camera.visit(new THREE.Vector3(...clash.point), Math.max(8, 5 * Math.min(...radii)), back);
  }

  /** The plane holds the normal of the clash, and faces the eye as far as that allows. @param {number} id */
  function cutAtClash(id) {
    const clash = session.clashes.get(id);
    if (!clash) return;
    const { camera: eye } = camera.stage;
    const back = eye.position.clone().sub(camera.target).normalize().toArray();
    const u = unit(clash.normal);
    const side = cross(u, /** @type {[number, number, number]} */ (back));
    const n = Math.hypot(...side) > 0.05 ? unit(cross(unit(side), u)) : across(u);
    // What is before the plane, on the side of the eye, goes: three keeps the side of the normal.
    section.bounds = partsView.bounds();
    section.cutAt(new THREE.Vector3(...clash.point), new THREE.Vector3(...n).negate());
  }

  /** The next or last clash of the list as it stands. @param {number} way */
  function goClash(way) {
    const keys = [...document.querySelectorAll('#clashes [data-key]:not(.head)')].map((row) => Number(/** @type {HTMLElement} */ (row).dataset.key));
    if (keys.length === 0) return;
    const at = keys.indexOf(choice.clash);
    choice.chooseClash(keys[(at < 0 ? (way > 0 ? 0 : keys.length - 1) : at + way + keys.length) % keys.length]);
  }

  return { showAll, showPart, flyToClash, cutAtClash, goClash };
}
