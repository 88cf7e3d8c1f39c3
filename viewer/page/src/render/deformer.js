import {
  DataArrayTexture, DataTexture, FloatType, NearestFilter, RGBAFormat, RGIntegerFormat, UnsignedIntType,
  WebGLRenderTarget,
} from 'three';
import {packBasis, packCoordinates} from './basis_packing.js';
import {gridOf, TEXEL_OF_VERTEX} from './vertex_grid.js';
import {PixelPass} from './pixel_pass.js';

const LARGEST_TEXTURE = 256 * 2 ** 20;  // bytes; drivers refuse larger ones long before they run out of memory
const COLUMNS_OF_PAIRS = 2048;          // every WebGL 2 has textures so wide

/**
 * Positions, normals and strains of all vertices as textures, computed on the graphics card from reduced coordinates:
 * first x = X + U q, then the rest from the triangles around each vertex. What travels in a frame is q alone. The
 * README counts bytes and fetches.
 *
 * `normals` has the strain of the surface as its fourth number (geometry/strain.js), where `strained` asks for it.
 */
export class Deformer {
  /**
   * @param {import('three').WebGLRenderer} renderer
   * @param {import('../geometry/shape.js').Shape} shape
   */
  constructor(renderer, shape) {
    this.renderer = renderer;
    this.shape = shape;
    this.strained = false;
    this.grid = gridOf(shape.fans.count);
    this.rest = this.#texture();
    this.#fill(this.rest, shape.model.rest);
    this.computes = Deformer.#canCompute(renderer);
    if (this.computes) this.#prepareNormals();
  }

