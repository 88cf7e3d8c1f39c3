import {
  DataArrayTexture, DataTexture, FloatType, NearestFilter, RGBAFormat, RGIntegerFormat, UnsignedIntType,
  WebGLRenderTarget,
} from 'three';
import {packBasis, packCoordinates} from './basis_packing.js';
import {gridOf, TEXEL_OF_NODE} from './node_grid.js';
import {PixelPass} from './pixel_pass.js';

const LARGEST_TEXTURE = 256 * 2 ** 20;  // bytes; drivers refuse larger ones long before they run out of memory
const COLUMNS_OF_PAIRS = 2048;          // every WebGL 2 has textures so wide

/**
 * Positions and normals of all nodes as textures, computed on the graphics card from reduced coordinates: first
 * x = X + U q, then normals from the one-ring, weighted by area. What travels in a frame is q alone. The README of this
 * folder counts bytes and fetches.
 *
 * `positions` has the area around a node at rest as its fourth number, `normals` by what the surface is stretched there
 * (√ area over area at rest, less 1). Normals are 1 long where the surface is flat, and shorter the sharper its crease.
 */
export class Deformer {
  /**
   * @param {import('three').WebGLRenderer} renderer
   * @param {import('../geometry/shape.js').Shape} shape
   */
  constructor(renderer, shape) {
    this.renderer = renderer;
    this.shape = shape;
    const {model} = shape;
    this.grid = gridOf(model.about.nodes);
    this.restAreas = areasOf(model.rest, model.triangles);
    this.rest = this.#texture(this.#restTexels());
    this.computes = Deformer.#canCompute(renderer);
    if (this.computes) this.#preparePasses();
    else this.#prepareUploads();
  }

