import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, FrontSide, GLSL3, LineSegments, Mesh, RawShaderMaterial, Vector3,
} from 'three';
import {edgesOf} from '../geometry/rings.js';
import {colourTexture} from './colour_maps.js';
import {PRECISION} from './pixel_pass.js';
import {TEXEL_OF_VERTEX} from './vertex_grid.js';
import {SHADING, shadowBy} from './shading.js';

/** What the surface's colour says. */
export const COLOURS = {
  plain: 0,
  displacement: 1,  // |x − X| [m]
  strain: 2,        // λ − 1 of the surface's principal stretch that is farthest from 1
  error: 3,         // |x − x of the other recording| [m]
};

/** The surface as it is drawn: its vertices are texels that a Deformer fills. */
export class Body {
  /**
   * @param {import('./deformer.js').Deformer} deformer
   * @param {object} light   uniforms of the light, the shadows and the sky
   */
  constructor(deformer, light) {
    this.deformer = deformer;
    const {model, fans} = deformer.shape;
    this.tint = new BufferAttribute(new Uint8Array(4 * fans.count), 4, true);
    this.geometry = new BufferGeometry();
    this.geometry.setIndex(new BufferAttribute(fans.triangles, 1));
    this.geometry.setAttribute('tint', this.tint);
    const side = model.about.solid ? FrontSide : DoubleSide;
    const places = {
      columns: {value: deformer.grid.columns},
      positions: {value: null}, normals: {value: null}, rest: {value: deformer.rest}, other: {value: null},
      shift: {value: new Vector3()},
    };
    this.uniforms = {
      ...places, ...light,
      colours: {value: COLOURS.plain}, range: {value: 1}, colour_map: {value: colourTexture()},
      albedo: {value: new Color()}, ghost: {value: 0}, sheet: {value: model.about.solid ? 0 : 1},
    };
    this.material = new RawShaderMaterial({
      glslVersion: GLSL3, side, uniforms: this.uniforms,
      vertexShader: PRECISION + VERTEX, fragmentShader: PRECISION + FRAGMENT,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    });
    this.mesh = new Mesh(this.geometry, this.material);
    this.mesh.frustumCulled = false;

    this.lineColour = {value: new Color()};
    this.lineMaterial = new RawShaderMaterial({
      glslVersion: GLSL3, uniforms: {...places, colour: this.lineColour}, transparent: true,
      vertexShader: PRECISION + PLAIN_VERTEX, fragmentShader: PRECISION + LINE_FRAGMENT,
    });
    this.casterMaterial = new RawShaderMaterial({
      glslVersion: GLSL3, side, uniforms: places, colorWrite: false,
      vertexShader: PRECISION + PLAIN_VERTEX, fragmentShader: PRECISION + 'void main() {}',
    });
    this.caster = new Mesh(this.geometry, this.casterMaterial);
    this.caster.frustumCulled = false;

    // Of a ghost only the nearest layer is seen: the depths of this veil hide those behind.
    this.veilMaterial = this.casterMaterial.clone();
    Object.assign(this.veilMaterial, {uniforms: places, transparent: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1});
    this.veil = new Mesh(this.geometry, this.veilMaterial);
    this.veil.frustumCulled = false;
    this.veil.renderOrder = 1;
    this.veil.visible = false;
    this.mesh.renderOrder = 2;
    this.mesh.add(this.veil);
  }

  get shape() {
    return this.deformer.shape;
  }

  /** Where the object is drawn, from where it is. */
  get shift() {
    return this.uniforms.shift.value;
  }

  update() {
    this.deformer.update();
    this.uniforms.positions.value = this.deformer.positions;
    this.uniforms.normals.value = this.deformer.normals;
  }

  /** @param {keyof COLOURS} colours  @param {number} range  value of the last colour */
  show(colours, range) {
    const strained = colours === 'strain', comes = strained && !this.deformer.strained;
    this.deformer.strained = strained;
    if (comes) this.update();
    this.uniforms.colours.value = COLOURS[colours];
    this.uniforms.range.value = range;
  }

  /** Lets what is inside, or another body in the same place, shimmer through. */
  set ghost(on) {
    this.uniforms.ghost.value = on ? 1 : 0;
    this.material.transparent = on;
    for (const material of [this.material, this.veilMaterial]) material.polygonOffsetFactor = material.polygonOffsetUnits = on ? 4 : 1;
    this.veil.visible = on;
  }

