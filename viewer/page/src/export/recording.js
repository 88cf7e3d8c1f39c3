/**
 * A model and a motion as one array of bytes, for pages that play without a server. The basis is kept in 16 bits a
 * number, scaled column by column: what that changes is below a pixel of any screen.
 *
 * @typedef {object} Recording
 * @property {import('../session/model.js').Model} model
 * @property {number[]} times            [s], ascending
 * @property {Float32Array[]} coordinates  q at these times
 * @property {object} view               how the page showed it
 */

const STEPS = 32767;

/** @param {Recording} recording  @returns {Uint8Array} */
export function encodeRecording({model, times, coordinates, view}) {
  const {about} = model, {scales, steps} = quantise(model.basis, about.fields);
  const arrays = {
    rest: model.rest, triangles: model.triangles, components: model.components, weights: model.weights,
    scales, steps, times: Float64Array.from(times), coordinates: joined(coordinates, about.dimension),
  };
  const index = Object.fromEntries(Object.entries(arrays).map(([name, a]) => [name, a.length]));
  const head = new TextEncoder().encode(JSON.stringify({about, view, index}));
  const padded = Math.ceil((4 + head.length) / 8) * 8;
  const size = Object.values(arrays).reduce((sum, a) => sum + aligned(a.byteLength), padded);
  const bytes = new Uint8Array(size);
  new DataView(bytes.buffer).setUint32(0, head.length, true);
  bytes.set(head, 4);
  let at = padded;
  for (const a of Object.values(arrays)) {
    bytes.set(new Uint8Array(a.buffer, a.byteOffset, a.byteLength), at);
    at += aligned(a.byteLength);
  }
  return bytes;
}

/** @param {Uint8Array} bytes  @returns {Recording} */
export function decodeRecording(bytes) {
  const buffer = bytes.slice().buffer;
  const length = new DataView(buffer).getUint32(0, true);
  const {about, view, index} = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length)));
  const types = {
    rest: Float32Array, triangles: Uint32Array, components: Uint32Array, weights: Float32Array, scales: Float32Array,
    steps: Int16Array, times: Float64Array, coordinates: Float32Array,
  };
  const arrays = {};
  let at = Math.ceil((4 + length) / 8) * 8;
  for (const [name, count] of Object.entries(index)) {
    arrays[name] = new types[name](buffer, at, count);
    at += aligned(arrays[name].byteLength);
  }
  const {scales, steps, times, coordinates, ...rest} = arrays;
  const basis = Float32Array.from(steps, (step, i) => step * scales[i % about.fields]);
  const d = about.dimension;
  return {
    model: {about, basis, nodes: new Uint32Array(0), modes: new Float32Array(0), ...rest},
    times: [...times],
    coordinates: Array.from(times, (_, k) => coordinates.subarray(k * d, (k + 1) * d)),
    view,
  };
}

const aligned = (bytes) => Math.ceil(bytes / 8) * 8;

function quantise(basis, fields) {
  const scales = new Float32Array(fields);
  basis.forEach((value, i) => (scales[i % fields] = Math.max(scales[i % fields], Math.abs(value))));
  scales.forEach((largest, f) => (scales[f] = largest / STEPS || 1));
  return {scales, steps: Int16Array.from(basis, (value, i) => Math.round(value / scales[i % fields]))};
}

function joined(coordinates, dimension) {
  const all = new Float32Array(coordinates.length * dimension);
  coordinates.forEach((q, k) => all.set(q, k * dimension));
  return all;
}
