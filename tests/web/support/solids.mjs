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

/** That box as an OBJ. @param {[number, number, number]} size @param {[number, number, number]} at */
export function obj(size, at) {
  const { points, triangles } = box(size);
  const rows = (letter, /** @type {number[]} */ numbers) => Array.from({ length: numbers.length / 3 }, (_, i) => `${letter} ${numbers.slice(3 * i, 3 * i + 3).join(' ')}\n`).join('');
  return rows('v', [...points].map((x, i) => x + at[i % 3])) + rows('f', [...triangles].map((i) => i + 1));
}

/** That box as a GLB of one node, its numbers in metres. @param {[number, number, number]} size @param {[number, number, number]} at */
export function glb(size, at) {
  const { points, triangles } = box(size);
  const chunk = (/** @type {string} */ type, /** @type {Buffer} */ bytes, /** @type {string} */ filler) => {
    const data = Buffer.concat([bytes, Buffer.alloc(-bytes.length & 3, filler)]);
    const head = Buffer.alloc(8);
    head.writeUInt32LE(data.length, 0);
    head.write(type, 4);
    return Buffer.concat([head, data]);
  };
  const half = size.map((x) => x / 2);
  const scene = {
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0, translation: at }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: points.length / 3, type: 'VEC3', min: half.map((x) => -x), max: half },
      { bufferView: 1, componentType: 5125, count: triangles.length, type: 'SCALAR' },
    ],
    bufferViews: [{ buffer: 0, byteOffset: 0, byteLength: points.byteLength }, { buffer: 0, byteOffset: points.byteLength, byteLength: triangles.byteLength }],
    buffers: [{ byteLength: points.byteLength + triangles.byteLength }],
  };
  const chunks = [chunk('JSON', Buffer.from(JSON.stringify(scene)), ' '), chunk('BIN\0', Buffer.concat([Buffer.from(points.buffer), Buffer.from(triangles.buffer)]), '\0')];
  const head = Buffer.alloc(12);
  head.write('glTF');
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(chunks.reduce((sum, { length }) => sum + length, 12), 8);
  return Buffer.concat([head, ...chunks]);
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
