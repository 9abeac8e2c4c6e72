// A 3D mouse by WebHID, where the browser has it: it moves the view, or the part in hand while a tool of the hand is chosen, by the same mover as keys.
import * as THREE from 'three';
import { SPACE_MICE, SpaceMouse } from '../session/space_mouse.js';
import { byId } from './dom.js';

/** @typedef {import('../session/motion.js').Vec3} Vec3 */
/** @typedef {EventTarget & {vendorId: number, productName: string, opened: boolean, open: () => Promise<void>}} Device as WebHID has it */
/** @typedef {EventTarget & {getDevices: () => Promise<Device[]>, requestDevice: (what: object) => Promise<Device[]>}} Hid */

/** At the stop: views a second, rad a second. */
const EYE = { shift: 1, turn: 1.5 };
/** The same for a part, and no faster than the session takes it, mm a second. */
const PART = { shift: 0.4, turn: 0.8, fastest: 240 };

/** @param {import('../desk.js').Desk} desk */
export function makeSpaceMouse({ choice, stage, camera, handles, mover, showAll, showPart, say }) {
  const hid = /** @type {Hid | undefined} */ (/** @type {any} */ (navigator).hid);
  const button = byId('connect_space_mouse');
  button.hidden = !hid;
  if (!hid) return;
  const mouse = new SpaceMouse();
  /** @type {Set<Device>} */
  const known = new Set();

  /** @param {Event} event */
  function take(event) {
    const { reportId, data } = /** @type {Event & {reportId: number, data: DataView}} */ (event);
    const pressed = mouse.take(reportId, data, performance.now());
    if (pressed & 1) showAll();
    if (pressed & 2) showPart(choice.part);
    stage.ask();
  }

  /** @param {Device} device */
  async function open(device) {
    if (known.has(device) || !SPACE_MICE.some(({ vendorId }) => vendorId === device.vendorId)) return;
    known.add(device);
    try {
      if (!device.opened) await device.open();
      device.addEventListener('inputreport', take);
      say(`${device.productName || '3D mouse'} is connected`, 'good');
    } catch (error) {
      known.delete(device);
      say(`${device.productName || '3D mouse'} does not open: ${error instanceof Error ? error.message : error}. Close what else uses it, and connect it again`, 'bad');
    }
  }

  /** @param {import('../session/session.js').Part} part @param {import('../session/motion.js').Increment} by */
  function movePart(part, { t, r }) {
    const turned = (/** @type {Vec3} */ v, /** @type {number} */ times) => /** @type {Vec3} */ (new THREE.Vector3(...v).multiplyScalar(times).applyQuaternion(stage.camera.quaternion).toArray());
    const view = stage.height * stage.pixelSize(new THREE.Vector3(...part.p));
    mover.push(part.id, { t: choice.tool === 'move' ? turned(t, Math.min(PART.shift * view, PART.fastest)) : [0, 0, 0], r: turned(r, PART.turn) });
  }

  stage.beforePicture(() => {
    const by = mouse.motion(performance.now());
    if (!by) return false;
    const times = (/** @type {Vec3} */ v, /** @type {number} */ x) => /** @type {Vec3} */ (v.map((y) => x * y));
    if (handles.part) movePart(handles.part, by);
    else camera.drive({ t: times(by.t, EYE.shift), r: times(by.r, EYE.turn) });
    return true;
  });

  button.onclick = async () => {
    const devices = await hid.requestDevice({ filters: SPACE_MICE });
    await Promise.all(devices.map(open));
  };
  hid.addEventListener('connect', (event) => open(/** @type {any} */ (event).device));
  hid.addEventListener('disconnect', (event) => {
    known.delete(/** @type {any} */ (event).device);
    mouse.rest();
  });
  hid.getDevices().then((devices) => devices.forEach(open), () => {}); // those that were allowed before
}