  set wireframe(on) {
    if (on && !this.lines) {
      const geometry = new BufferGeometry();
      geometry.setIndex(new BufferAttribute(edgesOf(this.shape.rings), 1));
      geometry.setAttribute('tint', this.tint);
      this.lines = new LineSegments(geometry, this.lineMaterial);
      this.lines.frustumCulled = false;
      this.mesh.add(this.lines);
    }
    if (this.lines) this.lines.visible = on;
  }

  /** @param {Iterable<[Iterable<number>, number[]]>} regions  nodes, and red, green and blue, each 0 … 255 */
  paint(regions) {
    const tint = this.tint.array.fill(0), {nodeOf} = this.shape.fans;
    for (const [nodes, colour] of regions) for (const v of nodes) tint.set([...colour, 255], 4 * v);
    for (let v = this.shape.model.about.nodes; v < nodeOf.length; ++v)
      tint.copyWithin(4 * v, 4 * nodeOf[v], 4 * nodeOf[v] + 4);
    this.tint.needsUpdate = true;
  }

  dispose() {
    this.geometry.dispose();
    this.lines?.geometry.dispose();
    this.uniforms.colour_map.value.dispose();
    for (const material of [this.material, this.lineMaterial, this.casterMaterial, this.veilMaterial]) material.dispose();
  }
}

const PLAIN_VERTEX = `
  uniform mat4 modelViewMatrix, projectionMatrix;
  uniform sampler2D positions;
  uniform vec3 shift;
  ${TEXEL_OF_VERTEX}
  void main() {
    vec3 at = texelFetch(positions, texel_of(gl_VertexID), 0).xyz + shift;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(at, 1);
  }
`;

const LINE_FRAGMENT = `
  uniform vec3 colour;
  out vec4 pixel;
  void main() { pixel = vec4(colour, 0.35); }
`;

const VERTEX = `
  uniform mat4 modelViewMatrix, projectionMatrix;
  uniform sampler2D positions, normals, rest, other, sky_light;
  uniform vec3 shift;
  uniform int colours;
  uniform float range;
  ${TEXEL_OF_VERTEX}
  in vec4 tint;
  out vec3 at, normal;
  out vec4 painted;
  out float sky, share;

  void main() {
    ivec2 texel = texel_of(gl_VertexID);
    at = texelFetch(positions, texel, 0).xyz;
    vec4 n = texelFetch(normals, texel, 0);
    normal = n.xyz;
    sky = texelFetch(sky_light, texel, 0).r;
    painted = vec4(tint.rgb * tint.rgb * tint.a, tint.a);
    share = colours == ${COLOURS.displacement} ? distance(at, texelFetch(rest, texel, 0).xyz) / range
          : colours == ${COLOURS.error} ? distance(at, texelFetch(other, texel, 0).xyz) / range
          : colours == ${COLOURS.strain} ? 0.5 + 0.5 * n.w / range : 0.0;
    at += shift;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(at, 1);
  }
`;

const FRAGMENT = `
  uniform vec3 cameraPosition, albedo;
  uniform sampler2D colour_map;
  uniform int colours;
  uniform float ghost, sheet;
  const float PAINT = 0.88;  // of a region's colour
  ${SHADING}
  ${shadowBy(8)}
  in vec3 at, normal;
  in vec4 painted;
  in float sky, share;
  out vec4 pixel;

  void main() {
    vec3 to_eye = normalize(cameraPosition - at);
    vec3 n = normalize(normal);
    // A normal that turns away belongs to the other side of a sheet, or was smoothed around the edge of what is seen.
    float facing = dot(n, to_eye);
    if (facing < -0.25 || (sheet > 0.5 && !gl_FrontFacing && facing < 0.0)) n = -n;
    facing = dot(n, to_eye);
    if (facing < 0.0) n = normalize(n - facing * to_eye);

    vec3 colour = albedo;
    if (colours != 0) {
      vec3 root = texture(colour_map, vec2((share * 255.0 + 0.5) / 256.0, colours == ${COLOURS.strain} ? 0.75 : 0.25)).rgb;
      colour = root * root;
    }
    // Regions end halfway to the next node, with a sharp edge: what fades would look like a shadow.
    float width = 0.75 * fwidth(painted.a);
    colour = mix(colour, painted.rgb / max(painted.a, 1e-3), PAINT * smoothstep(0.5 - width, 0.5 + width, painted.a));
    float cosine = dot(n, key_towards);
    float key = cosine > 0.0 ? cosine * unshadowed(at + 0.012 * scene_radius * n, 0.008) : 0.0;
    float alpha = ghost > 0.5 ? mix(0.30, 0.95, pow(1.0 - abs(dot(n, to_eye)), 1.5)) : 1.0;
    pixel = vec4(to_screen(shade(colour, at, n, to_eye, sky, key)), alpha);
  }
`;
