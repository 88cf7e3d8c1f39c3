import {ringsOf} from './rings.js';

const CREASE = Math.cos(40 * Math.PI / 180);  // of the angle between triangles beyond which their edge is sharp

/**
 * What is drawn of a surface: its nodes, but those that sharp edges meet as often as there are sides, each with the
 * triangles of its side. So a box keeps its edges, and what is smooth is smooth.
 *
 * @typedef {object} Fans
 * @property {number} count            vertices: first the nodes, then their other sides
 * @property {Uint32Array} nodeOf      node of each vertex
 * @property {Uint32Array} triangles   of vertices
 * @property {import('./rings.js').Rings} rings   around each vertex, of nodes
 */

/**
 * @param {ArrayLike<number>} x        positions at rest, nodes × 3
 * @param {Uint32Array} triangles
 * @param {import('./rings.js').Rings} rings
 * @returns {Fans}
 */
export function fansOf(x, triangles, {starts, pairs, corners}) {
  const normals = normalsOf(x, triangles);
  const smooth = (k, l) => {
    const s = corners[k] - corners[k] % 3, t = corners[l] - corners[l] % 3;
    return normals[s] * normals[t] + normals[s + 1] * normals[t + 1] + normals[s + 2] * normals[t + 2] > CREASE;
  };
  const share = (k, l) => pairs[2 * k] === pairs[2 * l + 1] || pairs[2 * k + 1] === pairs[2 * l];
  const nodes = starts.length - 1, nodeOf = Array.from({length: nodes}, (_, v) => v), drawn = triangles.slice();
  for (let v = 0; v < nodes; ++v) {
    const left = new Set();
    for (let k = starts[v]; k < starts[v + 1]; ++k) left.add(k);
    for (let vertex = v; left.size > 0; vertex = nodeOf.length) {
      const [first] = left, fan = [first];
      left.delete(first);
      for (const k of fan)
        for (const l of left) if (share(k, l) && smooth(k, l)) left.delete(l), fan.push(l);
      if (vertex !== v) nodeOf.push(v);
      for (const k of fan) drawn[corners[k]] = vertex;
    }
  }
  const around = ringsOf(drawn, nodeOf.length);
  around.pairs.forEach((vertex, k) => (around.pairs[k] = nodeOf[vertex]));
  return {count: nodeOf.length, nodeOf: Uint32Array.from(nodeOf), triangles: drawn, rings: around};
}

/** Unit normals, triangles × 3; 0 of what has no area. */
function normalsOf(x, triangles) {
  const normals = new Float32Array(triangles.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ux = x[b] - x[a], uy = x[b + 1] - x[a + 1], uz = x[b + 2] - x[a + 2];
    const vx = x[c] - x[a], vy = x[c + 1] - x[a + 1], vz = x[c + 2] - x[a + 2];
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx, length = Math.hypot(nx, ny, nz) || 1;
    normals[t] = nx / length, normals[t + 1] = ny / length, normals[t + 2] = nz / length;
  }
  return normals;
}
