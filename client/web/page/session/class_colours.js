// The colours of the classes: of words and marks on light and dark ground, and of heat from the lightest to the deepest of its zone. Reports
// and pictures have the same (client/picture/class_colours.h), and style.css repeats the first two; a test compares all three.

/** @type {Record<'fake' | 'potential' | 'real', {light: number, dark: number, heat: [number, number]}>} */
export const CLASS_COLOURS = {
  fake: { light: 0x1668b3, dark: 0x63b3f4, heat: [0xb5d8f5, 0x2b76b8] },
  potential: { light: 0xa86300, dark: 0xf5b942, heat: [0xf8dc6a, 0xe8842a] },
  real: { light: 0xc62828, dark: 0xff6b6b, heat: [0xe8575b, 0x8a0d2a] },
};

/** @param {number} colour */
export function hex(colour) {
  return `#${colour.toString(16).padStart(6, '0')}`;
}
