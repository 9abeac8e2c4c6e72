// Colours and materials of parts: one material for all that look alike.
import * as THREE from 'three';

/** Calm, distinct, alike in brightness; parts that stand are grey. */
const MOVING = [0x7ba7cc, 0xd9b26f, 0x8fbf8f, 0xc98f7a, 0xa796c9, 0x6fb7b7, 0xc9a0b4, 0xb5b873, 0x8a9bd0, 0xd09a5b];
const STANDING = [0xaab1ba, 0x98a1ac, 0xb9bec5];
const PEOPLE = ['#6cb1f2', '#f0a35e', '#b48ef0', '#e97fa6', '#4fc3b0', '#d8c04c', '#9aa7ff', '#ef8a80'];
const GHOST = 0.13;

/** @param {number} user */
export function personColour(user) {
  return PEOPLE[user % PEOPLE.length];
}

/** @typedef {'plain' | 'chosen' | 'ghost' | 'hidden'} Look */

export class Looks {
  /** @type {Map<string, THREE.Material>} */
  #materials = new Map();
  /** @type {Map<string, number>} */
  #colours = new Map();
  #counts = { moving: 0, standing: 0 };
  /** @type {THREE.Plane[]} */
  clipping = [];

  /** Parts of one mesh have one colour, in the order in which they come. @param {{mesh: string, moving: boolean}} part */
  colourOf(part) {
    const key = `${part.moving} ${part.mesh}`;
    let colour = this.#colours.get(key);
    if (colour === undefined) {
      const kind = part.moving ? 'moving' : 'standing';
      const palette = part.moving ? MOVING : STANDING;
      colour = palette[this.#counts[kind]++ % palette.length];
      this.#colours.set(key, colour);
    }
    return colour;
  }

  /** @param {string} key @param {() => THREE.Material} make */
  #kept(key, make) {
    let material = this.#materials.get(key);
    if (!material) {
      material = make();
      material.clippingPlanes = this.clipping;
      this.#materials.set(key, material);
    }
    return material;
  }

  /** Colours are those of the parts. @param {Look} look */
  faces(look) {
    return this.#kept(`faces ${look}`, () => {
      const ghost = look === 'ghost';
      return new THREE.MeshStandardMaterial({
        roughness: 0.62,
        metalness: 0.08,
        emissive: look === 'chosen' ? 0x2f74b5 : 0x000000,
        emissiveIntensity: 0.35,
        transparent: ghost,
        opacity: ghost ? GHOST : 1,
        depthWrite: !ghost,
        side: THREE.FrontSide,
        polygonOffset: true, // edges lie on the faces
        polygonOffsetFactor: 1,
        polygonOffsetUnits: 1,
      });
    });
  }

  /** @param {Look} look */
  edges(look) {
    return this.#kept(`edges ${look}`, () => {
      const chosen = look === 'chosen';
      const opacity = look === 'ghost' ? 0.16 : chosen ? 1 : 0.55;
      return new THREE.LineBasicMaterial({ color: chosen ? 0x1b8cff : 0x10151c, transparent: true, opacity, depthWrite: false });
    });
  }

  /** What a cut opens: the insides, flat, so that they read as the cut face. @param {Look} look */
  inside(look) {
    return this.#kept(`inside ${look}`, () => new THREE.MeshBasicMaterial({ color: new THREE.Color().setScalar(look === 'chosen' ? 0.8 : 0.62), side: THREE.BackSide }));
  }

  /** @param {THREE.Plane[]} planes */
  cutBy(planes) {
    this.clipping = planes;
    for (const material of this.#materials.values()) {
      material.clippingPlanes = planes;
      material.needsUpdate = true;
    }
  }
}
