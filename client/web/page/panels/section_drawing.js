// The section through a clash, drawn flat: both meshes as they are cut, the surfaces that they stand for, the point, and a scale.
// Near enough that micrometres show.
import { placed, rotate } from '../session/motion.js';
import { across, chains, cross, dot, nearest, slice, unit } from '../session/slice.js';
import { small } from '../session/words.js';
import { el, setText } from './dom.js';

/** @typedef {import('../session/session.js').Clash} Clash */
/** @typedef {import('../session/session.js').Part} Part */
/** @typedef {import('../session/motion.js').Vec3} Vec3 */

/** Other way or not, and how far beside the point, mm. @type {Array<[boolean, number]>} */
const TRIES = [[false, 0.05], [false, -0.05], [false, 0.5], [false, -0.5], [true, 0], [true, 0.5], [true, -0.5], [false, 2], [false, -2], [false, 6], [false, -6], [false, 15], [false, -15]];
const COLOURS = ['#5d9fd6', '#d9a45a'];

export class SectionDrawing {
  canvas = el('canvas', { role: 'img' });
  caption = el('p', { class: 'caption' });
  #turned = false;
  /** @type {Clash | null} */
  #clash = null;
  #drawing = false;
  #again = false;

  /** @param {import('../desk.js').Desk} desk */
  constructor({ session, partsView }) {
    this.session = session;
    this.partsView = partsView;
    // Its colours and points are those of the page as it was when it was drawn.
    new MutationObserver(() => this.#drawAgain()).observe(document.documentElement, { attributeFilter: ['data-theme'] });
    new ResizeObserver(() => this.#drawAgain()).observe(this.canvas);
  }

  turn() {
    this.#turned = !this.#turned;
    this.#drawAgain();
  }

  #drawAgain() {
    if (this.#clash && this.canvas.clientWidth > 0) this.show(this.#clash);
  }

  /** @param {Clash} clash */
  async show(clash) {
    this.#clash = clash;
    this.#again = this.#drawing;
    if (this.#drawing) return;
    this.#drawing = true;
    await this.#draw(clash);
    this.#drawing = false;
    if (this.#again && this.#clash) await this.show(this.#clash);
  }

  /** Across the axis of a round face of the pair, where one is named, or along it; both hold the normal. 
   * @param {Clash} clash @param {boolean} turned @param {number} beside the point, mm */
  #planeOf(clash, turned, beside) {
    const u = unit(clash.normal);
    const axis = this.#axisOf(clash) ?? across(u);
    /** @type {Vec3} the part of the axis across u */
    const flat = [axis[0] - dot(axis, u) * u[0], axis[1] - dot(axis, u) * u[1], axis[2] - dot(axis, u) * u[2]];
    const along = Math.hypot(...flat) > 0.1 ? unit(flat) : across(u);
    const v = turned ? along : cross(along, u);
    const n = cross(u, v);
    return { origin: /** @type {Vec3} */ (clash.point.map((x, i) => x + beside * n[i])), u, v };
  }

  /** @param {Clash} clash @returns {Vec3 | null} */
  #axisOf(clash) {
    for (const [id, face] of /** @type {Array<[number, string]>} */ ([[clash.a, clash.faces[0]], [clash.b, clash.faces[1]]])) {
      const part = this.session.parts.get(id);
      const feature = this.session.features.get(id)?.find((f) => f.name === face);
      if (part && feature && feature.kind !== 'plane' && feature.kind !== 'sphere') return rotate(part.q, feature.axis);
    }
    return null;
  }

  /** @param {Clash} clash */
  async #draw(clash) {
    const parts = [this.session.parts.get(clash.a), this.session.parts.get(clash.b)];
    const meshes = await Promise.all(parts.map((part) => part && this.partsView.meshOf(part)));
    const names = parts.map((part) => part?.name ?? '?');
    this.canvas.setAttribute('aria-label', `Section through the clash of ${names[0]} (blue) and ${names[1]} (amber, hatched)`);
    const cutBy = (/** @type {boolean} */ turned, /** @type {number} */ beside) => {
      const plane = this.#planeOf(clash, turned, beside);
      const cuts = parts.map((part, i) => {
        const mesh = meshes[i];
        return part && mesh ? slice(mesh, part, plane) : [];
      });
      return { turned, plane, cuts, apart: Math.max(...cuts.map((cut) => nearest(cut).apart)) };
    };
    // Overlaps end at rims, where a plane misses one of the two: then a little beside, or the other way. A part that was stopped stands off.
    let view = this.#frame(clash, 0);
    let cut = cutBy(this.#turned, 0);
    for (const [turned, beside] of TRIES) {
      if (cut.apart <= view.height / 2) break;
      const other = cutBy(this.#turned !== turned, beside);
      if (other.apart < cut.apart) cut = other;
    }
    /** @type {[number, number]} */
    let middle = [0, 0];
    if (cut.apart > view.height / 2 && Number.isFinite(cut.apart)) {
      // The clash is told where it was judged last, and the part has moved on since, or was stopped before: to where the two are nearest.
      const far = nearest(cut.cuts[0]).apart === cut.apart ? 0 : 1;
      const there = nearest(cut.cuts[far]).at;
      const here = nearest(cut.cuts[1 - far], there);
      middle = [(there[0] + here.at[0]) / 2, (there[1] + here.at[1]) / 2];
      view = this.#frame(clash, here.apart);
    }
    const { plane, cuts, turned } = cut;
    this.#paint(cuts.map((segments) => chains(segments)), { ...view, middle }, plane, clash, parts);
    setText(this.caption, `${turned ? 'Along' : 'Across'}: ${names[0]} blue, ${names[1]} hatched; dashed: true surfaces`);
  }

  /** So near that the overlap is a seventh of the picture, within reason, and that what is `apart` from the point is seen. @param {Clash} clash @param {number} apart */
  #frame(clash, apart) {
    const ratio = Math.min(2, devicePixelRatio);
    this.canvas.width = Math.max(10, this.canvas.clientWidth * ratio);
    this.canvas.height = Math.max(10, this.canvas.clientHeight * ratio);
    const depth = Math.max(Math.abs(clash.delta[1] ?? 0), Math.abs(clash.real_above), 1e-3);
    const height = Math.max(3 * apart, Math.min(20, Math.max(0.05, depth * 7)));
    return { scale: this.canvas.height / height, ratio, height };
  }

  /**
   * @param {Array<Array<Array<[number, number]>>>} cuts @param {{scale: number, ratio: number, middle: [number, number]}} view
   * @param {import('../session/slice.js').Plane} plane @param {Clash} clash @param {Array<Part | undefined>} parts
   */
  #paint(cuts, { scale, ratio, middle }, plane, clash, parts) {
    const { width, height } = this.canvas;
    const pen = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext('2d'));
    const text = getComputedStyle(this.canvas).color;
    pen.clearRect(0, 0, width, height);
    pen.save();
    pen.translate(width / 2 - middle[0] * scale, height / 2 + middle[1] * scale);
    cuts.forEach((loops, i) => {
      pen.beginPath();
      for (const loop of loops) {
        loop.forEach(([x, y], k) => (k === 0 ? pen.moveTo(x * scale, -y * scale) : pen.lineTo(x * scale, -y * scale)));
      }
      pen.globalAlpha = 0.42;
      pen.fillStyle = i === 0 ? COLOURS[0] : hatch(pen, COLOURS[1], ratio);
      pen.fill('evenodd');
      pen.globalAlpha = 1;
      pen.lineWidth = 1.6 * ratio;
      pen.strokeStyle = COLOURS[i];
      pen.stroke();
    });
    pen.setLineDash([5 * ratio, 4 * ratio]);
    pen.lineWidth = 1.2 * ratio;
    parts.forEach((part, i) => part && this.#trueSurface(pen, part, clash.faces[i], plane, scale, COLOURS[i]));
    pen.setLineDash([]);
    pen.fillStyle = pen.strokeStyle = text;
    pen.beginPath();
    pen.arc(0, 0, 3 * ratio, 0, 2 * Math.PI);
    pen.fill();
    pen.restore();
    drawScale(pen, scale, ratio, text);
  }

  /** A cylinder across its axis is a circle, along it two lines; a plane is a line. What else there is is not drawn.
   * @param {CanvasRenderingContext2D} pen @param {Part} part @param {string} face @param {import('../session/slice.js').Plane} plane
   * @param {number} scale @param {string} colour */
  #trueSurface(pen, part, face, plane, scale, colour) {
    const feature = this.session.features.get(part.id)?.find((f) => f.name === face);
    if (!feature) return;
    const axis = rotate(part.q, feature.axis);
    const point = placed(part, feature.point);
    const d = /** @type {Vec3} */ ([0, 1, 2].map((i) => point[i] - plane.origin[i]));
    const at = [dot(d, plane.u), dot(d, plane.v)];
    const n = cross(plane.u, plane.v);
    const head = Math.abs(dot(axis, n));
    pen.strokeStyle = colour;
    pen.beginPath();
    if (feature.kind === 'cylinder' && head > 0.9999) {
      pen.arc(at[0] * scale, -at[1] * scale, feature.radius * scale, 0, 2 * Math.PI);
    } else if (feature.kind === 'cylinder' && head < 0.01) {
      const off = Math.sqrt(Math.max(0, feature.radius ** 2 - dot(d, n) ** 2));
      for (const side of [off, -off]) line(pen, at, [dot(axis, plane.u), dot(axis, plane.v)], side, scale);
    } else if (feature.kind === 'plane' && head < 0.01) {
      const normal = [dot(axis, plane.u), dot(axis, plane.v)];
      line(pen, at, [-normal[1], normal[0]], 0, scale);
    }
    pen.stroke();
  }
}

