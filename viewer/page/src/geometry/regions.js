/**
 * Nodes around a node that can be reached over the surface without leaving a ball. Unlike the ball alone, this does
 * not take in the other side of a thin wall.
 *
 * @param {ArrayLike<number>} x   positions, nodes × 3
 * @param {{starts: Uint32Array, pairs: Uint32Array}} rings
 * @param {number} seed           a node
 * @param {number[]} centre       of the ball
 * @param {number} radius
 * @returns {number[]}            at least the seed
 */
export function brushed(x, {starts, pairs}, seed, centre, radius) {
  const inside = (v) =>
    (x[3 * v] - centre[0]) ** 2 + (x[3 * v + 1] - centre[1]) ** 2 + (x[3 * v + 2] - centre[2]) ** 2 <= radius * radius;
  const found = [seed], known = new Set(found);
  for (let k = 0; k < found.length; ++k)
    for (let j = 2 * starts[found[k]]; j < 2 * starts[found[k] + 1]; ++j)
      if (!known.has(pairs[j]) && inside(pairs[j])) known.add(pairs[j]), found.push(pairs[j]);
  return found;
}

/**
 * Nodes that a rectangle on the screen covers, however deep: as if it were punched through the object.
 *
 * @param {ArrayLike<number>} x     positions, nodes × 3
 * @param {number} count            how many nodes to look at
 * @param {number[]} matrix         projection × view, 16 numbers by columns
 * @param {{left: number, right: number, bottom: number, top: number}} box  in normalised device coordinates
 * @returns {number[]}
 */
export function boxed(x, count, matrix, {left, right, bottom, top}) {
  const m = matrix, found = [];
  for (let v = 0; v < count; ++v) {
    const a = x[3 * v], b = x[3 * v + 1], c = x[3 * v + 2];
    const w = m[3] * a + m[7] * b + m[11] * c + m[15];
    if (w <= 0) continue;
    const h = (m[0] * a + m[4] * b + m[8] * c + m[12]) / w, k = (m[1] * a + m[5] * b + m[9] * c + m[13]) / w;
    if (h >= left && h <= right && k >= bottom && k <= top) found.push(v);
  }
  return found;
}
