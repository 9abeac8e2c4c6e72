// Keeps the picture as the session and the choice have it.

/** @param {import('../desk.js').Desk} desk */
export function followSession({ session, choice, partsView, marks, handles, labels, showAll, flyToClash, cutAtClash, section, stage, mover }) {
  let framed = '';

  function looks() {
    const clash = session.clashes.get(choice.clash);
    const pair = clash && !clash.ended ? [clash.a, clash.b] : null;
    partsView.setLooks((part) => {
      if (pair) return pair.includes(part.id) ? 'plain' : 'ghost';
      if (choice.hidden.has(part.id)) return 'hidden';
      if (choice.together.includes(part.id)) return 'chosen';
      return choice.ghost && choice.part ? 'ghost' : 'plain';
    });
  }

  function showMarks() {
    const clash = session.clashes.get(choice.clash) ?? null;
    marks.show(session.openClashes(), clash && !clash.ended ? clash : null);
  }

  function hand() {
    const part = session.parts.get(choice.part) ?? null;
    const inHand = part !== null && session.isMine(part) && (choice.tool === 'move' || choice.tool === 'rotate');
    handles.attach(inHand ? part : null, choice.tool === 'rotate' ? 'rotate' : 'translate');
    stage.ask();
  }

  session.on('scene', async () => {
    if (!session.parts.has(choice.part)) choice.choosePart(0);
    if ([...choice.group].some((id) => !session.parts.has(id))) choice.ungather();
    if (!session.clashes.has(choice.clash)) choice.chooseClash(0);
    handles.attach(null, 'translate');
    await partsView.setParts(session.parts.values());
    looks();
    showMarks();
    hand();
    // A new session is framed; the same one again (after a lost line, in a replay) leaves the eye where it is.
    if (framed !== session.name && session.parts.size > 0) {
      framed = session.name;
      showAll('iso', true);
    }
    choice.framed();
  });
  session.on('poses', (parts) => {
    partsView.movePoses(parts);
    handles.follow();
    labels.refresh();
  });
  session.on('holder', (part) => {
    if (!session.isMine(part)) mover.drop(part.id);
    hand();
    labels.refresh();
  });
  session.on('me', hand);
  session.on('clashes', () => {
    looks();
    showMarks();
  });
  choice.on('part', () => {
    looks();
    hand();
  });
  choice.on('tool', hand);
  choice.on('ghost', looks);
  choice.on('group', looks);
  choice.on('hidden', looks);
  choice.on('clash', (clash) => {
    looks();
    showMarks();
    if (clash) flyToClash(clash);
    if (section.across !== 'clash') return;
    if (clash && section.on) cutAtClash(clash);
    else section.set(false);
  });
}
