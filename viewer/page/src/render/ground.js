import {
  Color, CustomBlending, DataTexture, FloatType, GLSL3, LinearFilter, Mesh,
  NearestFilter, PlaneGeometry, Quaternion, RawShaderMaterial, RGBAFormat, SrcColorFactor, Vector3, WebGLRenderTarget,
  ZeroFactor,
} from 'three';
import {PixelPass, PRECISION} from './pixel_pass.js';
import {shadowBy} from './shading.js';

const PLACES = 96, KEY_SIZE = 128;
const REACH = 4;         // half the ground's side over the object's radius
const STRENGTH = 0.78;   // of shadows

/**
 * A floor that is seen by the shadows it takes and, when it holds objects up, by its grid. Its light is computed for a
 * small picture of it, seen from above, and not for each pixel of the screen.
 */
export class Ground {
  /**
   * @param {import('./sky_light.js').SkyLight} skyLight
   * @param {object} light  uniforms of key light and shadow map
   */
  constructor(skyLight, light) {
    this.positions = placesTexture();
    this.normals = placesTexture();
    const sky = skyLight.addReceiver(PLACES, PLACES,
      {positions: {value: this.positions}, normals: {value: this.normals}}, LinearFilter);
    this.keyTarget = new WebGLRenderTarget(KEY_SIZE, KEY_SIZE, {minFilter: LinearFilter, magFilter: LinearFilter, depthBuffer: false});
    this.toWorld = {corner: {value: new Vector3()}, across: {value: new Vector3()}, along: {value: new Vector3()}};
    this.keyPass = new PixelPass(KEY, {...this.toWorld, ...light});
    this.uniforms = {
      sky_light: {value: sky}, key_light: {value: this.keyTarget.texture}, key_towards: light.key_towards,
      up: light.up, lines: {value: 0}, line_colour: {value: new Color()}, cell: {value: 1}, strength: {value: STRENGTH},
    };
    this.mesh = new Mesh(new PlaneGeometry(2, 2), new RawShaderMaterial({
      glslVersion: GLSL3, uniforms: this.uniforms, vertexShader: PRECISION + VERTEX, fragmentShader: PRECISION + FRAGMENT,
      depthWrite: false, blending: CustomBlending, blendSrc: ZeroFactor, blendDst: SrcColorFactor,
    }));
    this.mesh.renderOrder = -1;
    this.mesh.frustumCulled = false;
  }

  /** Lays the ground out under a ball. @param {Vector3} up @param {number} height along it */
  place(up, height, {centre, radius}) {
    const middle = new Vector3(...centre);
    middle.addScaledVector(up, height - middle.dot(up));
    const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), up);
    const size = REACH * radius;
    this.mesh.position.copy(middle);
    this.mesh.quaternion.copy(turn);
    this.mesh.scale.setScalar(size);
    this.uniforms.cell.value = 2 * REACH * 5;
    const across = new Vector3(1, 0, 0).applyQuaternion(turn).multiplyScalar(2 * size);
    const along = new Vector3(0, 1, 0).applyQuaternion(turn).multiplyScalar(2 * size);
    const corner = middle.clone().addScaledVector(across, -0.5).addScaledVector(along, -0.5);
    this.toWorld.corner.value.copy(corner);
    this.toWorld.across.value.copy(across);
    this.toWorld.along.value.copy(along);
    const x = this.positions.image.data, n = this.normals.image.data;
    for (let k = 0; k < PLACES * PLACES; ++k) {
      const at = corner.clone().addScaledVector(across, (k % PLACES + 0.5) / PLACES)
        .addScaledVector(along, (Math.floor(k / PLACES) + 0.5) / PLACES);
      x.set([at.x, at.y, at.z, 0], 4 * k);
      n.set([up.x, up.y, up.z, 0], 4 * k);
    }
    this.positions.needsUpdate = this.normals.needsUpdate = true;
  }

  /** Takes the shadows of the object as it is now. */
  update(renderer) {
    this.keyPass.render(renderer, this.keyTarget);
  }

  dispose() {
    for (const thing of [this.positions, this.normals, this.keyTarget, this.keyPass, this.mesh.geometry, this.mesh.material])
      thing.dispose();
  }
}

function placesTexture() {
  const texture = new DataTexture(new Float32Array(4 * PLACES * PLACES), PLACES, PLACES, RGBAFormat, FloatType);
  texture.minFilter = texture.magFilter = NearestFilter;
  return texture;
}

const KEY = `
  uniform vec3 corner, across, along;
  ${shadowBy(16)}
  out vec4 light;
  void main() {
    vec2 share = gl_FragCoord.xy / ${KEY_SIZE}.0;
    light = vec4(vec3(unshadowed(corner + share.x * across + share.y * along, 0.03)), 1);
  }
`;

const VERTEX = `
  uniform mat4 modelViewMatrix, projectionMatrix;
  in vec3 position;
  in vec2 uv;
  out vec2 share;
  void main() {
    share = uv;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1);
  }
`;

const FRAGMENT = `
  uniform sampler2D sky_light, key_light;
  uniform vec3 key_towards, up, line_colour;
  uniform float lines, cell, strength;
  in vec2 share;
  out vec4 factor;
  void main() {
    float key = texture(key_light, share).r, sky = texture(sky_light, share).r, cosine = dot(key_towards, up);
    float light = (0.92 * cosine * key + 0.62 * min(sky, 1.0)) / (0.92 * cosine + 0.62);
    float fade = 1.0 - smoothstep(0.45, 1.0, 2.0 * distance(share, vec2(0.5)));
    // The screen holds encoded colours: what scales light scales them by its root.
    float shadow = pow(1.0 - strength * fade * (1.0 - light), 0.4545);
    vec2 at = share * cell, width = fwidth(at), near = abs(fract(at - 0.5) - 0.5) / max(width, 1e-6);
    float line = lines * fade * (1.0 - min(1.0, min(near.x, near.y))) * clamp(1.0 - 3.0 * max(width.x, width.y), 0.0, 1.0);
    factor = vec4(mix(vec3(shadow), shadow * line_colour, line), 1);
  }
`;
