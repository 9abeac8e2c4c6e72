// Where the section plane stands.
import { byId, el, setPressed, setText } from './dom.js';

/** @param {import('../view/section_plane.js').SectionPlane} section @param {() => void} changed */
export function makeSectionBar(section, changed) {
  const box = byId('section_bar');
  const across = el('select', { 'aria-label': 'Across' },
    ...[['x', 'Across X'], ['y', 'Across Y'], ['z', 'Across Z'], ['clash', 'At the clash']].map(([value, text]) => el('option', { value }, text)));
  const slider = el('input', { type: 'range', min: '0', max: '1', step: '0.001', 'aria-label': 'Position of the section plane' });
  const at = el('span', { class: 'quiet' });
  const flip = el('button', { type: 'button', 'aria-pressed': 'false' }, 'Other side');
  const off = el('button', { type: 'button', onclick: () => section.set(false) }, 'Off');
  box.append(el('div', { class: 'row' }, across, slider, at, flip, off));

  function show() {
    box.hidden = !section.on;
    setPressed(byId('view_section'), section.on);
    across.value = section.across;
    /** @type {HTMLOptionElement} */ (across.options[3]).disabled = section.across !== 'clash';
    slider.value = `${section.share}`;
    setPressed(flip, section.flipped);
    showAt();
    changed();
  }

  function showAt() {
    setText(at, `${section.offset.toFixed(2)} mm`);
    slider.setAttribute('aria-valuetext', `${section.offset.toFixed(2)} mm`);
  }

  section.onChange = show;
  across.onchange = () => {
    section.across = /** @type {import('../view/section_plane.js').Across} */ (across.value);
    section.centre();
    section.set(true);
  };
  slider.oninput = () => {
    section.share = Number(slider.value);
    section.place();
    showAt();
  };
  flip.onclick = () => {
    section.flipped = !section.flipped;
    section.set(true);
  };
}
