// A soft shadow on a ground below all parts: what stands on it is dark, what floats fainter. Its map is drawn anew only when a part moved or looks otherwise.
import * as THREE from 'three';
import { groundUnder } from './ground_place.js';

const KEPT = 'mortise.ground';
const PIXELS = 128;
const STRENGTH = 0.55;
/** Above, each picture of a motion would cost more than it shows. */
const MOST_TRIANGLES = 300_000;

/** Seen from the ground: the nearer, the darker. */
const caster = () => new THREE.ShaderMaterial({
  uniforms: { falls: { value: 1 } },
  side: THREE.DoubleSide,
  blending: THREE.NoBlending,
  vertexShader: `
    #include <common>
    #include <batching_pars_vertex>
    void main() {
      #include <batching_vertex>
      #include <begin_vertex>
      #include <project_vertex>
    }`,
  fragmentShader: `
    uniform float falls;
    void main() { gl_FragColor = vec4(exp(-falls * gl_FragCoord.z)); }`,
});

/** Taps along one side of the map, no two of them farther apart than its pixels show: a Gaussian, cut at two and a half deviations. */
const blur = () => new THREE.ShaderMaterial({
  uniforms: { map: { value: null }, by: { value: new THREE.Vector2() } },
  depthTest: false,
  depthWrite: false,
  blending: THREE.NoBlending,
  vertexShader: 'varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }',
  fragmentShader: `
    uniform sampler2D map;
    uniform vec2 by;
    varying vec2 at;
    void main() {
      float sum = 0.0, all = 0.0;
      for (int i = -5; i <= 5; ++i) {
        float x = 0.5 * float(i), weight = exp(-0.5 * x * x);
        sum += weight * texture2D(map, at + x * by).r;
        all += weight;
      }
      gl_FragColor = vec4(sum / all);
    }`,
});

/** Only from above. The map is seen from below: its x is that of the world turned round. @param {THREE.Texture} map */
const floor = (map) => new THREE.ShaderMaterial({
  uniforms: { map: { value: map }, strength: { value: STRENGTH } },
  transparent: true,
  depthWrite: false,
  vertexShader: 'varying vec2 at; void main() { at = vec2(1.0 - uv.x, uv.y); gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }',
  fragmentShader: 'uniform sampler2D map; uniform float strength; varying vec2 at; void main() { gl_FragColor = vec4(0.0, 0.0, 0.0, strength * texture2D(map, at).r); }',
});

export class Ground {
  on = localStorage.getItem(KEPT) !== 'off';
  #eye = new THREE.OrthographicCamera();
  #maps = [0, 1].map(() => new THREE.WebGLRenderTarget(PIXELS, PIXELS, { depthBuffer: true }));
  #caster = caster();
  #blur = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), blur());
  #floor = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), floor(this.#maps[0].texture));
  /** Of the poses that the map shows. */
  #version = -1;
  #box = new THREE.Box3();

  /** @param {import('./stage.js').Stage} stage @param {import('./parts_view.js').PartsView} partsView */
  constructor(stage, partsView) {
    this.stage = stage;
    this.partsView = partsView;
    Object.assign(this.#floor, { visible: false, renderOrder: -1 });
    this.#blur.frustumCulled = false;
    this.#eye.up.set(0, 1, 0);
    stage.scene.add(this.#floor);
    stage.beforePicture(() => this.#prepare());
  }

  /** @param {boolean} on */
  set(on) {
    this.on = on;
    localStorage.setItem(KEPT, on ? 'on' : 'off');
    this.stage.ask();
  }

  /** Where a plane cuts, what lies below the cut would throw a shadow of more than is seen. */
  #prepare() {
    const { partsView } = this;
    if (!this.on || partsView.looks.clipping.length > 0) {
      this.#floor.visible = false;
      this.#version = -1;
    } else if (this.#version !== partsView.version) {
      this.#version = partsView.version;
      const place = this.#costs() ? null : groundUnder(this.#bounds());
      this.#floor.visible = place !== null;
      if (place) this.#draw(place);
    }
  }

  /** Too many facets, or a browser that draws one by one. */
  #costs() {
    if (!this.stage.renderer.extensions.has('WEBGL_multi_draw')) return true;
    let corners = 0;
    for (const { shape, look } of this.partsView.shown.values()) if (look !== 'hidden') corners += shape.faces.index?.count ?? 0;
    return corners > 3 * MOST_TRIANGLES;
  }

  #bounds() {
    const all = new THREE.Box3();
    for (const { faces, look } of this.partsView.shown.values()) {
      if (look !== 'hidden' && faces.geometry.boundingBox) all.union(this.#box.copy(faces.geometry.boundingBox).applyMatrix4(faces.matrixWorld));
    }
    return all;
  }

  /** @param {import('./ground_place.js').Place} place */
  #draw({ at, half, height, fall, soft }) {
    const eye = this.#eye;
    Object.assign(eye, { left: -half[0], right: half[0], top: half[1], bottom: -half[1], near: 0, far: height });
    eye.position.set(...at);
    eye.lookAt(at[0], at[1], at[2] + 1);
    eye.updateProjectionMatrix();
    this.#caster.uniforms.falls.value = height / fall;
    const { casters } = this.partsView;
    casters.overrideMaterial = this.#caster;
    const { renderer } = this.stage;
    const [map, spare] = this.#maps;
    renderer.setRenderTarget(map);
    renderer.render(casters, eye);
    for (const [from, to, x, y] of /** @type {const} */ ([[map, spare, soft / (2 * half[0]), 0], [spare, map, 0, soft / (2 * half[1])]])) {
      const { map: shown, by } = this.#blur.material.uniforms;
      shown.value = from.texture;
      by.value.set(x, y);
      renderer.setRenderTarget(to);
      renderer.render(this.#blur, eye);
    }
    renderer.setRenderTarget(null);
    this.#floor.position.set(...at);
    this.#floor.scale.set(half[0], half[1], 1);
  }
}
