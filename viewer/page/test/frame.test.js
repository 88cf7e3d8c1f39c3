import assert from 'node:assert/strict';
import {test} from 'node:test';
import {HEADER_BYTES, parseFrame} from '../src/session/frame.js';

function frameOf({kind = 1, bits = 0, values = []} = {}) {
  const buffer = new ArrayBuffer(HEADER_BYTES + 4 * values.length), view = new DataView(buffer);
  view.setUint32(0, kind, true);
  view.setUint32(4, 17, true);
  [2.5, 1, 2, 3, 4].forEach((value, k) => view.setFloat64(8 + 8 * k, value, true));
  view.setFloat32(48, 0.5, true);
  view.setUint32(52, 6, true);
  view.setFloat32(56, 120, true);
  view.setFloat32(60, 200, true);
  view.setFloat32(64, 0.25, true);
  view.setFloat32(68, NaN, true);
  view.setUint32(72, bits, true);
  view.setUint32(76, values.length, true);
  view.setUint32(80, 99, true);
  new Float32Array(buffer, HEADER_BYTES).set(values);
  return buffer;
}

test('a frame is read as the protocol lays it out', () => {
  const frame = parseFrame(frameOf({bits: 1 | 4, values: [1.5, -2]}));
  assert.deepEqual({...frame, values: [...frame.values]}, {
    kind: 'coordinates', number: 17, time: 2.5, kinetic: 1, elastic: 2, potential: 3, drift: 4, residual: 0.5, iterations: 6,
    microseconds: 120, stepsPerSecond: 200, realTime: 0.25, estimate: NaN, playing: true, behind: false, unconverged: true,
    untrained: false, steps: 99, values: [1.5, -2], reference: null,
  });
  assert.equal(parseFrame(frameOf({kind: 2})).kind, 'positions');
  const both = parseFrame(frameOf({kind: 3, values: [1, 2, 3, 4, 5, 6]}));
  assert.deepEqual([both.kind, [...both.values], [...both.reference]], ['positions', [1, 2, 3], [4, 5, 6]]);
});

test('what is no frame is refused', () => {
  assert.throws(() => parseFrame(new ArrayBuffer(95)), /has no header/);
  assert.throws(() => parseFrame(frameOf({kind: 4})), /unknown kind 4/);
  assert.throws(() => parseFrame(frameOf({values: [1]}).slice(0, HEADER_BYTES)), /announces 1 numbers/);
});
