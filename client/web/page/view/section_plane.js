// The plane that cuts the picture: across an axis or through the chosen clash, moved by a slider.
import * as THREE from 'three';

/** @typedef {'x' | 'y' | 'z' | 'clash'} Across */

export class SectionPlane {
  on = false;
  /** @type {Across} */
  across = 'y';
  flipped = false;
  /** 0 … 1 of the scene along the normal. */
  share = 0.5;
  plane = new THREE.Plane(new THREE.Vector3(0, 1, 0), 0);
  /** @type {() => void} */
  onChange = () => {};

  /** @param {import('./parts_view.js').PartsView} partsView */
  constructor(partsView) {
    this.partsView = partsView;
    this.bounds = new THREE.Box3(new THREE.Vector3(-1, -1, -1), new THREE.Vector3(1, 1, 1));
    this.through = new THREE.Vector3();
    this.normal = new THREE.Vector3(0, 1, 0);
  }

  /** @param {boolean} on */
  set(on) {
    const changed = on !== this.on;
    this.on = on;
    this.place();
    if (changed) this.partsView.cutBy(on ? [this.plane] : []);
    this.onChange();
  }

  /** Cuts through a point. @param {THREE.Vector3} point @param {THREE.Vector3} normal of the plane; what lies before it goes */
  cutAt(point, normal) {
    this.across = 'clash';
    this.through.copy(point);
    this.normal.copy(normal).normalize();
    this.flipped = false;
    const [lo, hi] = this.#range();
    this.share = hi > lo ? (point.dot(this.normal) - lo) / (hi - lo) : 0.5;
    this.set(true);
  }

  /** The scene along the normal, mm. @returns {[number, number]} */
  #range() {
    const n = this.#direction();
    const { min, max } = this.bounds;
    let lo = 0;
    let hi = 0;
    for (const axis of /** @type {const} */ (['x', 'y', 'z'])) {
      const [a, b] = [n[axis] * min[axis], n[axis] * max[axis]];
      lo += Math.min(a, b);
      hi += Math.max(a, b);
    }
    return [lo, hi];
  }

  /** Through the middle one of the parts: a plane through the axis of what is put together along it. */
  centre() {
    const n = this.#direction();
    const { shown } = this.partsView;
    const along = this.partsView.boxesOf([...shown.values()].map(({ part }) => part)).map((box) => box.getCenter(new THREE.Vector3()).dot(n));
    along.sort((a, b) => a - b);
    const [lo, hi] = this.#range();
    const at = along[Math.floor(along.length / 2)] ?? (lo + hi) / 2;
    this.share = hi > lo ? (at - lo) / (hi - lo) : 0.5;
  }

  #direction() {
    if (this.across === 'clash') return this.normal.clone();
    return new THREE.Vector3(Number(this.across === 'x'), Number(this.across === 'y'), Number(this.across === 'z'));
  }

  /** Where the plane stands along its normal, mm. */
  get offset() {
    const [lo, hi] = this.#range();
    return lo + this.share * (hi - lo);
  }

  place() {
    const n = this.#direction();
    const offset = this.offset;
    // three keeps what lies on the side of the normal.
    this.plane.normal.copy(n).multiplyScalar(this.flipped ? -1 : 1);
    this.plane.constant = this.flipped ? offset : -offset;
    this.partsView.stage.ask();
  }
}
