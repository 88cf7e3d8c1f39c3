/**
 * A motion as a binary glTF 2.0 file: one morph target a column of U, whose animated weights are q, so that it shows
 * exactly X + U q. There are no normals: viewers then compute those of the deformed triangles.
 *
 * @param {import('../session/model.js').Model} model
 * @param {{times: number[], coordinates: Float32Array[]}} motion   times in seconds, ascending
 * @returns {ArrayBuffer}
 */
export function glbOf(model, {times, coordinates}) {
  const {about, rest, triangles} = model;
  const n = about.surface_nodes, d = about.dimension;
  const file = new Pieces();
  const positions = file.vectors(rest.subarray(0, 3 * n));
  const indices = file.add(triangles, {componentType: 5125, type: 'SCALAR', count: triangles.length}, 34963);
  const targets = Array.from({length: d}, (_, k) => ({POSITION: file.vectors(columnOf(model, k))}));
  const input = file.add(Float32Array.from(times), {
    componentType: 5126, type: 'SCALAR', count: times.length, min: [Math.fround(times[0])], max: [Math.fround(times.at(-1))],
  });
  const weights = new Float32Array(times.length * d);
  coordinates.forEach((q, k) => weights.set(q, k * d));
  const output = file.add(weights, {componentType: 5126, type: 'SCALAR', count: weights.length});
  return file.glb({
    asset: {version: '2.0', generator: 'Supple'},
    scene: 0,
    scenes: [{nodes: [0]}],
    nodes: [{mesh: 0, name: about.name}],
    meshes: [{
      primitives: [{attributes: {POSITION: positions}, indices, targets, material: 0}],
      weights: [...coordinates[0]],
    }],
    materials: [{
      doubleSided: !about.solid,
      pbrMetallicRoughness: {baseColorFactor: [0.266, 0.451, 0.701, 1], metallicFactor: 0, roughnessFactor: 0.6},
    }],
    animations: [{
      samplers: [{input, output, interpolation: 'LINEAR'}],
      channels: [{sampler: 0, target: {node: 0, path: 'weights'}}],
    }],
  });
}

/** Column k of U at the surface's nodes: with block 3, field k div 3 along axis k mod 3. */
export function columnOf({about: {block, fields, surface_nodes}, basis}, k) {
  const column = new Float32Array(3 * surface_nodes);
  if (block === 3)
    for (let v = 0, field = Math.floor(k / 3); v < surface_nodes; ++v) column[3 * v + k % 3] = basis[v * fields + field];
  else
    for (let i = 0; i < column.length; ++i) column[i] = basis[i * fields + k];
  return column;
}

/** Accessors, their views and the bytes behind them. */
class Pieces {
  accessors = [];
  bufferViews = [];
  parts = [];
  bytes = 0;

  add(array, accessor, target) {
    this.bufferViews.push({buffer: 0, byteOffset: this.bytes, byteLength: array.byteLength, ...(target ? {target} : {})});
    this.parts.push(array);
    this.bytes += array.byteLength;
    return this.accessors.push({bufferView: this.bufferViews.length - 1, ...accessor}) - 1;
  }

  vectors(array) {
    const min = [Infinity, Infinity, Infinity], max = [-Infinity, -Infinity, -Infinity];
    array.forEach((value, i) => {
      min[i % 3] = Math.min(min[i % 3], value);
      max[i % 3] = Math.max(max[i % 3], value);
    });
    return this.add(array, {componentType: 5126, type: 'VEC3', count: array.length / 3, min, max}, 34962);
  }

  glb(json) {
    const {accessors, bufferViews, bytes} = this;
    let text = JSON.stringify({...json, accessors, bufferViews, buffers: [{byteLength: bytes}]});
    const encoder = new TextEncoder();
    text += ' '.repeat((4 - encoder.encode(text).length % 4) % 4);
    const head = encoder.encode(text);
    const file = new ArrayBuffer(12 + 8 + head.length + 8 + bytes), view = new DataView(file), all = new Uint8Array(file);
    [0x46546c67, 2, file.byteLength, head.length, 0x4e4f534a].forEach((word, k) => view.setUint32(4 * k, word, true));
    all.set(head, 20);
    view.setUint32(20 + head.length, bytes, true);
    view.setUint32(24 + head.length, 0x004e4942, true);
    let at = 28 + head.length;
    for (const part of this.parts) {
      all.set(new Uint8Array(part.buffer, part.byteOffset, part.byteLength), at);
      at += part.byteLength;
    }
    return file;
  }
}
