/**
 * Vertices as texels: vertex v is the texel (v mod columns, v div columns) of every texture that holds something of
 * vertices. The first are the nodes.
 *
 * @typedef {{columns: number, rows: number, texels: number}} VertexGrid
 */

/** @returns {VertexGrid} about square, so that no limit on the size of textures is met below millions of vertices */
export function gridOf(vertices) {
  const columns = 2 ** Math.ceil(Math.log2(Math.max(1, vertices)) / 2);
  const rows = Math.max(1, Math.ceil(vertices / columns));
  return {columns, rows, texels: columns * rows};
}

/** GLSL: the texel of a vertex. */
export const TEXEL_OF_VERTEX = `
  uniform int columns;
  ivec2 texel_of(int vertex) { return ivec2(vertex % columns, vertex / columns); }
`;
