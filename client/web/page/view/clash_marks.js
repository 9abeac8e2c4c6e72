// Clashes in the picture: a mark at each open one, and at the chosen one its witness point, its normal and the motion that separates.
import * as THREE from 'three';
import { CLASS_COLOURS, hex } from '../session/class_colours.js';
import { displacement, hasWay } from '../session/way_out.js';
import { rankOf } from '../session/words.js';

/** @typedef {import('../session/session.js').Clash} Clash */

/** What can be left alone is drawn smaller. @type {Record<string, number>} */
const MARK_SIZES = { real: 1.2, potential: 1, fake: 0.8 };
const MARK_PIXELS = 22;
const ARROW_PIXELS = 74;
const NO_CLASS = '#888888';

/** Octagon, triangle, disc with a letter: the same shapes as in the lists. @param {string} name */
function drawMark(name) {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 64;
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  pen.beginPath();
  const corners = name === 'real' ? 8 : name === 'potential' ? 3 : 48;
  const turn = name === 'real' ? Math.PI / 8 : -Math.PI / 2;
  const middle = name === 'potential' ? 37 : 32;
  for (let i = 0; i < corners; ++i) {
    const angle = turn + (2 * Math.PI * i) / corners;
    pen.lineTo(32 + 27 * Math.cos(angle), middle + 27 * Math.sin(angle));
  }
  pen.closePath();
  pen.fillStyle = name in CLASS_COLOURS ? hex(CLASS_COLOURS[/** @type {keyof typeof CLASS_COLOURS} */ (name)].dark) : NO_CLASS;
  pen.lineWidth = 5;
  pen.strokeStyle = '#ffffff';
  pen.fill();
  pen.stroke();
  pen.fillStyle = '#101418';
  pen.font = `bold ${name === 'potential' ? 24 : 34}px system-ui, "DejaVu Sans", sans-serif`;
  pen.textAlign = 'center';
  pen.textBaseline = 'middle';
  pen.fillText(name[0].toUpperCase(), 32, middle + 2);
  const texture = new THREE.CanvasTexture(canvas);
  texture.colorSpace = THREE.SRGBColorSpace;
  return texture;
}

export class ClashMarks {
  /** @type {Map<string, THREE.SpriteMaterial>} */
  #materials = new Map();
  group = new THREE.Group();
  /** @type {Clash | null} */
  chosen = null;
  #focus = new THREE.Group();
  /** Where the names of the arrows stand. @type {Array<{at: THREE.Vector3, text: string}>} */
  notes = [];

  /** @param {import('./stage.js').Stage} stage */
  constructor(stage) {
    this.stage = stage;
    stage.scene.add(this.group, this.#focus);
    stage.beforePicture(() => this.#keepSizes());
  }

  /** @param {string} name */
  #material(name) {
    let material = this.#materials.get(name);
    if (!material) {
      material = new THREE.SpriteMaterial({ map: drawMark(name), depthTest: false, sizeAttenuation: false });
      this.#materials.set(name, material);
    }
    return material;
  }

  /** @param {Clash[]} clashes @param {Clash | null} chosen */
  show(clashes, chosen) {
    this.group.clear();
    this.chosen = chosen;
    for (const clash of clashes) {
      // Beside the chosen one the others would hide what it shows; the list has them.
      if (clash.class === 'none' || clash.ended || (chosen && clash.clash !== chosen.clash)) continue;
      const sprite = new THREE.Sprite(this.#material(clash.class));
      sprite.position.set(...clash.point);
      sprite.renderOrder = 10 + rankOf(clash.class);
      sprite.userData = { clash: clash.clash, size: MARK_SIZES[clash.class] ?? 1 };
      this.group.add(sprite);
    }
    this.#showFocus();
    this.stage.ask();
  }

  #showFocus() {
    this.#focus.clear();
    this.notes = [];
    const clash = this.chosen;
    if (!clash) return;
    this.#focus.position.set(...clash.point);
    this.#arrow(clash.normal, 0x8fd3ff, 'normal');
    if (hasWay(clash)) this.#arrow(displacement(clash.separation, clash.point), 0x4fd08a, 'separates');
    if (clash.witness) {
      const ball = new THREE.Mesh(new THREE.OctahedronGeometry(5), onTop(0xffffff));
      ball.userData.offset = new THREE.Vector3(...clash.witness).sub(this.#focus.position);
      this.#focus.add(ball);
    }
  }

  /** Of a fixed size on the screen: what it means may be micrometres. @param {number[]} along @param {number} colour @param {string} what */
  #arrow(along, colour, what) {
    const direction = new THREE.Vector3(...along);
    if (direction.lengthSq() === 0) return;
    const arrow = new THREE.Group();
    const shaft = new THREE.Mesh(new THREE.CylinderGeometry(1.5, 1.5, ARROW_PIXELS - 14, 10), onTop(colour));
    shaft.position.y = (ARROW_PIXELS - 14) / 2;
    const tip = new THREE.Mesh(new THREE.ConeGeometry(5.5, 16, 14), onTop(colour));
    tip.position.y = ARROW_PIXELS - 8;
    arrow.add(shaft, tip);
    arrow.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), direction.normalize());
    arrow.userData.what = what;
    this.#focus.add(arrow);
  }

  #keepSizes() {
    const { camera, height } = this.stage;
    const scale = (2 * Math.tan(THREE.MathUtils.degToRad(camera.fov / 2)) * MARK_PIXELS) / height;
    for (const sprite of this.group.children) {
      const chosen = sprite.userData.clash === this.chosen?.clash;
      sprite.scale.setScalar(scale * sprite.userData.size * (chosen ? 1.3 : 1));
    }
    const pixel = this.stage.pixelSize(this.#focus.position);
    this.notes = [];
    for (const child of this.#focus.children) {
      child.scale.setScalar(pixel);
      if (child.userData.offset) child.position.copy(child.userData.offset);
      else this.notes.push(this.#note(child, pixel));
    }
  }

  /** @param {THREE.Object3D} arrow @param {number} pixel */
  #note(arrow, pixel) {
    const at = new THREE.Vector3(0, ARROW_PIXELS * 1.16 * pixel, 0).applyQuaternion(arrow.quaternion).add(this.#focus.position);
    return { at, text: arrow.userData.what };
  }

  /** The mark under the pointer, if any. @param {MouseEvent} event @returns {number} clash, 0 none */
  hit(event) {
    const box = this.stage.canvas.getBoundingClientRect();
    let found = 0;
    let nearest = MARK_PIXELS * 0.6;
    for (const sprite of this.group.children) {
      const at = this.stage.onScreen(sprite.position.clone());
      const distance = Math.hypot(at.x - (event.clientX - box.left), at.y - (event.clientY - box.top));
      if (at.seen && distance < nearest) [found, nearest] = [sprite.userData.clash, distance];
    }
    return found;
  }
}

/** @param {number} color */
function onTop(color) {
  return new THREE.MeshBasicMaterial({ color, depthTest: false, transparent: true });
}
