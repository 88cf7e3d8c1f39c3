/**
 * Packs rows of the basis for texture arrays whose texels are vertices and whose layers hold four fields each: with block
 * 3 a layer is four fields of W; with block 1 three layers in turn are four fields of the rows x, y and z. Neighbouring
 * fragments then read neighbouring texels of one layer.
 *
 * @typedef {object} Chunk
 * @property {number} first        group of four fields that it begins with
 * @property {number} groups       of four fields
 * @property {Float32Array} data   layers × texels × 4
 * @property {number} layers
 */

/** At most so many groups in a chunk: three vec4 of uniforms each stay below the 224 that every WebGL 2 has. */
export const MOST_GROUPS = 64;

/**
 * @param {import('../session/model.js').Model} model
 * @param {ArrayLike<number>} nodeOf   of each vertex
 * @param {import('./vertex_grid.js').VertexGrid} grid
 * @param {{layers: number, bytes: number}} limits   of one texture array
 * @returns {Generator<Chunk>}
 */
export function* packBasis({about: {block, fields}, basis}, nodeOf, grid, limits) {
  const layersOfGroup = block === 3 ? 1 : 3;
  const bytesOfGroup = 16 * grid.texels * layersOfGroup;
  const groups = Math.ceil(fields / 4);
  const inOne = Math.max(1, Math.min(MOST_GROUPS, Math.floor(limits.layers / layersOfGroup),
    Math.floor(limits.bytes / bytesOfGroup)));
  for (let first = 0; first < groups; first += inOne) {
    const count = Math.min(inOne, groups - first);
    const data = new Float32Array(count * layersOfGroup * grid.texels * 4);
    for (let g = 0; g < count; ++g)
      for (let part = 0; part < layersOfGroup; ++part) {
        const layer = (g * layersOfGroup + part) * grid.texels * 4;
        const field = 4 * (first + g), lanes = Math.min(4, fields - field);
        for (let v = 0; v < nodeOf.length; ++v) {
          const row = (nodeOf[v] * layersOfGroup + part) * fields + field;
          for (let lane = 0; lane < lanes; ++lane) data[layer + 4 * v + lane] = basis[row + lane];
        }
      }
    yield {first, groups: count, data, layers: count * layersOfGroup};
  }
}

/**
 * Packs q for a chunk, padded by zeros: with block 3 three vec4 a group, the x, y and z of its four fields; with block
 * 1 one vec4 a group.
 * @returns {Float32Array} `out`
 */
export function packCoordinates({block, fields}, {first, groups}, q, out) {
  out.fill(0);
  for (let g = 0; g < groups; ++g)
    for (let lane = 0; lane < 4; ++lane) {
      const field = 4 * (first + g) + lane;
      if (field >= fields) return out;
      if (block === 3)
        for (let axis = 0; axis < 3; ++axis) out[12 * g + 4 * axis + lane] = q[3 * field + axis];
      else
        out[4 * g + lane] = q[field];
    }
  return out;
}
