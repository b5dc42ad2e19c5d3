// SPDX-License-Identifier: MIT
//
// marks.js: singularities: spheres where the index is positive, octahedra where it is negative, in two colours that
// colour-blind eyes tell apart, each with a light rim; and the straight branches of their patterns.
import { BackSide, Color, FrontSide, Group, IcosahedronGeometry, InstancedBufferAttribute, InstancedBufferGeometry, Mesh, OctahedronGeometry, ShaderMaterial } from 'three';

import { Lines } from './lines.js';

const vertexShader = /* glsl */ `
attribute vec3 center;
attribute float scale;
uniform float radius, grow, height;
uniform vec2 pixels;
varying vec3 vNormal;
void main() {
  vec4 view = modelViewMatrix * vec4(center, 1.0);
  float unit = -view.z * 2.0 / (projectionMatrix[1][1] * height);  // world size of a pixel there
  float r = clamp(radius, pixels.x * unit, pixels.y * unit) * scale;
  vNormal = normalMatrix * normal;
  view.xyz += normalMatrix * position * (r + grow * unit);
  view.xyz *= 0.9975;
  gl_Position = projectionMatrix * view;
}`;

const fragmentShader = /* glsl */ `
uniform vec3 color;
uniform float flatness;
varying vec3 vNormal;
void main() {
  vec3 n = normalize(vNormal);
  float light = mix(0.62 + 0.45 * max(dot(n, normalize(vec3(-0.45, 0.65, 0.62))), 0.0), 1.0, flatness);
  gl_FragColor = vec4(color * light, 1.0);
  #include <colorspace_fragment>
}`;

export class Marks {
  constructor(diagonal) {
    this.object = new Group();
    this.diagonal = diagonal;
    this.materials = [];
    this.kinds = [this.kind(new IcosahedronGeometry(1, 3), '--positive'), this.kind(new OctahedronGeometry(1.25, 0), '--negative')];
    this.arms = ['--positive', '--negative'].map((variable) => {
      const lines = new Lines({ variable, width: 0.004 * diagonal, widths: [1.6, 4], lift: 0.003, order: 3 });
      this.object.add(lines.object);
      return lines;
    });
  }

  kind(shape, variable) {
    const meshes = [true, false].map((rim) => {
      const material = new ShaderMaterial({
        vertexShader,
        fragmentShader,
        side: rim ? BackSide : FrontSide,
        uniforms: {
          color: { value: new Color('#fff') }, flatness: { value: rim ? 1 : 0 }, height: { value: 1 },
          radius: { value: 0.0062 * this.diagonal }, pixels: { value: [3.2, 9] }, grow: { value: rim ? 1.5 : 0 },
        },
      });
      material.variable = rim ? null : variable;
      this.materials.push(material);
      const mesh = new Mesh(copies(shape), material);
      mesh.frustumCulled = false;
      mesh.renderOrder = 4;
      this.object.add(mesh);
      return mesh;
    });
    return { shape, meshes };
  }

  theme(style) {
    for (const m of this.materials) if (m.variable) m.uniforms.color.value.set(style.getPropertyValue(m.variable).trim());
    for (const a of this.arms) a.theme(style);
  }

  /** 8 numbers each: position, normal, index, swirl; arms: number of the singularity, direction. */
  set(singular, arms) {
    const length = 0.022 * this.diagonal;
    const places = [[], []], scales = [[], []], segments = [[], []];
    for (let k = 0; k < singular.length; k += 8) {
      const index = singular[k + 6], side = index > 0 ? 0 : 1;
      places[side].push(singular[k], singular[k + 1], singular[k + 2]);
      scales[side].push(Math.abs(index) > 1 ? 1.45 : 1);
    }
    for (let k = 0; k < arms.length; k += 4) {
      const s = 8 * arms[k];
      const [x, y, z] = [singular[s], singular[s + 1], singular[s + 2]];
      segments[singular[s + 6] > 0 ? 0 : 1].push(x, y, z, x + length * arms[k + 1], y + length * arms[k + 2], z + length * arms[k + 3], 0, length);
    }
    this.kinds.forEach(({ shape, meshes }, side) => {
      // A geometry of their own each time, as in Lines.segments().
      const geometry = copies(shape);
      geometry.setAttribute('center', new InstancedBufferAttribute(new Float32Array(places[side]), 3));
      geometry.setAttribute('scale', new InstancedBufferAttribute(new Float32Array(scales[side]), 1));
      geometry.instanceCount = scales[side].length;
      for (const m of meshes) {
        m.geometry.dispose();
        m.geometry = geometry;
        m.visible = scales[side].length > 0;
      }
      this.arms[side].segments(new Float32Array(segments[side]));
    });
  }

  show(visible) {
    this.object.visible = visible;
  }

  showArms(visible) {
    for (const a of this.arms) a.show(visible);
  }

  resize(width, height, ratio) {
    for (const m of this.materials) m.uniforms.height.value = height;
    for (const a of this.arms) a.resize(width, height, ratio);
  }
}

/** A shape, to be drawn many times. */
function copies(shape) {
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute('position', shape.getAttribute('position'));
  geometry.setAttribute('normal', shape.getAttribute('normal'));
  if (shape.index) geometry.setIndex(shape.index);
  geometry.instanceCount = 0;
  return geometry;
}
