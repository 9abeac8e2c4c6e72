// Measure: two faces or points are picked in the view; what is between them is said, with what the session knows of the same pair.
import * as THREE from 'three';
import { between, ofOne, realGapSaid } from '../session/measure.js';
import { placed, rotate } from '../session/motion.js';
import { bracket, plain, small } from '../session/words.js';
import { featureAt } from '../view/feature_at.js';
import { makeAskedGap } from './asked_gap.js';
import { byId, el, setText } from './dom.js';

/** @typedef {import('../session/session.js').Part} Part */
/** @typedef {import('../session/session.js').Feature} Feature */
/** @typedef {{part: Part, feature: Feature | null, point: import('../session/motion.js').Vec3}} Pick point in the frame of the part */

/** @param {import('../desk.js').Desk} desk */
export function makeMeasure(desk) {
  const { session, choice, labels, stage } = desk;
  const gap = makeAskedGap(desk, refresh);
  const box = byId('measure_bar');
  const text = el('span', { role: 'status' });
  const again = el('button', { type: 'button', onclick: clear }, 'Measure anew');
  box.append(el('div', { class: 'row' }, text, again));
  const line = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0xf0892e, depthTest: false, transparent: true }));
  line.renderOrder = 9;
  line.visible = false;
  line.frustumCulled = false;
  stage.scene.add(line);
  /** @type {Pick[]} */
  let picks = [];

  function clear() {
    picks = [];
    gap.drop();
    refresh();
  }

  /** As it stands now. @param {Pick} pick @returns {import('../session/measure.js').Picked} */
  function placedPick({ part, feature, point }) {
    if (!feature) return { kind: 'point', at: placed(part, point), axis: [0, 0, 1], radius: 0, inward: false };
    return { kind: /** @type {'plane'} */ (feature.kind), at: placed(part, feature.kind === 'sphere' ? feature.point : feature.middle), axis: rotate(part.q, feature.axis),
      radius: feature.kind === 'cylinder' || feature.kind === 'sphere' ? feature.radius : 0, inward: feature.inward };
  }

  /** On the axis, at the height of the middle of its facets. @param {Pick} pick */
  function onAxis(pick) {
    const known = placedPick(pick);
    const { part, feature } = pick;
    if (!feature || feature.kind === 'plane' || feature.kind === 'sphere') return known;
    const at = placed(part, feature.point);
    const s = known.at.reduce((sum, x, i) => sum + (x - at[i]) * known.axis[i], 0);
    return { ...known, at: /** @type {import('../session/motion.js').Vec3} */ (at.map((x, i) => x + s * known.axis[i])) };
  }

  const nameOf = (/** @type {Pick} */ { part, feature }) => `${part.name}${feature ? ` ${plain(feature.name)}` : ', a point'}`;
  const figure = (/** @type {import('../session/measure.js').Figure} */ { name, mm, rad }) => `${name} ${rad === undefined ? small(mm) : `${((rad * 180) / Math.PI).toFixed(4)}°`}`;

  /** Of the two parts as real bodies: what the session has judged of them, or how far they are apart. */
  function judged() {
    if (picks.length < 2) return '';
    const [a, b] = picks.map(({ part }) => part.id);
    const clash = session.openClashes().find((c) => (c.a === a && c.b === b) || (c.a === b && c.b === a));
    if (a === b) return '';
    if (!clash) return gap.between(picks[0].part, picks[1].part);
    return ` The session: overlap ${bracket(clash.delta)}, ${realGapSaid(clash)} (clash #${clash.clash}).`;
  }

  function refresh() {
    box.hidden = choice.tool !== 'measure';
    line.visible = false;
    stage.ask();
    if (box.hidden) return;
    again.hidden = picks.length === 0;
    if (picks.length === 0) setText(text, 'Click a face, or a point of a part');
    else if (picks.length === 1) setText(text, [nameOf(picks[0]), ...ofOne(onAxis(picks[0])).map(figure), 'click another face'].join(' · '));
    else {
      const { figures, from, to } = between(onAxis(picks[0]), onAxis(picks[1]));
      const exact = picks.every(({ feature }) => feature) ? 'of the nominal faces as the parts stand' : 'to a point of the mesh';
      setText(text, `${picks.map(nameOf).join(' → ')}: ${figures.map(figure).join(' · ')}, ${exact}.${judged()}`);
      line.geometry.setFromPoints([new THREE.Vector3(...from), new THREE.Vector3(...to)]);
      line.visible = true;
    }
  }

  /** @param {Part} part @param {THREE.Vector3} hit @returns {boolean} whether the click was for this tool */
  function pick(part, hit) {
    if (choice.tool !== 'measure') return false;
    const inverse = new THREE.Quaternion(...part.q).invert();
    const point = hit.clone().sub(new THREE.Vector3(...part.p)).applyQuaternion(inverse);
    if (picks.length === 2) picks = [];
    picks.push({ part, feature: featureAt(part, session.features.get(part.id) ?? [], hit), point: point.toArray() });
    refresh();
    return true;
  }

  labels.sources.push(() => (choice.tool === 'measure' ? picks.map((p, i) => ({ at: new THREE.Vector3(...placedPick(p).at), text: `${i + 1}` })) : []));
  choice.on('tool', clear);
  session.on('scene', clear);
  for (const what of /** @type {const} */ (['poses', 'standing'])) session.on(what, () => picks.length === 2 && refresh());
  return { pick };
}
