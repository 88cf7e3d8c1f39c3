/**
 * Where a ray first meets a surface, from either side.
 *
 * @param {ArrayLike<number>} x           positions, nodes × 3
 * @param {Uint32Array} triangles
 * @param {number[]} origin
 * @param {number[]} direction
 * @returns {{triangle: number, node: number, distance: number, point: number[]}|null}  `node`: the nearest corner
 */
export function intersect(x, triangles, origin, direction) {
  const [ox, oy, oz] = origin, [dx, dy, dz] = direction;
  let nearest = Infinity, hit = -1;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ax = x[a], ay = x[a + 1], az = x[a + 2];
    const ux = x[b] - ax, uy = x[b + 1] - ay, uz = x[b + 2] - az;
    const vx = x[c] - ax, vy = x[c + 1] - ay, vz = x[c + 2] - az;
    const px = dy * vz - dz * vy, py = dz * vx - dx * vz, pz = dx * vy - dy * vx;
    const determinant = ux * px + uy * py + uz * pz;
    if (determinant === 0) continue;
    const sx = ox - ax, sy = oy - ay, sz = oz - az;
    const first = (sx * px + sy * py + sz * pz) / determinant;
    if (first < 0 || first > 1) continue;
    const rx = sy * uz - sz * uy, ry = sz * ux - sx * uz, rz = sx * uy - sy * ux;
    const second = (dx * rx + dy * ry + dz * rz) / determinant;
    if (second < 0 || first + second > 1) continue;
    const distance = (vx * rx + vy * ry + vz * rz) / determinant;
    if (distance > 0 && distance < nearest) nearest = distance, hit = t;
  }
  if (hit < 0) return null;
  const point = origin.map((o, axis) => o + nearest * direction[axis]);
  return {triangle: hit / 3, node: nearestCorner(x, triangles, hit, point), distance: nearest, point};
}

function nearestCorner(x, triangles, first, point) {
  let best = triangles[first], least = Infinity;
  for (let t = first; t < first + 3; ++t) {
    const v = 3 * triangles[t];
    const squared = (x[v] - point[0]) ** 2 + (x[v + 1] - point[1]) ** 2 + (x[v + 2] - point[2]) ** 2;
    if (squared < least) least = squared, best = triangles[t];
  }
  return best;
}
