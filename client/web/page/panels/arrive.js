// Who comes by a link stands where it leads: the clash is chosen, and one looks from where its sender did.
import { placeOf } from '../session/link.js';

/** @param {import('../desk.js').Desk} desk */
export function makeArrival({ session, choice, camera, send, say }) {
  /** @type {import('../session/link.js').Place | null} */
  let place = placeOf(location.hash);

  /** In a replay first to its time. @returns {boolean} whether that comes first */
  function goesToItsTime() {
    if (session.mode !== 'replay' || !place?.tick || !session.timeline) return false;
    const { tick } = place;
    place.tick = 0;
    return tick !== session.tick && send({ type: 'replay', do: 'seek', tick });
  }

  function arrive() {
    if (!place || goesToItsTime()) return;
    const { clash, eye, at, session: wanted } = place;
    place = null;
    if (wanted !== session.name) {
      say(`The link leads into the session “${wanted}”, and this is “${session.name}”`, 'bad');
      return;
    }
    if (clash && session.clashes.has(clash)) choice.chooseClash(clash);
    else if (clash) say(`Clash ${clash} is not open any more: its log tells it (mortise replay explain LOG ${clash})`, 'bad');
    if (eye && at) camera.stand(eye, at);
  }

  choice.on('framed', arrive);
  addEventListener('hashchange', () => {
    place = placeOf(location.hash);
    arrive();
  });
}
