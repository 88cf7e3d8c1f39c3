/**
 * Frames of a session, laid out as docs/viewer-protocol.md says.
 *
 * @typedef {object} Frame
 * @property {'coordinates'|'positions'} kind  what `values` holds: q, or x − X of the surface's nodes
 * @property {number} number
 * @property {number} time            of the session [s]
 * @property {number} kinetic         energies [J]
 * @property {number} elastic
 * @property {number} potential
 * @property {number} drift           what the integrator has made or taken [J]
 * @property {number} residual        relative, of the last step or solve
 * @property {number} iterations
 * @property {number} microseconds    that the last step or solve took
 * @property {number} stepsPerSecond
 * @property {number} realTime        session time over wall-clock time
 * @property {number} estimate        of the error; in a replay what it is measured to be; or NaN
 * @property {boolean} playing
 * @property {boolean} behind         cannot keep up with the wall clock
 * @property {boolean} unconverged    the last step missed its tolerance
 * @property {boolean} untrained      the pose is beyond what the estimate was trained on
 * @property {number} steps
 * @property {Float32Array} values
 * @property {Float32Array|null} reference   x − X of a second recording, which the first ought to be
 */

export const HEADER_BYTES = 96;

const COORDINATES = 1, POSITIONS = 2, BOTH = 3;
const PLAYING = 1, BEHIND = 2, UNCONVERGED = 4, UNTRAINED = 8;

/**
 * @param {ArrayBuffer} buffer
 * @returns {Frame}
 * @throws {RangeError} if the buffer is no frame
 */
export function parseFrame(buffer) {
  if (buffer.byteLength < HEADER_BYTES) throw new RangeError(`a frame of ${buffer.byteLength} bytes has no header`);
  const view = new DataView(buffer);
  const u32 = (offset) => view.getUint32(offset, true);
  const f32 = (offset) => view.getFloat32(offset, true);
  const f64 = (offset) => view.getFloat64(offset, true);
  const kind = u32(0), count = u32(76), bits = u32(72);
  if (![COORDINATES, POSITIONS, BOTH].includes(kind)) throw new RangeError(`a frame of unknown kind ${kind}`);
  if (buffer.byteLength !== HEADER_BYTES + 4 * count)
    throw new RangeError(`a frame of ${buffer.byteLength} bytes announces ${count} numbers`);
  const values = new Float32Array(buffer, HEADER_BYTES, count), half = count / 2;
  return {
    kind: kind === COORDINATES ? 'coordinates' : 'positions',
    number: u32(4),
    time: f64(8),
    kinetic: f64(16),
    elastic: f64(24),
    potential: f64(32),
    drift: f64(40),
    residual: f32(48),
    iterations: u32(52),
    microseconds: f32(56),
    stepsPerSecond: f32(60),
    realTime: f32(64),
    estimate: f32(68),
    playing: (bits & PLAYING) !== 0,
    behind: (bits & BEHIND) !== 0,
    unconverged: (bits & UNCONVERGED) !== 0,
    untrained: (bits & UNTRAINED) !== 0,
    steps: u32(80),
    values: kind === BOTH ? values.subarray(0, half) : values,
    reference: kind === BOTH ? values.subarray(half) : null,
  };
}
