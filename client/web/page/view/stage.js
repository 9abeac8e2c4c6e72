// The picture: renderer, light, and when it is drawn. World frame of the session, mm, z up.
import * as THREE from 'three';

/** Layers that are not cut by the section plane are told by their materials; what a pointer may hit by its own lists. */
export class Stage {
  /** @type {Array<(now: number) => boolean | void>} before a picture; true: and again after it */
  #before = [];
  #asked = false;
  /** Of the view, in pixels of the page; kept, since to ask for it may lay out the page. */
  width = 1;
  height = 1;

  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, powerPreference: 'high-performance' });
    this.renderer.localClippingEnabled = true;
    this.renderer.outputColorSpace = THREE.SRGBColorSpace;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(35, 1, 0.1, 10000);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(300, -400, 300);
    this.#light();
    new ResizeObserver(() => this.#resize()).observe(canvas);
    this.#resize();
  }

  /** Sky and ground, and two lamps that go with the eye: nothing that is looked at is ever black. */
  #light() {
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0xa9adb5, 1.55));
    const key = new THREE.DirectionalLight(0xffffff, 1.9);
    key.position.set(-0.5, 0.8, 0.9);
    const rim = new THREE.DirectionalLight(0xcfe0ff, 0.55);
    rim.position.set(0.9, -0.2, 0.3);
    for (const lamp of [key, rim]) this.camera.add(lamp, lamp.target);
    this.scene.add(this.camera);
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    Object.assign(this, { width, height });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.ask();
  }

  /** @param {(now: number) => boolean | void} what */
  beforePicture(what) {
    this.#before.push(what);
  }

  /** A picture is drawn when somebody asked for one: a still session costs nothing. */
  ask() {
    if (this.#asked) return;
    this.#asked = true;
    requestAnimationFrame((now) => this.#picture(now));
  }

  /** @param {number} now */
  #picture(now) {
    this.#asked = false;
    let again = false;
    for (const what of this.#before) again = what(now) === true || again;
    this.renderer.render(this.scene, this.camera);
    if (again) this.ask();
  }

  /** Pixels of the view, and whether the point is before the eye. @param {THREE.Vector3} point is overwritten */
  onScreen(point) {
    point.project(this.camera);
    return {
      x: ((point.x + 1) / 2) * this.width,
      y: ((1 - point.y) / 2) * this.height,
      seen: point.z < 1 && Math.abs(point.x) < 1.05 && Math.abs(point.y) < 1.05,
    };
  }

  /** How many mm one pixel is at this point. @param {THREE.Vector3} point */
  pixelSize(point) {
    const distance = this.camera.position.distanceTo(point);
    return (2 * distance * Math.tan(THREE.MathUtils.degToRad(this.camera.fov / 2))) / this.height;
  }

  /** @param {PointerEvent | MouseEvent} event @returns {THREE.Raycaster} */
  rayAt(event) {
    const box = this.canvas.getBoundingClientRect();
    const at = new THREE.Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const ray = new THREE.Raycaster();
    ray.setFromCamera(at, this.camera);
    return ray;
  }
}
