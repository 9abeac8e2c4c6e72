// Clashes in groups: by the pair, by what the two faces are to each other, by the sub-assemblies of the two parts.

/** @typedef {import('./session.js').Clash} Clash */
/** @typedef {(id: number) => string} NameOf of a part */

export const GROUPINGS = /** @type {const} */ ([['', 'No groups'], ['pair', 'By pair'], ['relation', 'By relation'], ['assembly', 'By sub-assembly']]);

/** Parts of a pattern have numbers: what stands before is what they are. @param {string} name */
const kindOf = (name) => name.replace(/([_.-]?\d+)+$/, '').replaceAll('_', ' ');

/** The path of a part in its tree, without the part. @param {string} name */
const assemblyOf = (name) => (name.includes('/') ? name.slice(0, name.lastIndexOf('/')) : '');

/** @param {[string, string]} both */
const unordered = ([a, b]) => (a === b ? a : [a, b].sort((x, y) => x.localeCompare(y, 'en', { numeric: true })).join(' × '));

/** @param {Clash} clash @param {string} by of GROUPINGS @param {NameOf} nameOf @returns {string} */
export function groupOf(clash, by, nameOf) {
  const names = /** @type {[string, string]} */ ([nameOf(clash.a), nameOf(clash.b)]);
  if (by === 'pair') return names.join(' × ');
  if (by === 'relation') {
    const faces = /** @type {[string, string]} */ (clash.faces.map((face, i) => (face ? kindOf(face) : `${clash.shapes?.[i] ?? 'unnamed'} face`)));
    return unordered(faces);
  }
  const [a, b] = names.map(assemblyOf);
  if (a === b) return a || 'In no sub-assembly';
  return unordered([a || 'no sub-assembly', b || 'no sub-assembly']);
}

/**
 * In groups, each where its first one stands.
 * @param {Clash[]} sorted @param {string} by @param {NameOf} nameOf
 * @returns {Array<{name: string, clashes: Clash[]}>} one without a name where they are not grouped
 */
export function inGroups(sorted, by, nameOf) {
  if (!by) return [{ name: '', clashes: sorted }];
  /** @type {Map<string, Clash[]>} */
  const groups = new Map();
  for (const clash of sorted) {
    const name = groupOf(clash, by, nameOf);
    const known = groups.get(name);
    if (known) known.push(clash);
    else groups.set(name, [clash]);
  }
  return [...groups].map(([name, clashes]) => ({ name, clashes }));
}
