// Where there is no room for both sides: which of them stands beside the view, or below it.
import { byId, setPressed } from './dom.js';

const PLACES = /** @type {const} */ (['left', 'right', 'none']);

/** @param {import('../desk.js').Desk} desk */
export function makePlaces({ choice }) {
  const desk = byId('desk');
  const show = (/** @type {string} */ side) => {
    desk.dataset.side = side;
    for (const place of PLACES) setPressed(byId(`place_${place}`), place === side);
  };
  for (const place of PLACES) byId(`place_${place}`).onclick = () => show(place);
  // A clash that was chosen in the view, or by its link, is read on the right.
  choice.on('clash', (clash) => clash && desk.dataset.side === 'left' && show('right'));
}
