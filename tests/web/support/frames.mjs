// What a gateway says in bytes, written by the text of client/web/protocol.md and not by the page's reader.

/** @param {number} tick @param {Array<{part: number, holder: number, p: number[], q: number[], classes: number}>} poses */
export function poseFrame(tick, poses) {
  const buffer = new ArrayBuffer(16 + 64 * poses.length);
  const view = new DataView(buffer);
  'MPF1'.split('').forEach((c, i) => view.setUint8(i, c.charCodeAt(0)));
  view.setUint32(4, poses.length, true);
  view.setFloat64(8, tick, true);
  poses.forEach(({ part, holder, p, q, classes }, k) => {
    const at = 16 + 64 * k;
    view.setUint32(at, part, true);
    view.setUint32(at + 4, holder, true);
    p.forEach((x, i) => view.setFloat64(at + 8 + 8 * i, x, true));
    q.forEach((x, i) => view.setFloat32(at + 32 + 4 * i, x, true));
    view.setUint32(at + 48, classes, true);
  });
  return buffer;
}

/** @param {number[]} points @param {number[]} triangles */
export function meshBytes(points, triangles) {
  const buffer = new ArrayBuffer(16 + 4 * (points.length + triangles.length));
  const view = new DataView(buffer);
  'MSH1'.split('').forEach((c, i) => view.setUint8(i, c.charCodeAt(0)));
  view.setUint32(4, points.length / 3, true);
  view.setUint32(8, triangles.length / 3, true);
  points.forEach((x, i) => view.setFloat32(16 + 4 * i, x, true));
  triangles.forEach((x, i) => view.setUint32(16 + 4 * (points.length + i), x, true));
  return buffer;
}
