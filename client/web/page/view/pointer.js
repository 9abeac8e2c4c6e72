// The pointer on the picture: a click chooses a part, a mark or a feature; a drag is the camera's or the handles'.

const STILL_PIXELS = { mouse: 4, touch: 12 };

/** Has the pointer not gone from where it was pressed? @param {{x: number, y: number}} down @param {PointerEvent} event */
export function isStill(down, event) {
  return Math.hypot(event.clientX - down.x, event.clientY - down.y) < (event.pointerType === 'touch' ? STILL_PIXELS.touch : STILL_PIXELS.mouse);
}

/**
 * @param {import('../desk.js').Desk} desk
 * @param {(part: import('../session/session.js').Part, point: import('three').Vector3) => boolean} pickFeature
 */
export function makePointer({ session, choice, stage, partsView, marks, handles, showPart }, pickFeature) {
  const { canvas } = stage;
  let down = { x: 0, y: 0, grips: false };

  canvas.addEventListener('pointerdown', (event) => {
    down = { x: event.clientX, y: event.clientY, grips: handles.grips };
  }, { capture: true });
  canvas.addEventListener('pointerup', (event) => {
    if (!isStill(down, event) || down.grips || event.button !== 0) return;
    const clash = choice.tool === 'align' || choice.tool === 'measure' ? 0 : marks.hit(event);
    if (clash) {
      choice.chooseClash(clash);
      return;
    }
    const hit = partsView.hit(stage.rayAt(event));
    const part = hit ? (session.parts.get(hit.object.userData.part) ?? null) : null;
    if (part && hit && pickFeature(part, hit.point)) return;
    if (part && (event.ctrlKey || event.metaKey)) choice.gather(part.id);
    else if (choice.clash && !part) choice.chooseClash(0);
    else choice.choosePart(part?.id ?? 0);
  });
  canvas.addEventListener('dblclick', () => choice.part && showPart(choice.part));
}
