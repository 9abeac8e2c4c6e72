// Small drawings, made of paths of our own.

const NS = 'http://www.w3.org/2000/svg';

/** @type {Record<string, string>} on a field of 20 × 20 */
const PATHS = {
  select: 'M5 3l10 6.2-4.4 1 2.6 5-2 1-2.6-5L5 14.6z',
  move: 'M10 2v16M2 10h16M10 2L7.8 4.4M10 2l2.2 2.4M10 18l-2.2-2.4M10 18l2.2-2.4M2 10l2.4-2.2M2 10l2.4 2.2M18 10l-2.4-2.2M18 10l-2.4 2.2',
  rotate: 'M16 10a6 6 0 1 1-2-4.5M14.4 2.2V6h-3.8',
  align: 'M3 17h14M10 3v9M6.5 8.5L10 12l3.5-3.5M5 14.5h10',
  section: 'M4 4h12v12H4zM2 18L18 2M8.5 16L16 8.5M12 16l4-4',
  ghost: 'M10 3c3.6 0 6 2.6 6 6v8l-2-1.6-2 1.6-2-1.6L8 17l-2-1.6L4 17V9c0-3.4 2.4-6 6-6zM8 8.5v1M12 8.5v1',
  ground: 'M6 3h8v8H6zM2.5 15.5c0-1.3 3.4-2.3 7.5-2.3s7.5 1 7.5 2.3-3.4 2.3-7.5 2.3-7.5-1-7.5-2.3z',
  fit: 'M3 7V3h4M13 3h4v4M17 13v4h-4M7 17H3v-4M7.5 7.5h5v5h-5z',
  zoom: 'M8.5 3.5a5 5 0 1 0 0 10 5 5 0 0 0 0-10zM12.2 12.2L17 17',
  measure: 'M2.5 13.5l11-11 4 4-11 11zM6 10l1.6 1.6M8.6 7.4L11 9.8M11.4 4.6L13 6.2',
  picture: 'M3 6h3l1.5-2h5L14 6h3v10H3zM10 8.2a2.8 2.8 0 1 0 0 5.6 2.8 2.8 0 0 0 0-5.6z',
  page: 'M3 3.5h14v13H3zM3 13.5l4.5-4.5 3.5 3.5 2.5-2.5 3.5 3.5M12.6 6.8v.4',
  hide: 'M2.5 10S5 5.5 10 5.5s7.5 4.5 7.5 4.5-2.5 4.5-7.5 4.5S2.5 10 2.5 10zM4 16L16 4',
  isolate: 'M3 6V3h3M14 3h3v3M17 14v3h-3M6 17H3v-3M10 7a3 3 0 1 0 0 6 3 3 0 0 0 0-6z',
  undo: 'M7 4L3.5 7.5 7 11M3.5 7.5H12a4.5 4.5 0 0 1 0 9H7',
  redo: 'M13 4l3.5 3.5L13 11M16.5 7.5H8a4.5 4.5 0 0 0 0 9h5',
  reset: 'M10 4v4M4.2 8A6.2 6.2 0 1 1 4 12M4 4v4h4',
  grab: 'M6 10V5.5a1.2 1.2 0 0 1 2.4 0V9M8.4 9V4a1.2 1.2 0 0 1 2.4 0v5M10.8 9V4.8a1.2 1.2 0 0 1 2.4 0V10M13.2 10V7a1.2 1.2 0 0 1 2.4 0v5c0 3-1.8 5-4.8 5-2.4 0-3.4-1-4.6-3.2L4.4 10.6c-.6-1 .8-2 1.6-1.2z',
  theme: 'M10 4a6 6 0 1 0 0 12V4z',
  help: 'M7.5 7.5a2.5 2.5 0 1 1 3.6 2.2c-.8.4-1.1.9-1.1 1.8M10 14.2v.4',
  eye: 'M2.5 10S5 5 10 5s7.5 5 7.5 5-2.5 5-7.5 5-7.5-5-7.5-5zM10 7.8a2.2 2.2 0 1 0 0 4.4 2.2 2.2 0 0 0 0-4.4z',
  follow: 'M3 10s2-4.5 7-4.5 7 4.5 7 4.5-2 4.5-7 4.5S3 10 3 10zM10 8.4a1.6 1.6 0 1 0 0 3.2 1.6 1.6 0 0 0 0-3.2zM3 3v2M17 3v2M3 17v-2M17 17v-2',
  replace: 'M4 8.5V5h9M10.5 2.5L13 5l-2.5 2.5M16 11.5V15H7M9.5 17.5L7 15l2.5-2.5',
  remove: 'M4 6h12M8 6V4h4v2M5.5 6l.8 10.5h7.4L14.5 6M8.5 9v5M11.5 9v5',
  add: 'M10 4v12M4 10h12',
  more: 'M3 5h14M3 10h14M3 15h14',
  close: 'M5 5l10 10M15 5L5 15',
  link: 'M8 12l4-4M7 9L5 11a2.8 2.8 0 0 0 4 4l2-2M13 11l2-2a2.8 2.8 0 0 0-4-4L9 7',
  save: 'M4 4h9.5L16 6.5V16H4zM7 4v4h5.5V4M7 16v-5h6v5',
  download: 'M10 3v9M6.5 8.8L10 12.3l3.5-3.5M4 16.5h12',
  statistics: 'M4 16V9M8 16V5M12 16v-4M16 16V7',
  play: 'M6 4l10 6-10 6z',
  pause: 'M6 4v12M14 4v12',
};

/** @param {string} name @returns {SVGSVGElement} */
export function icon(name) {
  const svg = document.createElementNS(NS, 'svg');
  svg.setAttribute('viewBox', '0 0 20 20');
  svg.setAttribute('aria-hidden', 'true');
  svg.classList.add('icon');
  const path = document.createElementNS(NS, 'path');
  path.setAttribute('d', PATHS[name] ?? '');
  svg.append(path);
  return svg;
}

/** The shape of a class (octagon, triangle, circle), and its letter: drawn, so that it is no word beside what it stands at. @type {Record<string, [string, string]>} */
const MARKS = {
  real: ['M7 2h6l5 5v6l-5 5H7l-5-5V7z', 'M7.8 14.2V6.3h2.7a2.3 2.3 0 0 1 0 4.6H7.8M10.3 10.9l2.5 3.3'],
  potential: ['M10 1.5L19 18H1z', 'M8.6 16V9.4h2a1.9 1.9 0 0 1 0 3.8h-2'],
  fake: ['M10 2a8 8 0 1 1 0 16 8 8 0 0 1 0-16z', 'M8.3 14.2V6.3h4.2M8.3 10.1h3.6'],
};

/** The mark of a class: its shape in its colour with its letter. @param {string} name @returns {SVGSVGElement} */
export function classMark(name) {
  const svg = document.createElementNS(NS, 'svg');
  svg.setAttribute('viewBox', '0 0 20 20');
  svg.setAttribute('aria-hidden', 'true');
  svg.classList.add('mark', `is-${name}`);
  for (const drawn of MARKS[name] ?? ['M4 9h12v2H4z']) {
    const path = document.createElementNS(NS, 'path');
    path.setAttribute('d', drawn);
    svg.append(path);
  }
  return svg;
}

/** Puts its drawing into each element that names one by data-icon. @param {ParentNode} root */
export function drawIcons(root) {
  for (const element of root.querySelectorAll('[data-icon]')) {
    element.prepend(icon(element.getAttribute('data-icon') ?? ''));
  }
}
