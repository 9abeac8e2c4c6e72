// In the tools that pick faces, the face under the pointer lights up and says its name before it is clicked.
import * as THREE from 'three';
import { placed } from '../session/motion.js';
import { facetsOf } from '../session/surfaces.js';
import { plain } from '../session/words.js';
import { featureAt } from './feature_at.js';

/** @typedef {import('../session/session.js').Feature} Feature */
/** @typedef {import('../session/session.js').Part} Part */
/** @typedef {{part: Part, feature: Feature} | null} Under */

const LOOK_MS = 40;
const MOST_KEPT = 100;

/** @param {import('../desk.js').Desk} desk */
export function makeFaceHover({ session, choice, stage, partsView, labels }) {
  const { canvas } = stage;
  const light = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial({ color: 0x6cb1f2, transparent: true, opacity: 0.55, depthWrite: false, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -2 }));
  Object.assign(light, { visible: false, matrixAutoUpdate: false, matrixWorldAutoUpdate: false, frustumCulled: false, renderOrder: 2 });
  stage.scene.add(light);
  /** Of facets, by mesh and face: they are looked for once. @type {Map<string, THREE.BufferGeometry>} */
  const kept = new Map();
  /** @type {Under} */
  let under = null;
  let looked = 0;

  const picks = () => choice.tool === 'align' || choice.tool === 'measure';

  /** @param {Part} part @param {Feature} feature */
  async function geometryOf(part, feature) {
    const key = `${part.mesh} ${feature.name}`;
    const known = kept.get(key);
    if (known) return known;
    const mesh = await partsView.meshOf(part);
    if (!mesh) return null;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(mesh.points, 3));
    geometry.setIndex(facetsOf(mesh, feature).flatMap((k) => [...mesh.triangles.subarray(k, k + 3)]));
    if (kept.size >= MOST_KEPT) {
      for (const old of kept.values()) old.dispose();
      kept.clear();
    }
    kept.set(key, geometry);
    return geometry;
  }

  /** @param {Under} now */
  async function show(now) {
    if (now?.part === under?.part && now?.feature === under?.feature) return;
    under = now;
    light.visible = false;
    stage.ask();
    if (!now) return;
    const geometry = await geometryOf(now.part, now.feature);
    const shown = partsView.shown.get(now.part.id);
    if (under !== now || !geometry || !shown) return;
    Object.assign(light, { geometry, matrixWorld: shown.faces.matrixWorld, visible: true });
    stage.ask();
  }

  canvas.addEventListener('pointermove', (event) => {
    if (event.timeStamp - looked < LOOK_MS || event.pointerType === 'touch') return;
    looked = event.timeStamp;
    if (!picks() || event.buttons !== 0) return void show(null);
    const hit = partsView.hit(stage.rayAt(event));
    const part = hit ? session.parts.get(hit.object.userData.part) : undefined;
    const feature = hit && part ? featureAt(part, session.features.get(part.id) ?? [], hit.point) : null;
    void show(part && feature ? { part, feature } : null);
  });
  canvas.addEventListener('pointerleave', () => void show(null));
  choice.on('tool', () => void show(null));
  session.on('scene', () => void show(null));
  labels.sources.push(() => (under ? [{ at: new THREE.Vector3(...placed(under.part, under.feature.middle)), text: `${under.part.name}: ${plain(under.feature.name)}` }] : []));
}
