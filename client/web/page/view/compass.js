// The axes of the world and a cube of its sides, as the eye stands; a click on a side looks from there.
import * as THREE from 'three';

const AXES = /** @type {const} */ ([
  ['X', [1, 0, 0], '#e5635f'],
  ['Y', [0, 1, 0], '#4caf6e'],
  ['Z', [0, 0, 1], '#4b93e0'],
]);
/** Side of the camera, its outward normal, and what is up on it. */
const SIDES = /** @type {const} */ ([
  ['right', [1, 0, 0], [0, 0, 1]], ['left', [-1, 0, 0], [0, 0, 1]], ['front', [0, -1, 0], [0, 0, 1]],
  ['back', [0, 1, 0], [0, 0, 1]], ['top', [0, 0, 1], [0, 1, 0]], ['bottom', [0, 0, -1], [0, -1, 0]],
]);
const SIZE = 144;
const HALF = 30;
const AXIS = 60;

/** @param {import('./stage.js').Stage} stage @param {HTMLCanvasElement} canvas @param {(side: string) => void} lookFrom */
export function drawCompass(stage, canvas, lookFrom) {
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  let last = '';
  /** Sides that are seen, where they are drawn. @type {Array<{side: string, path: Path2D}>} */
  let seen = [];

  /** @param {THREE.Quaternion} view */
  function drawAxes(view) {
    pen.lineWidth = 4;
    pen.font = 'bold 20px system-ui, "DejaVu Sans", sans-serif';
    pen.textAlign = 'center';
    pen.textBaseline = 'middle';
    const from = new THREE.Vector3(-HALF, -HALF, -HALF).applyQuaternion(view);
    const ends = AXES.map(([name, axis, colour]) => ({ name, colour, at: new THREE.Vector3(...axis).multiplyScalar(HALF + AXIS).applyQuaternion(view).add(from) }));
    for (const { name, colour, at } of ends) {
      pen.strokeStyle = pen.fillStyle = colour;
      pen.beginPath();
      pen.moveTo(SIZE / 2 + from.x, SIZE / 2 - from.y);
      pen.lineTo(SIZE / 2 + at.x * 0.86, SIZE / 2 - at.y * 0.86);
      pen.stroke();
      pen.fillText(name, Math.min(SIZE - 10, Math.max(10, SIZE / 2 + at.x)), Math.min(SIZE - 12, Math.max(12, SIZE / 2 - at.y)));
    }
  }

  /** @param {THREE.Quaternion} view */
  function drawSides(view) {
    const look = getComputedStyle(document.documentElement);
    seen = [];
    for (const [side, normal, up] of SIDES) {
      const n = new THREE.Vector3(...normal).applyQuaternion(view);
      if (n.z <= 0.02) continue;
      const v = new THREE.Vector3(...up).applyQuaternion(view);
      const u = v.clone().cross(n);
      const path = new Path2D();
      for (const [i, [x, y]] of [[-1, -1], [1, -1], [1, 1], [-1, 1]].entries()) {
        const at = n.clone().addScaledVector(u, x).addScaledVector(v, y).multiplyScalar(HALF);
        if (i === 0) path.moveTo(SIZE / 2 + at.x, SIZE / 2 - at.y);
        else path.lineTo(SIZE / 2 + at.x, SIZE / 2 - at.y);
      }
      path.closePath();
      pen.fillStyle = look.getPropertyValue('--panel').trim();
      pen.strokeStyle = look.getPropertyValue('--line').trim();
      pen.lineWidth = 2;
      pen.fill(path);
      pen.stroke(path);
      // The word lies on its side.
      pen.save();
      pen.setTransform(u.x, -u.y, -v.x, v.y, SIZE / 2 + n.x * HALF, SIZE / 2 - n.y * HALF);
      pen.fillStyle = look.getPropertyValue('--text').trim();
      pen.font = '600 17px system-ui, "DejaVu Sans", sans-serif';
      pen.textAlign = 'center';
      pen.textBaseline = 'middle';
      pen.fillText(side, 0, 0);
      pen.restore();
      seen.push({ side, path });
    }
  }

  stage.beforePicture(() => {
    const view = stage.camera.quaternion.clone().invert();
    const key = `${document.documentElement.dataset.theme} ${view.toArray().map((x) => x.toFixed(3))}`;
    if (key === last) return;
    last = key;
    pen.clearRect(0, 0, SIZE, SIZE);
    drawAxes(view);
    drawSides(view);
  });
  canvas.addEventListener('click', (event) => {
    const box = canvas.getBoundingClientRect();
    const [x, y] = [((event.clientX - box.left) / box.width) * SIZE, ((event.clientY - box.top) / box.height) * SIZE];
    const hit = seen.find(({ path }) => pen.isPointInPath(path, x, y));
    if (hit) lookFrom(hit.side);
  });
}
