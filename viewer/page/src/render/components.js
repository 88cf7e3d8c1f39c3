import {
  DataTexture, GLSL3, IcosahedronGeometry, InstancedBufferAttribute, InstancedBufferGeometry, Mesh, NearestFilter,
  RawShaderMaterial, RedIntegerFormat, UnsignedIntType,
} from 'three';
import {mapColour} from './colour_maps.js';
import {TEXEL_OF_VERTEX} from './vertex_grid.js';
import {PRECISION} from './pixel_pass.js';
import {SHADING} from './shading.js';

const COLUMNS = 1024;

/**
 * The selected components as balls whose volume and colour are their weights; they follow the object on the graphics
 * card.
 */
export class Components {
  /** @param {import('./body.js').Body} body */
  constructor(body, {components, weights, about}) {
    const {low, high} = this.range = rangeOf(weights);
    const balls = new IcosahedronGeometry(1, 3);
    this.geometry = new InstancedBufferGeometry();
    this.geometry.setAttribute('position', balls.attributes.position);
    this.geometry.instanceCount = about.components;
    const share = Float32Array.from(weights, (w) => shareOf(w, low, high));
    const mean = weights.reduce((sum, w) => sum + w, 0) / Math.max(1, weights.length);
    const size = Float32Array.from(weights, (w) => 0.0085 * about.diagonal * Math.min(2, Math.max(0.6, Math.cbrt(w / mean))));
    const colour = new Float32Array(3 * weights.length);
    share.forEach((s, k) => colour.set(mapColour('sequential', s), 3 * k));
    this.geometry.setAttribute('size', new InstancedBufferAttribute(size, 1));
    this.geometry.setAttribute('colour', new InstancedBufferAttribute(colour, 3));

    const texels = new Uint32Array(COLUMNS * Math.max(1, Math.ceil(components.length / COLUMNS)));
    texels.set(components);
    this.corners = new DataTexture(texels, COLUMNS, texels.length / COLUMNS, RedIntegerFormat, UnsignedIntType);
    this.corners.internalFormat = 'R32UI';
    this.corners.minFilter = this.corners.magFilter = NearestFilter;
    this.corners.needsUpdate = true;
    const {positions, columns, up, key_towards, rim_towards, ground_height, scene_radius} = body.uniforms;
    this.material = new RawShaderMaterial({
      glslVersion: GLSL3, vertexShader: PRECISION + VERTEX, fragmentShader: PRECISION + FRAGMENT,
      defines: {CORNERS: about.component_nodes},
      uniforms: {positions, columns, corners: {value: this.corners}, up, key_towards, rim_towards, ground_height, scene_radius},
    });
    this.mesh = new Mesh(this.geometry, this.material);
    this.mesh.frustumCulled = false;
  }

  dispose() {
    for (const thing of [this.geometry, this.material, this.corners]) thing.dispose();
  }
}

/** Weights reach over decades, so that colours follow their logarithms. */
const shareOf = (w, low, high) => (high > low ? Math.log(Math.max(w, low) / low) / Math.log(high / low) : 0.5);

function rangeOf(weights) {
  const positive = weights.filter((w) => w > 0).sort();
  if (positive.length === 0) return {low: 1, high: 1};
  const at = (share) => positive[Math.floor(share * (positive.length - 1))];
  return {low: at(0.02), high: at(1)};
}

const VERTEX = `
  uniform mat4 modelViewMatrix, projectionMatrix;
  uniform sampler2D positions;
  uniform usampler2D corners;
  ${TEXEL_OF_VERTEX}
  in vec3 position, colour;
  in float size;
  out vec3 at, normal, albedo;

  void main() {
    vec3 centre = vec3(0);
    for (int k = 0; k < CORNERS; ++k) {
      int index = gl_InstanceID * CORNERS + k;
      int node = int(texelFetch(corners, ivec2(index % ${COLUMNS}, index / ${COLUMNS}), 0).r);
      centre += texelFetch(positions, texel_of(node), 0).xyz / float(CORNERS);
    }
    normal = position;
    albedo = colour;
    at = centre + size * position;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(at, 1);
  }
`;

const FRAGMENT = `
  uniform vec3 cameraPosition;
  ${SHADING}
  in vec3 at, normal, albedo;
  out vec4 pixel;
  void main() {
    vec3 n = normalize(normal);
    pixel = vec4(to_screen(shade(albedo, at, n, normalize(cameraPosition - at), 0.5 + 0.5 * dot(n, up),
                                 max(0.0, dot(n, key_towards)))), 1);
  }
`;