  /** Whether shaders can write floats; otherwise the processor deforms, and textures are uploaded in each frame. */
  static #canCompute(renderer) {
    return renderer.extensions.has('EXT_color_buffer_float');
  }

  /** Takes over what the shape has taken. */
  update() {
    if (this.computes && !this.shape.displacements) this.#computePositions();
    else this.#uploadPositions();
    if (this.computes) this.#computeNormals();
    else this.#uploadNormals();
  }

  /** Positions as the graphics card has them, nodes × 3: slow, for tests. */
  readPositions() {
    return this.#read(this.positions, this.positionTarget, 3);
  }

  /** Strains as the graphics card has them, one a node: slow, for tests. */
  readStrains() {
    const all = this.#read(this.normals, this.normalTarget, 4);
    return all.filter((_, i) => i % 4 === 3);
  }

  dispose() {
    for (const thing of [this.rest, this.positionTarget, this.otherTarget, this.normalTarget, this.uploadedPositions,
      this.uploadedNormals, this.rings, this.pairs, this.normalPass, ...(this.chunks ?? []).flatMap((c) => [c.texture, c.pass])])
      thing?.dispose();
  }

  #target() {
    return new WebGLRenderTarget(this.grid.columns, this.grid.rows, {
      type: FloatType, format: RGBAFormat, minFilter: NearestFilter, magFilter: NearestFilter, depthBuffer: false,
    });
  }

  #prepareBasis() {
    const {model, fans} = this.shape;
    const {columns, rows} = this.grid;
    const gl = this.renderer.getContext();
    const limits = {layers: gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS), bytes: LARGEST_TEXTURE};
    this.chunks = [...packBasis(model, fans.nodeOf, this.grid, limits)].map((chunk) => {
      const texture = new DataArrayTexture(chunk.data, columns, rows, chunk.layers);
      texture.type = FloatType;
      texture.needsUpdate = true;
      const vectors = (model.about.block === 3 ? 3 : 1) * chunk.groups;
      const uniforms = {
        base: {value: null}, basis: {value: texture}, q: {value: new Float32Array(4 * vectors)},
      };
      const defines = {BLOCK: model.about.block, GROUPS: chunk.groups, VECTORS: vectors};
      return {...chunk, data: null, texture, pass: new PixelPass(DISPLACE, uniforms, {defines})};
    });
    this.positionTarget = this.#target();
    this.otherTarget = this.chunks.length > 1 ? this.#target() : null;
  }

  #prepareNormals() {
    const {starts, pairs} = this.shape.fans.rings, {columns, rows, texels} = this.grid;
    const texture = (data, width, height) => {
      const made = new DataTexture(data, width, height, RGIntegerFormat, UnsignedIntType);
      made.internalFormat = 'RG32UI';
      made.needsUpdate = true;
      return made;
    };
    const ranges = new Uint32Array(2 * texels);
    for (let v = 0; v + 1 < starts.length; ++v) ranges[2 * v] = starts[v], ranges[2 * v + 1] = starts[v + 1];
    const rowsOfPairs = Math.max(1, Math.ceil(pairs.length / 2 / COLUMNS_OF_PAIRS));
    const padded = new Uint32Array(2 * COLUMNS_OF_PAIRS * rowsOfPairs);
    padded.set(pairs);
    this.rings = texture(ranges, columns, rows);
    this.pairs = texture(padded, COLUMNS_OF_PAIRS, rowsOfPairs);
    this.normalTarget = this.#target();
    this.normalPass = new PixelPass(NORMALS, {
      columns: {value: columns}, positions: {value: null}, rest: {value: this.rest}, rings: {value: this.rings},
      pairs: {value: this.pairs}, strained: {value: false},
    });
  }

  #computePositions() {
    if (!this.chunks) this.#prepareBasis();
    let base = this.rest;
    // The last chunk has to land in positionTarget, since materials hold its texture.
    for (let k = 0; k < this.chunks.length; ++k) {
      const {pass} = this.chunks[k];
      const target = (this.chunks.length - k) % 2 ? this.positionTarget : this.otherTarget;
      pass.uniforms.base.value = base;
      packCoordinates(this.shape.model.about, this.chunks[k], this.shape.q, pass.uniforms.q.value);
      pass.render(this.renderer, target);
      base = target.texture;
    }
    this.positions = this.positionTarget.texture;
  }

  #computeNormals() {
    const {positions, strained} = this.normalPass.uniforms;
    positions.value = this.positions;
    strained.value = this.strained;
    this.normalPass.render(this.renderer, this.normalTarget);
    this.normals = this.normalTarget.texture;
  }

  #uploadPositions() {
    this.positions = this.uploadedPositions ??= this.#texture();
    this.#fill(this.positions, this.shape.positions());
  }

  #uploadNormals() {
    this.normals = this.uploadedNormals ??= this.#texture();
    const normals = this.shape.normals(), strains = this.strained ? this.shape.strains() : null;
    const texels = this.normals.image.data;
    for (let v = 0; v < this.shape.fans.count; ++v) {
      for (let axis = 0; axis < 3; ++axis) texels[4 * v + axis] = normals[3 * v + axis];
      texels[4 * v + 3] = strains?.[v] ?? 0;
    }
    this.normals.needsUpdate = true;
  }

  #texture() {
    return new DataTexture(new Float32Array(4 * this.grid.texels), this.grid.columns, this.grid.rows, RGBAFormat, FloatType);
  }

  /** Gives each vertex of a texture the position of its node. */
  #fill(texture, x) {
    const {nodeOf} = this.shape.fans, texels = texture.image.data;
    for (let v = 0; v < nodeOf.length; ++v)
      for (let axis = 0; axis < 3; ++axis) texels[4 * v + axis] = x[3 * nodeOf[v] + axis];
    texture.needsUpdate = true;
  }

  /** The first numbers of each node's texel. */
  #read(texture, target, numbers) {
    const {columns, rows} = this.grid, {nodes} = this.shape.model.about;
    const uploaded = texture.isDataTexture, texels = uploaded ? texture.image.data : new Float32Array(4 * columns * rows);
    if (!uploaded) this.renderer.readRenderTargetPixels(target, 0, 0, columns, rows, texels);
    return Float32Array.from({length: numbers * nodes}, (_, i) => texels[4 * Math.floor(i / numbers) + i % numbers]);
  }
}

