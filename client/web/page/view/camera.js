// Where one looks from: orbit, fits, flights, and looking along with somebody else.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

const FLIGHT_MS = 450;
const TELL_MS = 150;
/** Room about what is shown. */
const MARGIN = 1.1;

/** From where, seen from the target. @type {Record<string, [number, number, number]>} */
const SIDES = {
  iso: [0.72, -1, 0.72],
  top: [0, -0.0001, 1],
  bottom: [0, -0.0001, -1],
  front: [0, -1, 0],
  back: [0, 1, 0],
  right: [1, 0, 0],
  left: [-1, 0, 0],
};

export class Camera {
  /** @type {{from: THREE.Vector3, to: THREE.Vector3, fromTarget: THREE.Vector3, toTarget: THREE.Vector3, begin: number} | null} */
  #flight = null;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #telling;
  /** @type {() => void} when somebody takes the view in hand */
  onHand = () => {};

  /** @param {import('./stage.js').Stage} stage @param {(view: {p: number[], target: number[], up: number[]}) => void} tell */
  constructor(stage, tell) {
    this.stage = stage;
    this.tell = tell;
    this.controls = new OrbitControls(stage.camera, stage.canvas);
    this.controls.zoomToCursor = true;
    this.controls.mouseButtons = { LEFT: THREE.MOUSE.ROTATE, MIDDLE: THREE.MOUSE.PAN, RIGHT: THREE.MOUSE.PAN };
    this.controls.addEventListener('change', () => {
      this.stage.ask();
      this.tellSoon();
    });
    this.controls.addEventListener('start', () => {
      this.#flight = null;
      this.onHand();
    });
    stage.beforePicture((now) => this.#fly(now));
  }

  get target() {
    return this.controls.target;
  }

  /** Where the eye is, mm. @returns {import('../session/motion.js').Vec3} */
  get eye() {
    return this.stage.camera.position.toArray();
  }

  /** What it looks at. @returns {import('../session/motion.js').Vec3} */
  get at() {
    return this.target.toArray();
  }

  /** At once. @param {import('../session/motion.js').Vec3} eye @param {import('../session/motion.js').Vec3} at */
  stand(eye, at) {
    this.flyTo(new THREE.Vector3(...eye), new THREE.Vector3(...at), true);
  }

  /** @param {THREE.Vector3} position @param {THREE.Vector3} target @param {boolean} [atOnce] */
  flyTo(position, target, atOnce = matchMedia('(prefers-reduced-motion: reduce)').matches) {
    const { camera } = this.stage;
    const begin = atOnce ? -Infinity : performance.now();
    this.#flight = { from: camera.position.clone(), to: position.clone(), fromTarget: this.target.clone(), toTarget: target.clone(), begin };
    this.stage.ask();
  }

  /** @param {number} now */
  #fly(now) {
    if (!this.#flight) return false;
    const { from, to, fromTarget, toTarget, begin } = this.#flight;
    const s = Math.min(1, Math.max(0, (now - begin) / FLIGHT_MS));
    const eased = s * s * (3 - 2 * s);
    this.stage.camera.position.lerpVectors(from, to, eased);
    this.target.lerpVectors(fromTarget, toTarget, eased);
    this.controls.update();
    if (s === 1) this.#flight = null;
    return s < 1;
  }

  /** So that these boxes fill the view. @param {THREE.Box3[]} boxes @param {string} [side] of SIDES; else as now @param {boolean} [atOnce] */
  fit(boxes, side, atOnce) {
    const { camera } = this.stage;
    const whole = boxes.reduce((sum, box) => sum.union(box), new THREE.Box3());
    const target = whole.getCenter(new THREE.Vector3());
    const back = side ? new THREE.Vector3(...SIDES[side]) : camera.position.clone().sub(this.target);
    back.normalize();
    const half = THREE.MathUtils.degToRad(camera.fov / 2);
    // The corners of the boxes as the eye will see them: the farthest that one of them asks for.
    const view = new THREE.Matrix4().lookAt(back, new THREE.Vector3(), camera.up).invert();
    let distance = 1;
    for (const at of boxes.flatMap(cornersOf)) {
      at.sub(target).applyMatrix4(view);
      const high = Math.abs(at.y) / Math.tan(half);
      const wide = Math.abs(at.x) / (Math.tan(half) * camera.aspect);
      distance = Math.max(distance, at.z + MARGIN * Math.max(high, wide));
    }
    this.setDepth(whole);
    this.flyTo(target.clone().addScaledVector(back, distance), target, atOnce);
  }

  /** Near and far for a scene of this size. @param {THREE.Box3} box */
  setDepth(box) {
    const size = box.getSize(new THREE.Vector3()).length();
    const { camera } = this.stage;
    camera.far = Math.max(camera.far, size * 40);
    camera.near = Math.max(camera.far / 200_000, 0.02);
    camera.updateProjectionMatrix();
  }

  /** To a place, from the side that `towards` says, else as now. @param {THREE.Vector3} point @param {number} distance @param {THREE.Vector3} [towards] */
  visit(point, distance, towards) {
    const back = towards ? towards.clone() : this.stage.camera.position.clone().sub(this.target);
    if (back.lengthSq() === 0) back.set(0.7, -1, 0.7);
    this.flyTo(point.clone().addScaledVector(back.normalize(), distance), point);
  }

  /** Looks along with somebody. @param {import('../session/session.js').View} view */
  follow(view) {
    this.flyTo(new THREE.Vector3(...view.p), new THREE.Vector3(...view.target));
  }

  /** From the target to the eye, once the eye went round it. @param {number} right @param {number} up rad */
  #turned(right, up) {
    const back = this.stage.camera.position.clone().sub(this.target);
    const ball = new THREE.Spherical().setFromVector3(new THREE.Vector3(back.x, back.z, -back.y));
    ball.theta += right;
    ball.phi = THREE.MathUtils.clamp(ball.phi - up, 0.01, Math.PI - 0.01);
    const turned = new THREE.Vector3().setFromSpherical(ball);
    return new THREE.Vector3(turned.x, -turned.z, turned.y);
  }

