// Handles at the held part: they move a stand-in, and what the stand-in moved is what is asked for. The part itself moves only
// where the session says.
import * as THREE from 'three';
import { TransformControls } from 'three/addons/controls/TransformControls.js';
import { conjugate, isNothing, multiply, placed, rotationVectorOf } from '../session/motion.js';

/** @typedef {import('../session/session.js').Part} Part */
/** @typedef {import('../session/motion.js').Quat} Quat */
/** @typedef {import('../session/motion.js').Vec3} Vec3 */

export class Handles {
  #standIn = new THREE.Object3D();
  /** @type {Vec3} */ #lastAt = [0, 0, 0];
  /** @type {Quat} */ #lastTurn = [0, 0, 0, 1];
  /** From where the part is to where the hand would have it. */
  #lag;
  /** @type {Part | null} */
  part = null;
  dragging = false;

  /**
   * @param {import('./stage.js').Stage} stage @param {import('./camera.js').Camera} camera
   * @param {(part: Part, increment: import('../session/motion.js').Increment) => void} push
   */
  constructor(stage, camera, push) {
    this.stage = stage;
    this.push = push;
    stage.scene.add(this.#standIn);
    this.controls = new TransformControls(stage.camera, stage.canvas);
    this.controls.setSpace('world');
    this.controls.setSize(0.85);
    this.#lag = new THREE.Line(
      new THREE.BufferGeometry().setFromPoints([new THREE.Vector3(), new THREE.Vector3()]),
      new THREE.LineDashedMaterial({ color: 0xf0892e, dashSize: 2, gapSize: 1.5, depthTest: false }),
    );
    this.#lag.visible = false;
    this.#lag.frustumCulled = false;
    stage.scene.add(this.#lag);
    this.controls.addEventListener('change', () => stage.ask());
    this.controls.addEventListener('objectChange', () => this.#moved());
    this.controls.addEventListener('dragging-changed', ({ value }) => {
      this.dragging = value === true;
      camera.controls.enabled = !this.dragging;
      if (!this.dragging) this.follow();
    });
  }

  /** @param {Part | null} part held by this user @param {'translate' | 'rotate'} mode */
  attach(part, mode) {
    this.controls.setMode(mode);
    if (part === this.part) return;
    this.part = part;
    // In the scene only while there is a part to move: it works out all its handles in each picture.
    if (part) {
      this.controls.attach(this.#standIn);
      this.stage.scene.add(this.controls.getHelper());
    } else {
      this.controls.detach();
      this.stage.scene.remove(this.controls.getHelper());
    }
    this.dragging = false;
    this.follow();
  }

  /** Is a handle under the pointer? */
  get grips() {
    return this.controls.axis !== null && this.part !== null;
  }

  /** The part came to where the session has it; unless it is in hand, the handles go along. */
  follow() {
    if (!this.part) {
      this.#lag.visible = false;
      return;
    }
    const at = placed(this.part, this.part.reference);
    if (this.dragging) {
      this.#showLag(at);
      return;
    }
    this.#lag.visible = false;
    this.#standIn.position.set(...at);
    this.#standIn.quaternion.set(0, 0, 0, 1);
    this.#remember();
    this.stage.ask();
  }

  #remember() {
    this.#lastAt = this.#standIn.position.toArray();
    this.#lastTurn = /** @type {Quat} */ (this.#standIn.quaternion.toArray());
  }

  /** @param {Vec3} at of the part's reference */
  #showLag(at) {
    this.#lag.geometry.setFromPoints([new THREE.Vector3(...at), this.#standIn.position]);
    this.#lag.computeLineDistances();
    this.#lag.visible = this.#standIn.position.distanceTo(new THREE.Vector3(...at)) > 0.5;
  }

  #moved() {
    if (!this.part || !this.dragging) return;
    const { position, quaternion } = this.#standIn;
    const turned = multiply(/** @type {Quat} */ (quaternion.toArray()), conjugate(this.#lastTurn));
    const increment = {
      t: /** @type {Vec3} */ (position.toArray().map((x, i) => x - this.#lastAt[i])),
      r: rotationVectorOf(turned),
    };
    this.#remember();
    if (!isNothing(increment)) this.push(this.part, increment);
  }
}