const DISPLACE = `
  uniform sampler2D base;
  uniform sampler2DArray basis;
  uniform vec4 q[VECTORS];
  out vec4 position;

  void main() {
    ivec2 node = ivec2(gl_FragCoord.xy);
    vec3 u = vec3(0);
    for (int g = 0; g < GROUPS; ++g) {
  #if BLOCK == 3
      vec4 w = texelFetch(basis, ivec3(node, g), 0);
      u += vec3(dot(w, q[3 * g]), dot(w, q[3 * g + 1]), dot(w, q[3 * g + 2]));
  #else
      u += vec3(dot(texelFetch(basis, ivec3(node, 3 * g), 0), q[g]),
                dot(texelFetch(basis, ivec3(node, 3 * g + 1), 0), q[g]),
                dot(texelFetch(basis, ivec3(node, 3 * g + 2), 0), q[g]));
  #endif
    }
    vec4 from = texelFetch(base, node, 0);
    position = vec4(from.xyz + u, from.w);
  }
`;

const NORMALS = `
  uniform sampler2D positions, rest;
  uniform usampler2D rings, pairs;
  uniform bool strained;
  ${TEXEL_OF_VERTEX}
  out vec4 normal;

  // λ − 1 of the principal stretch that is farthest from 1: see geometry/strain.js.
  float farthest(mat3 twice_e) {
    float trace = twice_e[0].x + twice_e[1].y + twice_e[2].z;
    float squares = dot(twice_e[0], twice_e[0]) + dot(twice_e[1], twice_e[1]) + dot(twice_e[2], twice_e[2]);
    float radius = 0.5 * sqrt(max(0.0, 2.0 * squares - trace * trace));
    vec2 strain = sqrt(max(vec2(0), 1.0 + 0.5 * trace + vec2(radius, -radius))) - 1.0;
    return strain.x > -strain.y ? strain.x : strain.y;
  }

  void main() {
    ivec2 vertex = ivec2(gl_FragCoord.xy);
    vec3 at = texelFetch(positions, vertex, 0).xyz, from = strained ? texelFetch(rest, vertex, 0).xyz : vec3(0), sum = vec3(0);
    uvec2 range = texelFetch(rings, vertex, 0).xy;
    mat3 twice_e = mat3(0);
    float area = 0.0;
    for (uint k = range.x; k < range.y; ++k) {
      ivec2 others = ivec2(texelFetch(pairs, ivec2(k % ${COLUMNS_OF_PAIRS}u, k / ${COLUMNS_OF_PAIRS}u), 0).xy);
      vec3 b = texelFetch(positions, texel_of(others.x), 0).xyz - at;
      vec3 c = texelFetch(positions, texel_of(others.y), 0).xyz - at;
      sum += cross(b, c);
      if (!strained) continue;
      vec3 B = texelFetch(rest, texel_of(others.x), 0).xyz - from;
      vec3 C = texelFetch(rest, texel_of(others.y), 0).xyz - from;
      vec3 N = cross(B, C), dual_b = cross(C, N), dual_c = cross(N, B);
      float squared = dot(N, N), scale = squared > 0.0 ? pow(squared, -1.5) : 0.0;
      mat3 mixed = outerProduct(dual_b, dual_c);
      twice_e += scale * (dot(b, b) - dot(B, B)) * outerProduct(dual_b, dual_b)
               + scale * (dot(c, c) - dot(C, C)) * outerProduct(dual_c, dual_c)
               + scale * (dot(b, c) - dot(B, C)) * (mixed + transpose(mixed));
      area += sqrt(squared);
    }
    float twice = length(sum);
    normal = vec4(twice > 0.0 ? sum / twice : vec3(0), area > 0.0 ? farthest(twice_e / area) : 0.0);
  }
`;
