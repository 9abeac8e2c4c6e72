// Who is here, what they hold, and looking along with them.
import { personColour } from '../view/looks.js';
import { byId, el, keepRows, seldom, setPressed, setText } from './dom.js';
import { icon } from './icons.js';

/** @param {import('../desk.js').Desk} desk */
export function makePeople({ session, choice, camera, say }) {
  const list = byId('people');

  function make(/** @type {import('../session/session.js').User} */ user) {
    const swatch = el('span', { class: 'swatch person' });
    swatch.style.backgroundColor = personColour(user.id);
    const follow = el('button', { class: 'small', type: 'button', onclick: () => choice.follow(choice.following === user.id ? 0 : user.id) }, icon('follow'));
    return el('li', {}, swatch, el('span', { class: 'grow' }), el('span', { class: 'quiet' }), follow);
  }

  function fill(/** @type {HTMLElement} */ row, /** @type {import('../session/session.js').User} */ user) {
    const [, name, what, follow] = /** @type {HTMLElement[]} */ ([...row.children]);
    const mine = user.id === session.me;
    setText(name, mine ? `${user.name} (you)` : user.name);
    name.title = user.name;
    const held = [...session.parts.values()].filter((part) => part.holder === user.id);
    setText(what, held.length > 1 ? `holds ${held.length}` : held.length === 1 ? 'holds 1' : user.role === 'designer' ? '' : user.role);
    what.title = held.map((part) => part.name).join(', ');
    const can = !mine && session.views.has(user.id);
    follow.hidden = !can;
    setPressed(follow, choice.following === user.id);
    const label = choice.following === user.id ? `Stop looking along with ${user.name}` : `Look along with ${user.name}`;
    follow.title = label;
    follow.setAttribute('aria-label', label);
  }

  function refresh() {
    const here = [...session.users.values()].filter((user) => user.present);
    here.sort((a, b) => Number(b.id === session.me) - Number(a.id === session.me) || a.id - b.id);
    keepRows(list, here, (user) => `${user.id}`, make, fill);
    setText(byId('people_count'), `${here.length}`);
  }

  const soon = seldom(refresh, 120);
  for (const what of /** @type {const} */ (['users', 'me', 'holder', 'scene'])) session.on(what, soon);
  // Who comes later has not heard where one looks from.
  session.on('me', () => session.me !== 0 && camera.tellSoon());
  session.on('users', () => session.me !== 0 && camera.tellSoon());
  session.on('views', (views) => {
    soon();
    const followed = views.find((view) => view.user === choice.following);
    if (followed) camera.follow(followed);
  });
  choice.on('following', (user) => {
    refresh();
    const view = session.views.get(user);
    if (view) camera.follow(view);
    if (user) say(`You look along with ${session.userName(user)}; turn the view to look by yourself`);
  });
  camera.onHand = () => choice.follow(0);
}
