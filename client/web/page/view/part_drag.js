// A part is dragged by itself, in the plane of the view through the point where it was taken: one in hand, or a free one, which is asked for
// as soon as the pointer goes and follows once it is granted. What its constraints do not leave, the session takes away. One in the hand of
// somebody else stays, and the page says in whose.
import * as THREE from 'three';
import { isStill } from './pointer.js';

/** @param {import('../desk.js').Desk} desk */
export function makePartDrag({ session, choice, stage, partsView, camera, handles, mover, commands, say }) {
  const { canvas } = stage;
  const plane = new THREE.Plane();
  const last = new THREE.Vector3();
  const now = new THREE.Vector3();
  const begin = { x: 0, y: 0 };
  let part = 0;
  /** Is asked for; what the hand wants of it meanwhile, mm. @type {{part: number, by: THREE.Vector3} | null} */
  let asked = null;

  canvas.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || event.ctrlKey || event.metaKey || choice.tool !== 'move' || handles.grips || part) return;
    const hit = partsView.hit(stage.rayAt(event));
    const taken = hit ? session.parts.get(hit.object.userData.part) : undefined;
    if (!hit || !taken?.moving || !session.mayAct) return;
    part = taken.id;
    Object.assign(begin, { x: event.clientX, y: event.clientY });
    plane.setFromNormalAndCoplanarPoint(stage.camera.getWorldDirection(new THREE.Vector3()), hit.point);
    last.copy(hit.point);
    camera.controls.enabled = false;
    canvas.setPointerCapture(event.pointerId);
  }, { capture: true });
  canvas.addEventListener('pointermove', (event) => {
    const taken = session.parts.get(part);
    if (!taken || !stage.rayAt(event).ray.intersectPlane(plane, now)) return;
    const mine = session.isMine(taken);
    if (!mine && asked?.part !== part) {
      if (isStill(begin, event)) return; // a click chooses it and asks for nothing
      if (taken.holder) return refuse(taken);
      ask(part);
    }
    const by = now.clone().sub(last);
    if (mine) mover.push(part, { t: by.toArray(), r: [0, 0, 0] });
    else asked?.by.add(by);
    last.copy(now);
  });

  /** With the parts that it is gathered with. @param {number} id */
  async function ask(id) {
    const mine = { part: id, by: new THREE.Vector3() };
    asked = mine;
    if (!choice.together.includes(id)) choice.choosePart(id);
    const parts = choice.together;
    const reply = await commands.ask('grab', parts.length > 1 ? { parts } : { part: id });
    if (reply.done || asked !== mine) return;
    asked = null;
    if (part === id) end();
  }

  session.on('holder', (taken) => {
    if (asked?.part !== taken.id) return;
    const { by } = asked;
    asked = null;
    if (session.isMine(taken)) mover.push(taken.id, { t: by.toArray(), r: [0, 0, 0] });
  });

  /** @param {import('../session/session.js').Part} taken */
  function refuse(taken) {
    end();
    choice.choosePart(taken.id);
    say(`${taken.name} is held by ${session.userName(taken.holder)}: ask for it in the bar below`, 'bad');
  }

  function end() {
    if (!part) return;
    part = 0;
    camera.controls.enabled = true;
  }
  for (const name of ['pointerup', 'pointercancel', 'lostpointercapture']) canvas.addEventListener(name, end);
}
