// What is seen, as a picture to be kept: the view with its ground and the words that lie on it.

/** @param {import('./stage.js').Stage} stage @param {HTMLElement} labels @returns {Promise<Blob>} */
export async function pictureOf(stage, labels) {
  const { canvas, renderer, scene, camera, width } = stage;
  const drawn = document.createElement('canvas');
  drawn.width = canvas.width;
  drawn.height = canvas.height;
  const pen = /** @type {CanvasRenderingContext2D} */ (drawn.getContext('2d'));
  const look = getComputedStyle(document.documentElement);
  const ground = pen.createLinearGradient(0, 0, 0, drawn.height);
  ground.addColorStop(0, look.getPropertyValue('--view-top').trim());
  ground.addColorStop(1, look.getPropertyValue('--view-bottom').trim());
  pen.fillStyle = ground;
  pen.fillRect(0, 0, drawn.width, drawn.height);
  renderer.render(scene, camera); // what was drawn before is not kept
  pen.drawImage(canvas, 0, 0);
  const scale = canvas.width / width;
  const frame = canvas.getBoundingClientRect();
  pen.font = `${12 * scale}px system-ui, "DejaVu Sans", sans-serif`;
  pen.textBaseline = 'middle';
  for (const word of /** @type {Iterable<HTMLElement>} */ (labels.children)) {
    if (word.hidden) continue;
    const box = word.getBoundingClientRect();
    const [x, y] = [(box.left - frame.left) * scale, (box.top - frame.top) * scale];
    pen.fillStyle = look.getPropertyValue('--panel').trim();
    pen.fillRect(x, y, box.width * scale, box.height * scale);
    pen.fillStyle = look.getPropertyValue('--text').trim();
    pen.fillText(word.textContent ?? '', x + 7 * scale, y + (box.height * scale) / 2);
  }
  return new Promise((done, fail) => drawn.toBlob((blob) => (blob ? done(blob) : fail(new Error('the picture cannot be made'))), 'image/png'));
}
