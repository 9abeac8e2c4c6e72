// Solids whose distances are known in closed form, as the page has meshes.

/** @param {number[]} points @param {number[]} triangles */
const mesh = (points, triangles) => ({ points: new Float32Array(points), triangles: new Uint32Array(triangles) });

/** A prism of many sides about z: side facets first, two each, then the fans of both ends. @param {number} sides @param {number} radius @param {number} height */
export function prism(sides, radius, height) {
  const points = [0, 0, 0, 0, 0, height];
  const around = [];
  const ends = [];
  for (let i = 0; i < sides; ++i) {
    const angle = (2 * Math.PI * i) / sides;
    for (const z of [0, height]) points.push(radius * Math.cos(angle), radius * Math.sin(angle), z);
    const [a, b] = [2 + 2 * i, 2 + 2 * ((i + 1) % sides)];
    around.push(a, b, b + 1, a, b + 1, a + 1);
    ends.push(0, b, a, 1, a + 1, b + 1);
  }
  return { mesh: mesh(points, [...around, ...ends]), around: around.length };
}

/** A box about the origin, edges as long as `size`. @param {[number, number, number]} size */
export function box(size) {
  const points = [];
  for (let k = 0; k < 8; ++k) for (let axis = 0; axis < 3; ++axis) points.push(((k >> axis) & 1 ? 0.5 : -0.5) * size[axis]);
  const quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  return mesh(points, quads.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]));
}

/** Negative inside. @param {[number, number, number]} size @param {number[]} x */
export function boxDistance(size, x) {
  const out = x.map((value, axis) => Math.abs(value) - size[axis] / 2);
  const beyond = Math.hypot(...out.map((value) => Math.max(0, value)));
  return beyond > 0 ? beyond : Math.max(...out);
}

/** Numbers in [0, 1) from a literal seed. @param {number} seed */
export function numbers(seed) {
  let state = seed;
  return () => ((state = (state * 1664525 + 1013904223) % 4294967296) / 4294967296);
}
