// How a field of overlap looks: a colour for each zone of the scale that deepens within it, stripes beside the colour, a line at each threshold.
import * as THREE from 'three';
import { CLASS_COLOURS } from '../session/class_colours.js';

const DECLARED = `
varying float overlapHere;
uniform vec4 heatScale; // from, fake up to, real above, top; mm
uniform float heatLift;
uniform vec3 heatColours[6];
vec3 heatColour(float d) {
  float at = gl_FragCoord.x + gl_FragCoord.y;
  if (d < heatScale.y) return mix(heatColours[0], heatColours[1], clamp((d - heatScale.x) / max(heatScale.y - heatScale.x, 1e-9), 0.0, 1.0));
  if (d < heatScale.z) return mix(heatColours[2], heatColours[3], clamp((d - heatScale.y) / max(heatScale.z - heatScale.y, 1e-9), 0.0, 1.0)) * (mod(at, 9.0) < 3.0 ? 0.72 : 1.0);
  return mix(heatColours[4], heatColours[5], clamp((d - heatScale.z) / max(heatScale.w - heatScale.z, 1e-9), 0.0, 1.0)) * (mod(gl_FragCoord.x, 5.0) < 2.0 ? 0.7 : 1.0);
}
// None where the whole scale passes within a few pixels: there lines would be all that is seen.
float heatLine(float d, float at) {
  float pixel = max(fwidth(d), 1e-9);
  return (1.0 - smoothstep(0.5, 1.4, abs(d - at) / pixel)) * smoothstep(20.0, 50.0, (heatScale.w - heatScale.x) / pixel);
}`;

const COLOURED = `
float heatDepth = overlapHere + heatLift;
float heatRim = 0.15 * (heatScale.w - heatScale.x);
if (heatDepth < heatScale.x - heatRim) discard;
diffuseColor.rgb = heatColour(heatDepth);
diffuseColor.rgb *= 1.0 - 0.65 * max(heatLine(heatDepth, heatScale.x), max(heatLine(heatDepth, heatScale.y), heatLine(heatDepth, heatScale.z)));
diffuseColor.a *= smoothstep(heatScale.x - heatRim, heatScale.x, heatDepth);`;

export class HeatMaterial extends THREE.MeshStandardMaterial {
  heat = { scale: { value: new THREE.Vector4() }, lift: { value: 0 } };

  /** @param {boolean} behind what lies before it: seen through, faintly */
  constructor(behind) {
    super({ roughness: 0.7, flatShading: true, transparent: true, depthWrite: false, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1, opacity: behind ? 0.32 : 1 });
    if (behind) this.depthFunc = THREE.GreaterDepth;
    const colours = Object.values(CLASS_COLOURS).flatMap(({ heat }) => heat).map((colour) => new THREE.Color(colour));
    this.onBeforeCompile = (/** @type {THREE.WebGLProgramParametersWithUniforms} */ shader) => {
      Object.assign(shader.uniforms, { heatScale: this.heat.scale, heatLift: this.heat.lift, heatColours: { value: colours } });
      shader.vertexShader = shader.vertexShader
        .replace('#include <common>', '#include <common>\nattribute float overlap;\nvarying float overlapHere;')
        .replace('#include <begin_vertex>', '#include <begin_vertex>\noverlapHere = overlap;');
      shader.fragmentShader = shader.fragmentShader
        .replace('#include <common>', `#include <common>\n${DECLARED}`)
        .replace('#include <color_fragment>', `#include <color_fragment>\n${COLOURED}`);
    };
  }

  /** @param {import('../session/heat_scale.js').HeatScale} scale @param {number} lift */
  show({ from, fake, real, top }, lift) {
    this.heat.scale.value.set(from, fake, real, top);
    this.heat.lift.value = lift;
  }
}