  /** @param {number} right @param {number} up rad */
  turn(right, up) {
    this.flyTo(this.#turned(right, up).add(this.target), this.target, true);
    this.onHand();
  }

  /** As if what is looked at were pushed right, up and towards the eye (in views) and turned (rad); z of the world stays up. @param {import('../session/motion.js').Increment} by */
  drive({ t, r }) {
    const { camera } = this.stage;
    const back = this.#turned(-r[1], r[0]).multiplyScalar(Math.exp(-t[2]));
    const view = 2 * back.length() * Math.tan(THREE.MathUtils.degToRad(camera.fov / 2));
    const target = new THREE.Vector3(-t[0] * view, -t[1] * view, 0).applyQuaternion(camera.quaternion).add(this.target);
    this.flyTo(back.add(target), target, true);
    this.onHand();
  }

  /** @param {number} times */
  closer(times) {
    const back = this.stage.camera.position.clone().sub(this.target);
    this.flyTo(back.divideScalar(times).add(this.target), this.target, true);
    this.onHand();
  }

  /** Soon, and the last one always: others look along. */
  tellSoon() {
    this.#telling ??= setTimeout(() => {
      this.#telling = undefined;
      const { camera } = this.stage;
      this.tell({ p: camera.position.toArray(), target: this.target.toArray(), up: camera.up.toArray() });
    }, TELL_MS);
  }
}

/** @param {THREE.Box3} box */
function cornersOf({ min, max }) {
  return [0, 1, 2, 3, 4, 5, 6, 7].map((k) => new THREE.Vector3(k & 1 ? max.x : min.x, k & 2 ? max.y : min.y, k & 4 ? max.z : min.z));
}
