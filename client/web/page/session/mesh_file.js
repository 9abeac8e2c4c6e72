// Files that somebody brings: which format, how large in the numbers of the file, and what those numbers may mean.

/** mm of one unit. */
export const UNITS = /** @type {const} */ ([['mm', 1], ['cm', 10], ['m', 1000], ['inch', 25.4]]);

/** Of formats that say it; else it must be asked for. @type {Record<string, number>} */
const STATED_MM = { glb: 1000, gltf: 1000, step: 1, stp: 1 };
const FORMATS = ['stl', 'obj', 'glb', 'step', 'stp'];
export const ACCEPTED = FORMATS.map((format) => `.${format}`).join(',');

/** @param {string} name of a file */
export function formatOf(name) {
  const ending = /\.([a-z0-9]+)$/i.exec(name)?.[1].toLowerCase() ?? '';
  return FORMATS.includes(ending) ? ending : '';
}

/** mm of a unit of the file; 0: nobody knows. @param {string} name */
export function statedUnit(name) {
  return STATED_MM[formatOf(name)] ?? 0;
}

/** A name for a part of this file that no other part has. @param {string} file @param {(name: string) => boolean} taken */
export function partNameOf(file, taken) {
  return freeName(file.replace(/\.[^.]*$/, '').replace(/[^A-Za-z0-9_-]+/g, '_').slice(0, 60) || 'part', taken);
}

/** @param {string} stem @param {(name: string) => boolean} taken */
export function freeName(stem, taken) {
  let name = stem;
  for (let i = 2; taken(name); ++i) name = `${stem}_${i}`;
  return name;
}

/**
 * Lengths along x, y, z in the numbers of the file; null where it is not understood here (the session reads it for itself).
 * @param {string} name @param {ArrayBuffer} bytes @returns {[number, number, number] | null}
 */
export function extentOf(name, bytes) {
  const format = formatOf(name);
  if (format === 'obj') return ofText(bytes, /^v\s+(\S+)\s+(\S+)\s+(\S+)/gm);
  if (format !== 'stl') return null;
  const view = new DataView(bytes);
  const count = bytes.byteLength >= 84 ? view.getUint32(80, true) : 0;
  if (bytes.byteLength !== 84 + 50 * count) return ofText(bytes, /^\s*vertex\s+(\S+)\s+(\S+)\s+(\S+)/gm);
  const span = new Span();
  for (let k = 0; k < count; ++k) {
    for (let corner = 0; corner < 3; ++corner) {
      const at = 84 + 50 * k + 12 + 12 * corner;
      span.add(view.getFloat32(at, true), view.getFloat32(at + 4, true), view.getFloat32(at + 8, true));
    }
  }
  return span.lengths();
}

class Span {
  low = [Infinity, Infinity, Infinity];
  high = [-Infinity, -Infinity, -Infinity];

  /** @param {...number} at */
  add(...at) {
    for (let i = 0; i < 3; ++i) {
      this.low[i] = Math.min(this.low[i], at[i]);
      this.high[i] = Math.max(this.high[i], at[i]);
    }
  }

  /** @returns {[number, number, number] | null} */
  lengths() {
    const lengths = this.high.map((high, i) => high - this.low[i]);
    return lengths.every(Number.isFinite) ? /** @type {[number, number, number]} */ (lengths) : null;
  }
}

/** @param {ArrayBuffer} bytes @param {RegExp} corner */
function ofText(bytes, corner) {
  const span = new Span();
  for (const [, x, y, z] of new TextDecoder().decode(bytes).matchAll(corner)) span.add(Number(x), Number(y), Number(z));
  return span.lengths();
}

/** @param {[number, number, number] | null} extent @param {number} unit mm */
export function extentSaid(extent, unit) {
  if (!extent) return 'of unknown size';
  return `${extent.map((length) => Number((length * unit).toPrecision(4))).join(' × ')} mm`;
}