  /** Whether shaders can write floats; otherwise the processor deforms, and textures are uploaded in each frame. */
  static #canCompute(renderer) {
    return renderer.extensions.has('EXT_color_buffer_float');
  }

  /** Takes over what the shape has taken. */
  update() {
    if (this.computes && !this.shape.displacements) this.#compute();
    else this.#upload();
  }

  /** Positions as the graphics card has them, nodes × 3: slow, for tests. */
  readPositions() {
    const {columns, rows} = this.grid, {nodes} = this.shape.model.about;
    const uploaded = this.positions === this.uploadedPositions;
    const texels = uploaded ? this.positions.image.data : new Float32Array(4 * columns * rows);
    if (!uploaded)
      this.renderer.readRenderTargetPixels(this.positionTarget, 0, 0, columns, rows, texels);
    return Float32Array.from({length: 3 * nodes}, (_, i) => texels[4 * Math.floor(i / 3) + i % 3]);
  }

  dispose() {
    for (const thing of [this.rest, this.positionTarget, this.otherTarget, this.normalTarget, this.uploadedPositions,
      this.uploadedNormals, this.rings, this.pairs, this.normalPass, ...(this.chunks ?? []).flatMap((c) => [c.texture, c.pass])])
      thing?.dispose();
  }

  #preparePasses() {
    const {model} = this.shape;
    const {columns, rows} = this.grid;
    const gl = this.renderer.getContext();
    const limits = {layers: gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS), bytes: LARGEST_TEXTURE};
    const target = () => new WebGLRenderTarget(columns, rows, {
      type: FloatType, format: RGBAFormat, minFilter: NearestFilter, magFilter: NearestFilter, depthBuffer: false,
    });
    this.chunks = [...packBasis(model, this.grid, limits)].map((chunk) => {
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
    this.positionTarget = target();
    this.otherTarget = this.chunks.length > 1 ? target() : null;
    this.normalTarget = target();
    this.#prepareRings();
    this.normalPass = new PixelPass(NORMALS, {
      columns: {value: columns}, positions: {value: null}, rings: {value: this.rings}, pairs: {value: this.pairs},
    });
  }

  #prepareRings() {
    const {starts, pairs} = this.shape.rings;
    const texture = (data, columns, rows) => {
      const made = new DataTexture(data, columns, rows, RGIntegerFormat, UnsignedIntType);
      made.internalFormat = 'RG32UI';
      made.needsUpdate = true;
      return made;
    };
    const ranges = new Uint32Array(2 * this.grid.texels);
    for (let v = 0; v + 1 < starts.length; ++v) ranges[2 * v] = starts[v], ranges[2 * v + 1] = starts[v + 1];
    const rows = Math.max(1, Math.ceil(pairs.length / 2 / COLUMNS_OF_PAIRS));
    const padded = new Uint32Array(2 * COLUMNS_OF_PAIRS * rows);
    padded.set(pairs);
    this.rings = texture(ranges, this.grid.columns, this.grid.rows);
    this.pairs = texture(padded, COLUMNS_OF_PAIRS, rows);
  }

  #compute() {
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
    this.#computeNormals();
  }

  #computeNormals() {
    this.normalPass.uniforms.positions.value = this.positions;
    this.normalPass.render(this.renderer, this.normalTarget);
    this.normals = this.normalTarget.texture;
  }

  #prepareUploads() {
    this.uploadedPositions ??= this.#texture(new Float32Array(4 * this.grid.texels));
    if (!this.computes) this.uploadedNormals ??= this.#texture(new Float32Array(4 * this.grid.texels));
  }

  #upload() {
    this.#prepareUploads();
    const x = this.shape.positions(), {nodes} = this.shape.model.about;
    const texels = this.uploadedPositions.image.data;
    for (let v = 0; v < nodes; ++v) {
      texels[4 * v] = x[3 * v], texels[4 * v + 1] = x[3 * v + 1], texels[4 * v + 2] = x[3 * v + 2];
      texels[4 * v + 3] = this.restAreas[v];
    }
    this.uploadedPositions.needsUpdate = true;
    this.positions = this.uploadedPositions;
    if (this.computes) return this.#computeNormals();
    const normals = this.shape.normals(), areas = areasOf(x, this.shape.model.triangles), packed = this.uploadedNormals.image.data;
    for (let v = 0; v < nodes; ++v) {
      packed.set(normals.subarray(3 * v, 3 * v + 3), 4 * v);
      packed[4 * v + 3] = Math.sqrt(areas[v] / (this.restAreas[v] || 1)) - 1;
    }
    this.uploadedNormals.needsUpdate = true;
    this.normals = this.uploadedNormals;
  }

  #restTexels() {
    const {rest, about: {nodes}} = this.shape.model;
    const texels = new Float32Array(4 * this.grid.texels);
    for (let v = 0; v < nodes; ++v) {
      texels.set(rest.subarray(3 * v, 3 * v + 3), 4 * v);
      texels[4 * v + 3] = this.restAreas[v];
    }
    return texels;
  }

  #texture(texels) {
    const texture = new DataTexture(texels, this.grid.columns, this.grid.rows, RGBAFormat, FloatType);
    texture.needsUpdate = true;
    return texture;
  }
}

/** Twice the area of the triangles around each node. */
function areasOf(x, triangles) {
  const areas = new Float32Array(x.length / 3);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ux = x[b] - x[a], uy = x[b + 1] - x[a + 1], uz = x[b + 2] - x[a + 2];
    const vx = x[c] - x[a], vy = x[c + 1] - x[a + 1], vz = x[c + 2] - x[a + 2];
    const area = Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
    for (let corner = 0; corner < 3; ++corner) areas[triangles[t + corner]] += area;
  }
  return areas;
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
  uniform sampler2D positions;
  uniform usampler2D rings, pairs;
  ${TEXEL_OF_NODE}
  out vec4 normal;

  void main() {
    ivec2 node = ivec2(gl_FragCoord.xy);
    vec4 at = texelFetch(positions, node, 0);
    uvec2 range = texelFetch(rings, node, 0).xy;
    vec3 sum = vec3(0);
    float area = 0.0;
    for (uint k = range.x; k < range.y; ++k) {
      ivec2 others = ivec2(texelFetch(pairs, ivec2(k % ${COLUMNS_OF_PAIRS}u, k / ${COLUMNS_OF_PAIRS}u), 0).xy);
      vec3 turn = cross(texelFetch(positions, texel_of(others.x), 0).xyz - at.xyz,
                        texelFetch(positions, texel_of(others.y), 0).xyz - at.xyz);
      sum += turn;
      area += length(turn);
    }
    normal = vec4(area > 0.0 ? sum / area : vec3(0), at.w > 0.0 ? sqrt(area / at.w) - 1.0 : 0.0);
  }
`;
