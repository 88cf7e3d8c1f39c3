/** Files of a shape. Positions are nodes × 3; the surface's nodes come first. */

/** @returns {string} Wavefront OBJ */
export function objOf(x, surfaceNodes, triangles, comment = '') {
  const lines = comment ? [`# ${comment}`] : [];
  for (let v = 0; v < surfaceNodes; ++v) lines.push(`v ${short(x[3 * v])} ${short(x[3 * v + 1])} ${short(x[3 * v + 2])}`);
  for (let t = 0; t < triangles.length; t += 3)
    lines.push(`f ${triangles[t] + 1} ${triangles[t + 1] + 1} ${triangles[t + 2] + 1}`);
  return lines.join('\n') + '\n';
}

const short = (value) => Number(value.toPrecision(9));

/** @returns {ArrayBuffer} binary PLY */
export function plyOf(x, surfaceNodes, triangles, comment = '') {
  const faces = triangles.length / 3;
  const header = new TextEncoder().encode([
    'ply', 'format binary_little_endian 1.0', ...(comment ? [`comment ${comment}`] : []),
    `element vertex ${surfaceNodes}`, 'property float x', 'property float y', 'property float z',
    `element face ${faces}`, 'property list uchar uint vertex_indices', 'end_header', '',
  ].join('\n'));
  const file = new ArrayBuffer(header.length + 12 * surfaceNodes + 13 * faces), view = new DataView(file);
  new Uint8Array(file).set(header);
  let at = header.length;
  for (let i = 0; i < 3 * surfaceNodes; ++i, at += 4) view.setFloat32(at, x[i], true);
  for (let t = 0; t < triangles.length; t += 3) {
    view.setUint8(at++, 3);
    for (let corner = 0; corner < 3; ++corner, at += 4) view.setUint32(at, triangles[t + corner], true);
  }
  return file;
}
