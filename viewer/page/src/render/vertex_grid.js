/**
 * Nodes as texels: node v is the texel (v mod columns, v div columns) of every texture that holds something of nodes.
 *
 * @typedef {{columns: number, rows: number, texels: number}} NodeGrid
 */

/** @returns {NodeGrid} about square, so that no limit on the size of textures is met below millions of nodes */
export function gridOf(nodes) {
  const columns = 2 ** Math.ceil(Math.log2(Math.max(1, nodes)) / 2);
  const rows = Math.max(1, Math.ceil(nodes / columns));
  return {columns, rows, texels: columns * rows};
}

/** GLSL: the texel of a node. */
export const TEXEL_OF_NODE = `
  uniform int columns;
  ivec2 texel_of(int node) { return ivec2(node % columns, node / columns); }
`;
