// What comes in bytes: pose frames and meshes (../../protocol.md). Nothing is trusted: a frame that is not what it says is null.

const POSE_MAGIC = 0x3146504d; // "MPF1"
const MESH_MAGIC = 0x3148534d; // "MSH1"
const HEADER_BYTES = 16;
const RECORD_BYTES = 64;
const LITTLE_ENDIAN = new Uint8Array(new Uint32Array([1]).buffer)[0] === 1;

/**
 * A frame of poses, read in place. Record k: part(k), holder(k), classes(k), and the pose by its own arrays.
 * @typedef {object} PoseFrame
 * @property {number} count
 * @property {number} tick
 * @property {Uint32Array} words 16 a record: part, holder, …, classes at 12
 * @property {Float64Array} doubles 8 a record: x, y, z at 1, mm
 * @property {Float32Array} floats 16 a record: qx, qy, qz, qw at 8
 */

/** @param {ArrayBuffer} buffer @returns {PoseFrame | null} */
export function readPoseFrame(buffer) {
  if (!LITTLE_ENDIAN || buffer.byteLength < HEADER_BYTES) return null;
  const header = new DataView(buffer);
  if (header.getUint32(0, true) !== POSE_MAGIC) return null;
  const count = header.getUint32(4, true);
  const tick = header.getFloat64(8, true);
  if (!Number.isFinite(tick) || buffer.byteLength !== HEADER_BYTES + count * RECORD_BYTES) return null;
  return {
    count,
    tick,
    words: new Uint32Array(buffer, HEADER_BYTES),
    doubles: new Float64Array(buffer, HEADER_BYTES),
    floats: new Float32Array(buffer, HEADER_BYTES),
  };
}

/**
 * @typedef {object} Mesh
 * @property {Float32Array} points x, y, z in the frame of the part, mm
 * @property {Uint32Array} triangles corners, counter-clockwise seen from outside
 */

/** @param {ArrayBuffer} buffer @returns {Mesh | null} */
export function readMesh(buffer) {
  if (!LITTLE_ENDIAN || buffer.byteLength < HEADER_BYTES) return null;
  const header = new DataView(buffer);
  if (header.getUint32(0, true) !== MESH_MAGIC) return null;
  const points = header.getUint32(4, true);
  const triangles = header.getUint32(8, true);
  if (buffer.byteLength !== HEADER_BYTES + (points + triangles) * 12) return null;
  const mesh = {
    points: new Float32Array(buffer, HEADER_BYTES, points * 3),
    triangles: new Uint32Array(buffer, HEADER_BYTES + points * 12, triangles * 3),
  };
  for (const corner of mesh.triangles) {
    if (corner >= points) return null;
  }
  return mesh;
}