/** A long line through `at` along `way`, shifted to its left. @param {CanvasRenderingContext2D} pen @param {number[]} at @param {number[]} way @param {number} left @param {number} scale */
function line(pen, at, way, left, scale) {
  const length = Math.hypot(...way) || 1;
  const [ux, uy] = [way[0] / length, way[1] / length];
  const [x, y] = [at[0] - uy * left, at[1] + ux * left];
  // From the point of the line that is nearest to the middle, lest the ends are too far for the canvas.
  const s = -(x * ux + y * uy);
  const reach = 4000 / scale;
  pen.moveTo((x + (s - reach) * ux) * scale, -(y + (s - reach) * uy) * scale);
  pen.lineTo((x + (s + reach) * ux) * scale, -(y + (s + reach) * uy) * scale);
}

/** @param {CanvasRenderingContext2D} pen @param {string} colour @param {number} ratio */
function hatch(pen, colour, ratio) {
  const tile = document.createElement('canvas');
  tile.width = tile.height = 8 * ratio;
  const ink = /** @type {CanvasRenderingContext2D} */ (tile.getContext('2d'));
  ink.fillStyle = colour;
  ink.globalAlpha = 0.5;
  ink.fillRect(0, 0, 8 * ratio, 8 * ratio);
  ink.globalAlpha = 1;
  ink.strokeStyle = colour;
  ink.lineWidth = 1.5 * ratio;
  ink.beginPath();
  for (const k of [-8, 0, 8]) {
    ink.moveTo((k - 1) * ratio, 9 * ratio);
    ink.lineTo((k + 9) * ratio, -1 * ratio);
  }
  ink.stroke();
  return pen.createPattern(tile, 'repeat') ?? colour;
}

/** A round length of about a quarter of the picture. @param {CanvasRenderingContext2D} pen @param {number} scale @param {number} ratio @param {string} colour */
function drawScale(pen, scale, ratio, colour) {
  const { width, height } = pen.canvas;
  const about = width / 4 / scale;
  const power = 10 ** Math.floor(Math.log10(about));
  const length = [5, 2, 1].map((times) => times * power).find((x) => x <= about) ?? power;
  const [x, y] = [10 * ratio, height - 9 * ratio];
  pen.strokeStyle = pen.fillStyle = colour;
  pen.lineWidth = 1.5 * ratio;
  pen.beginPath();
  pen.moveTo(x, y - 4 * ratio);
  pen.lineTo(x, y);
  pen.lineTo(x + length * scale, y);
  pen.lineTo(x + length * scale, y - 4 * ratio);
  pen.stroke();
  pen.font = `${11 * ratio}px system-ui, "DejaVu Sans", sans-serif`;
  pen.textAlign = 'left';
  pen.fillText(small(length).replace('.0 ', ' ').replace('.000 ', ' '), x + length * scale + 6 * ratio, y);
}
