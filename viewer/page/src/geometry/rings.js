/**
 * The one-ring of each node: for each triangle around it, the other two corners in the triangle's order, so that
 * (b − v) × (c − v) is twice the triangle's area along its normal.
 *
 * @typedef {object} Rings
 * @property {Uint32Array} starts   of node v's ring, among triangles: starts[v] … starts[v + 1]
 * @property {Uint32Array} pairs    two nodes a triangle
 * @property {Uint32Array} corners  where in `triangles` the node stands, one a triangle
 */

/**
 * @param {Uint32Array} triangles
 * @param {number} nodes
 * @returns {Rings}
 */
export function ringsOf(triangles, nodes) {
  const starts = new Uint32Array(nodes + 1);
  for (const v of triangles) starts[v + 1]++;
  for (let v = 0; v < nodes; ++v) starts[v + 1] += starts[v];
  const next = starts.slice(0, nodes);
  const pairs = new Uint32Array(2 * triangles.length), corners = new Uint32Array(triangles.length);
  for (let t = 0; t < triangles.length; t += 3)
    for (let corner = 0; corner < 3; ++corner) {
      const at = next[triangles[t + corner]]++;
      pairs[2 * at] = triangles[t + (corner + 1) % 3];
      pairs[2 * at + 1] = triangles[t + (corner + 2) % 3];
      corners[at] = t + corner;
    }
  return {starts, pairs, corners};
}

/** Each edge once, as pairs of nodes. */
export function edgesOf({starts, pairs}) {
  const edges = [];
  const seen = new Set();
  for (let v = 0; v + 1 < starts.length; ++v) {
    seen.clear();
    for (let k = 2 * starts[v]; k < 2 * starts[v + 1]; ++k) {
      const w = pairs[k];
      if (v < w && !seen.has(w)) seen.add(w), edges.push(v, w);
    }
  }
  return Uint32Array.from(edges);
}
