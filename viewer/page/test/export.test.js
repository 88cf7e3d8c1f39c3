import assert from 'node:assert/strict';
import {test} from 'node:test';
import {GLTFLoader} from 'three/addons/loaders/GLTFLoader.js';
import {glbOf} from '../src/export/glb.js';
import {objOf, plyOf} from '../src/export/meshes.js';
import {Recorder} from '../src/export/recorder.js';
import {decodeRecording, encodeRecording} from '../src/export/recording.js';
import {positionsOf, randomNumbers, sheet} from './models.js';

function motionOf(model, frames = 3) {
  const random = randomNumbers(9);
  return {
    times: Array.from({length: frames}, (_, k) => k / 10),
    coordinates: Array.from({length: frames}, () => Float32Array.from({length: model.about.dimension}, random)),
  };
}

test('OBJ counts from one', () => {
  const text = objOf([0, 0, 0, 1, 0, 0, 0, 0.5, 0], 3, Uint32Array.of(0, 1, 2), 'a triangle');
  assert.equal(text, '# a triangle\nv 0 0 0\nv 1 0 0\nv 0 0.5 0\nf 1 2 3\n');
});

test('PLY says its size and holds what it says', () => {
  const {rest, triangles, about} = sheet();
  const file = plyOf(rest, about.nodes, triangles), text = new TextDecoder('latin1').decode(file);
  const end = text.indexOf('end_header\n') + 'end_header\n'.length, view = new DataView(file);
  assert.match(text, /element vertex 24\n/);
  assert.match(text, /element face 30\n/);
  assert.equal(file.byteLength, end + 24 * 12 + 30 * 13);
  assert.equal(view.getFloat32(end + 12, true), rest[3]);
  assert.equal(view.getUint32(end + 24 * 12 + 1, true), triangles[0]);
});

for (const block of [1, 3])
  test(`a glTF file shows X + U q with block ${block}`, async () => {
    globalThis.self ??= globalThis;  // which three's loader looks for
    const model = sheet({block}), motion = motionOf(model);
    const {scene, animations} = await new GLTFLoader().parseAsync(glbOf(model, motion), '');
    const mesh = scene.children[0], {position} = mesh.geometry.attributes, targets = mesh.geometry.morphAttributes.position;
    assert.equal(targets.length, model.about.dimension);
    const track = animations[0].tracks[0];
    assert.deepEqual([...track.times].map((t) => t.toFixed(3)), ['0.000', '0.100', '0.200']);
    motion.coordinates.forEach((q, frame) => {
      const weights = track.values.slice(frame * q.length, (frame + 1) * q.length), expected = positionsOf(model, q);
      expected.forEach((x, i) => {
        const shown = targets.reduce((sum, target, k) => sum + weights[k] * target.array[i], position.array[i]);
        assert.ok(Math.abs(shown - x) < 1e-12);
      });
    });
  });

test('a recording survives its bytes, the basis to a part in 30 000', () => {
  const model = sheet({block: 1, fields: 7}), motion = motionOf(model), view = {position: [1, 2, 3]};
  const back = decodeRecording(encodeRecording({model, ...motion, view}));
  assert.deepEqual(back.model.about, model.about);
  assert.deepEqual(back.view, view);
  assert.deepEqual(back.times, motion.times);
  assert.deepEqual(back.coordinates.map((q) => [...q]), motion.coordinates.map((q) => [...q]));
  for (const name of ['rest', 'triangles', 'components', 'weights']) assert.deepEqual([...back.model[name]], [...model[name]]);
  back.model.basis.forEach((value, i) => assert.ok(Math.abs(value - model.basis[i]) <= 0.1 / 30000));
});

test('a recorder remembers the last seconds, or all that it was told to', () => {
  const recorder = new Recorder(), q = Float32Array.of(1);
  for (let t = 0; t < 60; t += 0.01) recorder.take(q, t);
  assert.ok(recorder.motion().times.at(-1) <= 15 && recorder.motion().times.at(-1) > 14);
  assert.ok(recorder.motion().times.length <= 15 * 31 + 1, 'no more than are seen');
  recorder.start();
  for (let t = 100; t < 140; t += 0.01) recorder.take(q, t);
  recorder.stop();
  recorder.take(q, 200);
  const {times} = recorder.motion();
  assert.equal(times[0], 0);
  assert.ok(Math.abs(times.at(-1) - 40) < 0.1);
});
