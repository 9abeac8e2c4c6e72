// The axes of the world, as the eye stands.
import * as THREE from 'three';

const AXES = /** @type {const} */ ([
  ['X', [1, 0, 0], '#e5635f'],
  ['Y', [0, 1, 0], '#4caf6e'],
  ['Z', [0, 0, 1], '#4b93e0'],
]);

/** @param {import('./stage.js').Stage} stage @param {HTMLCanvasElement} canvas */
export function drawCompass(stage, canvas) {
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  let last = '';
  stage.beforePicture(() => {
    const view = stage.camera.quaternion.clone().invert();
    const key = view.toArray().map((x) => x.toFixed(3)).join();
    if (key === last) return;
    last = key;
    pen.clearRect(0, 0, 144, 144);
    const ends = AXES.map(([name, axis, colour]) => ({ name, colour, at: new THREE.Vector3(...axis).applyQuaternion(view) }));
    ends.sort((a, b) => a.at.z - b.at.z);
    pen.lineWidth = 5;
    pen.font = 'bold 22px system-ui, "DejaVu Sans", sans-serif';
    pen.textAlign = 'center';
    pen.textBaseline = 'middle';
    for (const { name, colour, at } of ends) {
      pen.strokeStyle = pen.fillStyle = colour;
      pen.beginPath();
      pen.moveTo(72, 72);
      pen.lineTo(72 + 40 * at.x, 72 - 40 * at.y);
      pen.stroke();
      pen.fillText(name, 72 + 56 * at.x, 72 - 56 * at.y);
    }
  });
}
