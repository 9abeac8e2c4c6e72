// A part in hand is dragged by itself, in the plane of the view through the point where it was taken. What its constraints do not leave, the session takes away.
import * as THREE from 'three';

/** @param {import('../desk.js').Desk} desk */
export function makePartDrag({ session, choice, stage, partsView, camera, handles, mover }) {
  const { canvas } = stage;
  const plane = new THREE.Plane();
  const last = new THREE.Vector3();
  const now = new THREE.Vector3();
  let part = 0;

  canvas.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || event.ctrlKey || choice.tool !== 'move' || handles.grips || part) return;
    const hit = partsView.hit(stage.rayAt(event));
    const taken = hit ? session.parts.get(hit.object.userData.part) : undefined;
    if (!hit || !taken || !session.isMine(taken)) return;
    part = taken.id;
    plane.setFromNormalAndCoplanarPoint(stage.camera.getWorldDirection(new THREE.Vector3()), hit.point);
    last.copy(hit.point);
    camera.controls.enabled = false;
    canvas.setPointerCapture(event.pointerId);
  }, { capture: true });
  canvas.addEventListener('pointermove', (event) => {
    if (!part || !stage.rayAt(event).ray.intersectPlane(plane, now)) return;
    const taken = session.parts.get(part);
    if (!taken || !session.isMine(taken)) return end();
    mover.push(part, { t: now.clone().sub(last).toArray(), r: [0, 0, 0] });
    last.copy(now);
  });

  function end() {
    if (!part) return;
    part = 0;
    camera.controls.enabled = true;
  }
  for (const name of ['pointerup', 'pointercancel', 'lostpointercapture']) canvas.addEventListener(name, end);
}
