import {Vector3} from 'three';

/**
 * The light of Supple's own pictures (io/picture/studio), so that the page shows an object as they do: a key light from
 * the upper left, a sky, light that comes back from the ground, a gloss and a rim. The studio turns with the camera, as
 * if the object stood on a turntable.
 */
export class Light {
  constructor() {
    this.uniforms = {
      up: {value: new Vector3(0, 1, 0)},
      key_towards: {value: new Vector3()},
      rim_towards: {value: new Vector3()},
      ground_height: {value: 0},
      scene_radius: {value: 1},
    };
  }

  /** @param {Vector3} right of the camera  @param {Vector3} up of the world */
  turn(right, up) {
    const front = new Vector3().crossVectors(right, up).normalize();
    const {up: above, key_towards, rim_towards} = this.uniforms;
    above.value.copy(up);
    key_towards.value.copy(up).addScaledVector(right, -0.62).addScaledVector(front, 0.62).normalize();
    rim_towards.value.copy(up).multiplyScalar(0.45).addScaledVector(right, 0.75).addScaledVector(front, -0.7).normalize();
  }
}

/** GLSL: colours on the screen from light, surface and view. */
export const SHADING = `
  uniform vec3 up, key_towards, rim_towards;
  uniform float ground_height, scene_radius;

  // The sRGB curve by square roots, within a tenth of a step of 255: powers are dear without a graphics card.
  vec3 to_screen(vec3 c) {
    c = clamp(c, 0.0, 1.0);
    vec3 root = sqrt(c), fourth = sqrt(root);
    return max(vec3(0), 0.941993 * root + 0.262483 * fourth - 0.131760 * root * fourth - 0.072989);
  }

  vec3 shade(vec3 albedo, vec3 at, vec3 n, vec3 to_eye, float sky, float key) {
    float height = max(0.0, dot(up, at) - ground_height);
    float bounce = 0.11 * (1.0 - dot(n, up)) * min(1.0, 0.35 + height / scene_radius);
    float lit = key / max(0.05, dot(n, key_towards));
    float cosine = max(0.0, dot(n, normalize(key_towards + to_eye)));
    float c4 = cosine * cosine * cosine * cosine, c8 = c4 * c4;
    float glint = 0.10 * c4 * c8 * c8 * c8 * min(1.0, lit);
    float slope = 1.0 - clamp(dot(n, to_eye), 0.0, 1.0), grazing = slope * slope * slope;
    float rim = 0.22 * grazing * (0.25 + max(0.0, dot(n, rim_towards))) * min(1.0, 2.0 * sky);
    vec3 c = albedo * (0.92 * key * vec3(1.04, 1.0, 0.94) + 0.62 * sky * vec3(0.94, 0.98, 1.04) + bounce) + glint + rim;
    return c * inversesqrt(sqrt(1.0 + c * c * c * c));
  }
`;

/** Points spread evenly over a disc. */
function discOf(count) {
  return Array.from({length: count}, (_, k) => {
    const r = Math.sqrt((k + 0.5) / count), angle = 2.3999632 * k;
    return `vec2(${(r * Math.cos(angle)).toFixed(6)}, ${(r * Math.sin(angle)).toFixed(6)})`;
  });
}

/** GLSL: what of the key light a shadow map lets through, with edges that are softer the more taps there are. */
export const shadowBy = (taps) => `
  #define SHADOW_TAPS ${taps}
  const vec2 taps[SHADOW_TAPS] = vec2[](${discOf(taps)});
  uniform sampler2DShadow shadow_map;
  uniform mat4 to_shadow;

  float unshadowed(vec3 at, float spread) {
    vec3 p = (to_shadow * vec4(at, 1)).xyz * 0.5 + 0.5;
    p.z = min(p.z, 1.0);  // behind the map's far plane lies what is in the shadow of all it shows
    float sum = 0.0;
    for (int k = 0; k < SHADOW_TAPS; ++k) {
      vec2 tap = p.xy + spread * taps[k];
      bool outside = any(lessThan(tap, vec2(0))) || any(greaterThan(tap, vec2(1)));
      sum += outside ? 1.0 : texture(shadow_map, vec3(tap, p.z));
    }
    return sum / float(SHADOW_TAPS);
  }
`;
