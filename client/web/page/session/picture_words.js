// What is said of a clash's picture: its verdict to who does not see it, and whether the clash is still as it was drawn.
import { bracket } from './words.js';

/** @typedef {import('./session.js').Clash} Clash */

/** @param {Clash} clash @param {(part: number) => string} nameOf */
export function pictureSaid(clash, nameOf) {
  const what = clash.ended ? `ended, at worst ${clash.worst_class}` : clash.class;
  const overlap = bracket(clash.ended ? clash.worst_delta : clash.delta);
  return `${what}: ${nameOf(clash.a)} × ${nameOf(clash.b)}, overlap ${overlap}. ${clash.explanation}`;
}

/** @param {Clash} drawn @param {Clash} now */
export function pictureAge(drawn, now) {
  const same = drawn.class === now.class && drawn.ended === now.ended && drawn.delta.every((x, i) => x === now.delta[i]) && drawn.point.every((x, i) => x === now.point[i]);
  return same ? 'The verdict as the log has it; press it to enlarge' : 'The clash has changed since: ask for the picture again';
}
