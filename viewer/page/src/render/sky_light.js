import {
  AddEquation, ClampToEdgeWrapping, CustomBlending, HalfFloatType, NearestFilter, OneMinusSrcAlphaFactor,
  SrcAlphaFactor, Vector3, WebGLRenderTarget,
} from 'three';
import {Lamp} from './lamp.js';
import {PixelPass} from './pixel_pass.js';

const LAMPS = 64, MAP_SIZE = 256, GOLDEN_ANGLE = 2.3999632;
const MEMORY = 64;  // so many lamps back a moving object's light comes from

/**
 * How much of the sky reaches each place, as a running mean over lamps all around: a lamp in each frame that is drawn,
 * so that it costs little, is complete a second after loading, and follows what moves.
 */
export class SkyLight {
  /** @param {import('three').Scene} casters  what casts shadows */
  constructor(renderer, casters) {
    this.renderer = renderer;
    this.casters = casters;
    this.lamp = new Lamp(MAP_SIZE);
    this.receivers = [];
    this.restart();
    this.alpha = {value: 1};
    this.strength = {value: 1};
    this.bias = {value: 0};
  }

  /**
   * Adds places that receive light, given by textures of their positions and normals, and by how far they are shifted.
   * @returns {import('three').Texture}  whose red is 1 where the whole sky is seen from a level place
   */
  addReceiver(columns, rows, places, filter = NearestFilter) {
    const target = new WebGLRenderTarget(columns, rows, {
      type: HalfFloatType, minFilter: filter, magFilter: filter, wrapS: ClampToEdgeWrapping, wrapT: ClampToEdgeWrapping,
      depthBuffer: false,
    });
    const pass = new PixelPass(RECEIVE, {
      shift: {value: new Vector3()}, ...places, towards: this.lamp.towards, shadow_map: this.lamp.map, to_shadow: this.lamp.matrix,
      alpha: this.alpha, strength: this.strength, bias: this.bias,
    }, {
      blending: CustomBlending, blendEquation: AddEquation, blendSrc: SrcAlphaFactor, blendDst: OneMinusSrcAlphaFactor,
      transparent: true,
    });
    this.receivers.push({target, pass});
    this.restart();  // what is new has no light yet
    return target.texture;
  }

  /** @param {import('three').Texture} texture  that addReceiver gave */
  removeReceiver(texture) {
    const k = this.receivers.findIndex(({target}) => target.texture === texture), [{target, pass}] = this.receivers.splice(k, 1);
    target.dispose();
    pass.dispose();
  }

  /** Forgets all light, as of what stood elsewhere. */
  restart() {
    this.count = 0;
  }

  /** Adds a lamp's light. @param {Vector3} up  @param {{centre: number[], radius: number}} ball around the casters */
  refine(up, ball) {
    const k = (this.count * 37) % LAMPS;  // neighbours in time are far apart in space
    const height = 0.06 + 0.94 * (k + 0.5) / LAMPS, reach = Math.sqrt(1 - height * height), angle = k * GOLDEN_ANGLE;
    const across = new Vector3(Math.abs(up.x) < 0.9 ? 1 : 0, Math.abs(up.x) < 0.9 ? 0 : 1, 0).cross(up).normalize();
    const along = new Vector3().crossVectors(up, across);
    const towards = up.clone().multiplyScalar(height)
      .addScaledVector(across, reach * Math.cos(angle)).addScaledVector(along, reach * Math.sin(angle));
    this.lamp.aim(towards, ball);
    this.lamp.look(this.renderer, this.casters);
    this.alpha.value = 1 / Math.min(this.count + 1, MEMORY);
    this.strength.value = radiance(height) / LEVEL_SKY;
    this.bias.value = 0.012 * ball.radius;
    for (const {target, pass} of this.receivers) {
      this.renderer.setRenderTarget(target);
      this.renderer.autoClear = false;
      pass.render(this.renderer, target);
      this.renderer.autoClear = true;
      this.renderer.setRenderTarget(null);
    }
    this.count++;
  }

  dispose() {
    this.lamp.dispose();
    for (const {target, pass} of this.receivers) target.dispose(), pass.dispose();
  }
}

const radiance = (height) => 0.6 + 0.4 * height;

/** Mean over the lamps of what a level place with a free view receives. */
const LEVEL_SKY = Array.from({length: LAMPS}, (_, k) => 0.06 + 0.94 * (k + 0.5) / LAMPS)
  .reduce((sum, height) => sum + radiance(height) * height, 0) / LAMPS;

const RECEIVE = `
  uniform sampler2D positions, normals;
  uniform sampler2DShadow shadow_map;
  uniform mat4 to_shadow;
  uniform vec3 towards, shift;
  uniform float alpha, strength, bias;
  out vec4 light;

  void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    vec3 n = texelFetch(normals, place, 0).xyz;
    n /= max(length(n), 1e-6);
    vec3 at = texelFetch(positions, place, 0).xyz + shift + bias * n;
    vec3 p = (to_shadow * vec4(at, 1)).xyz * 0.5 + 0.5;
    bool outside = any(lessThan(p.xy, vec2(0))) || any(greaterThan(p.xy, vec2(1)));
    float seen = outside ? 1.0 : texture(shadow_map, vec3(p.xy, min(p.z, 1.0)));
    light = vec4(vec3(strength * seen * max(0.0, dot(n, towards))), alpha);
  }
`;
