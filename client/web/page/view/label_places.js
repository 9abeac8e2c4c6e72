// Where a word of the picture has room: as near to its point as nothing else lies on it.

/** @typedef {{left: number, top: number, right: number, bottom: number}} Box pixels of the view */

const GAP = 2;

/** @param {Box} a @param {Box} b */
const meet = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

/**
 * @param {Box[]} covers bars and pictures, which lie over words @param {Box[]} words placed before @param {{x: number, y: number}} wanted middle
 * @param {{width: number, height: number}} size @param {{width: number, height: number}} view
 * @returns {Box} within the view; on words only where nothing else is free, and under a bar only where nothing is
 */
export function freePlace(covers, words, wanted, size, view) {
  const least = { x: size.width / 2, y: size.height / 2 };
  const most = { x: view.width - least.x, y: view.height - least.y };
  const x = Math.max(least.x, Math.min(most.x, wanted.x));
  const y = Math.max(least.y, Math.min(most.y, wanted.y));
  const boxAt = (/** @type {number} */ atX, /** @type {number} */ atY) => ({ left: atX - least.x, top: atY - least.y, right: atX + least.x, bottom: atY + least.y });

  /** @param {Box[]} taken @returns {Box | null} */
  function nearest(taken) {
    const isFree = (/** @type {Box} */ box) => !taken.some((other) => meet(box, other));
    const first = boxAt(x, y);
    if (isFree(first)) return first;
    const xs = [x, ...taken.flatMap((other) => [other.left - least.x - GAP, other.right + least.x + GAP])].filter((at) => at >= least.x && at <= most.x);
    const ys = [y, ...taken.flatMap((other) => [other.top - least.y - GAP, other.bottom + least.y + GAP])].filter((at) => at >= least.y && at <= most.y);
    let best = null;
    let shortest = Infinity;
    for (const atX of xs) {
      for (const atY of ys) {
        // Above rather than below: the part is there.
        const far = Math.abs(atX - x) + Math.abs(atY - y) * (atY > y ? 1.1 : 1);
        if (far >= shortest || !isFree(boxAt(atX, atY))) continue;
        [best, shortest] = [boxAt(atX, atY), far];
      }
    }
    return best;
  }

  return nearest([...covers, ...words]) ?? nearest(covers) ?? boxAt(x, y);
}
