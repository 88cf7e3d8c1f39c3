/**
 * Strain of a surface around each vertex: λ − 1 of the principal stretch λ that is farthest from 1, so that 0.1 is ten
 * per cent longer and −0.1 as much shorter. λ² are the principal values of 1 + 2E, where E is Green's strain of the
 * triangles around the vertex, their mean by area at rest. The same as the shader of render/deformer.js.
 *
 * @param {ArrayLike<number>} rest   positions at rest, nodes × 3
 * @param {ArrayLike<number>} x      positions
 * @param {import('./fans.js').Fans} fans
 * @returns {Float32Array}           a number a vertex
 */
export function strainsOf(rest, x, {count, nodeOf, rings: {starts, pairs}}) {
  const strains = new Float32Array(count);
  for (let vertex = 0; vertex < count; ++vertex) {
    const twiceE = new Float64Array(6);  // xx yy zz xy yz zx
    let area = 0;
    for (let k = starts[vertex]; k < starts[vertex + 1]; ++k)
      area += addTriangle(twiceE, rest, x, nodeOf[vertex], pairs[2 * k], pairs[2 * k + 1]);
    if (area > 0) strains[vertex] = farthest(twiceE.map((sum) => sum / area));
  }
  return strains;
}

/** Adds 2E of a triangle, times twice its area at rest, which it returns. */
function addTriangle(sum, rest, x, v, b, c) {
  const B = between(rest, v, b), C = between(rest, v, c), N = cross(B, C), squared = dot(N, N);
  if (squared === 0) return 0;
  const bNow = between(x, v, b), cNow = between(x, v, c);
  const dualB = cross(C, N), dualC = cross(N, B), scale = squared ** -1.5;
  const bb = scale * (dot(bNow, bNow) - dot(B, B));
  const cc = scale * (dot(cNow, cNow) - dot(C, C));
  const bc = scale * (dot(bNow, cNow) - dot(B, C));
  for (let k = 0; k < 6; ++k) {
    const i = k % 3, j = k < 3 ? i : (i + 1) % 3;
    sum[k] += bb * dualB[i] * dualB[j] + cc * dualC[i] * dualC[j] + bc * (dualB[i] * dualC[j] + dualC[i] * dualB[j]);
  }
  return Math.sqrt(squared);
}

/** Of a tensor with one principal value near 0, across the surface. */
function farthest([xx, yy, zz, xy, yz, zx]) {
  const trace = xx + yy + zz, squares = xx * xx + yy * yy + zz * zz + 2 * (xy * xy + yz * yz + zx * zx);
  const radius = Math.sqrt(Math.max(0, 2 * squares - trace * trace)) / 2;
  const [long, short] = [radius, -radius].map((r) => Math.sqrt(Math.max(0, 1 + trace / 2 + r)) - 1);
  return long > -short ? long : short;
}

const between = (x, v, w) => [x[3 * w] - x[3 * v], x[3 * w + 1] - x[3 * v + 1], x[3 * w + 2] - x[3 * v + 2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
