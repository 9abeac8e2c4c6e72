// Align: a feature of the held part, one of another part, and what they keep to each other. Picked in the view or from lists.
import * as THREE from 'three';
import { placed } from '../session/motion.js';
import { plain } from '../session/words.js';
import { featureAt } from '../view/feature_at.js';
import { byId, el, setText } from './dom.js';

/** @typedef {import('../session/session.js').Part} Part */
/** @typedef {import('../session/session.js').Feature} Feature */
/** @typedef {{part: Part, feature: Feature}} Picked */

const KINDS = /** @type {const} */ ([['coaxial', 'Coaxial'], ['coplanar', 'Coplanar'], ['parallel_distance', 'Parallel at'], ['tangent', 'Tangent']]);

/** @param {import('../desk.js').Desk} desk */
export function makeAlign({ session, choice, commands, labels, stage, say }) {
  const box = byId('align_bar');
  const own = el('select', { class: 'wide', 'aria-label': 'Feature of the part in your hand' });
  const otherPart = el('select', { class: 'wide', 'aria-label': 'Other part' });
  const other = el('select', { class: 'wide', 'aria-label': 'Feature of the other part' });
  const kind = el('select', { 'aria-label': 'Relation' }, ...KINDS.map(([value, text]) => el('option', { value }, text)));
  const distance = el('input', { type: 'text', inputMode: 'decimal', value: '0', size: 4, 'aria-label': 'Distance in mm' });
  const apply = el('button', { type: 'button', class: 'primary' }, 'Align');
  const snap = el('button', { type: 'button', title: 'Let the session find what fits nearby; what is chosen here is kept to' }, 'Snap');
  const drop = el('button', { type: 'button' }, 'Free');
  const hint = el('span', { class: 'quiet' });
  box.append(el('div', { class: 'row' }, own, kind, distance, otherPart, other, apply, snap, drop), hint);

  const held = () => {
    const chosen = session.parts.get(choice.part);
    return chosen && session.isMine(chosen) ? chosen : null;
  };
  const featuresOf = (/** @type {number} */ id) => session.features.get(id) ?? [];
  const constraintsOf = (/** @type {number} */ id) => session.standing.filter((d) => d.kind === 'add constraint' && d.constraint.part === id);
  const find = (/** @type {number} */ id, /** @type {string} */ name) => featuresOf(id).find((f) => f.name === name) ?? null;

  /** @param {HTMLSelectElement} list @param {Array<[string, string]>} options @param {string} first */
  function fill(list, options, first) {
    const before = list.value;
    list.replaceChildren(el('option', { value: '' }, first), ...options.map(([value, text]) => el('option', { value }, text)));
    list.value = options.some(([value]) => value === before) ? before : '';
  }

  function refresh() {
    box.hidden = choice.tool !== 'align';
    if (box.hidden) {
      stage.ask();
      return;
    }
    const part = held();
    const named = (/** @type {Feature[]} */ features) => features.map((f) => /** @type {[string, string]} */ ([f.name, `${plain(f.name)} (${f.kind})`]));
    fill(own, part ? named(featuresOf(part.id)) : [], 'own feature');
    fill(otherPart, [...session.parts.values()].filter((p) => p !== part).map((p) => [`${p.id}`, p.name]), 'other part');
    fill(other, named(featuresOf(Number(otherPart.value))), 'its feature');
    propose();
  }

  /** What fits between the two, unless somebody chose. */
  function propose() {
    const part = held();
    const a = part && find(part.id, own.value);
    const b = find(Number(otherPart.value), other.value);
    if (a && b) kind.value = a.kind === 'plane' && b.kind === 'plane' ? 'coplanar' : a.kind === 'plane' || b.kind === 'plane' ? 'parallel_distance' : 'coaxial';
    refreshState();
  }

  function refreshState() {
    const part = held();
    distance.hidden = kind.value !== 'parallel_distance';
    apply.disabled = !(part && own.value && otherPart.value && other.value);
    snap.disabled = !part;
    const kept = part ? constraintsOf(part.id) : [];
    drop.hidden = kept.length === 0;
    const state = kept.map((d) => `${plain(d.constraint.feature)} ${plain(d.constraint.kind)} with ${session.partName(d.constraint.other)} ${plain(d.constraint.other_feature)}`).join('; ');
    const next = !part ? 'Choose a part and grab it' : !own.value ? `Click a feature of ${part.name}, or let it snap` : !other.value ? 'Click a feature of another part, or let it snap' : 'Align, then move along what freedom is left';
    setText(hint, state ? `Kept: ${state}.` : `${next}.`);
    stage.ask();
  }

  apply.onclick = async () => {
    const part = held();
    if (!part) return;
    const keys = { kind: kind.value, part: part.id, feature: own.value, other: Number(otherPart.value), other_feature: other.value, snap: true };
    const away = Number(distance.value.replace(',', '.'));
    const reply = await commands.ask('constrain', kind.value === 'parallel_distance' ? { ...keys, distance: Number.isFinite(away) ? away : 0 } : keys);
    if (!reply.done) return;
    if (!reply.text) say('Aligned', 'good');
    other.value = own.value = '';
    refreshState();
  };
  snap.onclick = async () => {
    const part = held();
    if (!part) return;
    const chosen = { feature: own.value, other: Number(otherPart.value), other_feature: other.value };
    await commands.ask('snap', { part: part.id, ...Object.fromEntries(Object.entries(chosen).filter(([, value]) => value)) });
    refreshState();
  };
  drop.onclick = async () => {
    const part = held();
    for (const d of part ? constraintsOf(part.id) : []) await commands.ask('unconstrain', { part: d.constraint.part, constraint: d.constraint_id });
    refreshState();
  };

  /** @param {Part} part @param {THREE.Vector3} hit @returns {boolean} whether the click was for this tool */
  function pick(part, hit) {
    if (choice.tool !== 'align') return false;
    const feature = featureAt(part, featuresOf(part.id), hit);
    if (!feature) {
      say(`${part.name} has no known feature there`);
      return true;
    }
    if (part === held()) own.value = feature.name;
    else {
      otherPart.value = `${part.id}`;
      refresh();
      other.value = feature.name;
    }
    propose();
    return true;
  }

  /** @param {Picked} picked */
  const note = ({ part, feature }) => ({ at: new THREE.Vector3(...placed(part, feature.middle)), text: `${part.name}: ${plain(feature.name)}` });
  labels.sources.push(() => {
    if (choice.tool !== 'align') return [];
    const part = held();
    const target = session.parts.get(Number(otherPart.value));
    const picks = [part && { part, feature: find(part.id, own.value) }, target && { part: target, feature: find(target.id, other.value) }];
    return picks.flatMap((p) => (p && p.feature ? [note(/** @type {Picked} */ (p))] : []));
  });

  own.onchange = other.onchange = propose;
  kind.onchange = refreshState;
  otherPart.onchange = refresh;
  choice.on('tool', refresh);
  choice.on('part', refresh);
  for (const what of /** @type {const} */ (['scene', 'features', 'standing', 'holder'])) session.on(what, () => !box.hidden && refresh());
  return { pick };
}
