import assert from 'node:assert/strict';
import {test} from 'node:test';
import {Matrix4, Quaternion, Vector3} from 'three';
import {matrixOf, motionTo, placeOf, STILL} from '../src/geometry/motion.js';
import {fansOf} from '../src/geometry/fans.js';
import {intersect} from '../src/geometry/ray.js';
import {boxed, brushed} from '../src/geometry/regions.js';
import {edgesOf, ringsOf} from '../src/geometry/rings.js';
import {Shape} from '../src/geometry/shape.js';
import {strainsOf} from '../src/geometry/strain.js';
import {positionsOf, randomNumbers, sheet, tetrahedron} from './models.js';

const near = (a, b, tolerance = 1e-12) => [...a].forEach((value, i) =>
  assert.ok(Math.abs(value - b[i]) <= tolerance, `${value} at ${i}, expected ${b[i]}`));

for (const block of [1, 3])
  test(`a shape is X + U q, also node by node, with block ${block}`, () => {
    const model = sheet({block}), shape = new Shape(model), random = randomNumbers(5);
    const q = Float32Array.from({length: model.about.dimension}, random);
    shape.take({kind: 'coordinates', values: q});
    const expected = positionsOf(model, q);
    near(shape.positions(), expected);
    for (const v of [0, 7, 23]) near(shape.position(v), expected.subarray(3 * v, 3 * v + 3));
    shape.take({kind: 'coordinates', values: new Float32Array(q.length)});
    near(shape.positions(), model.rest);
  });

test('streamed positions replace the coordinates until these come again', () => {
  const model = sheet(), shape = new Shape(model);
  shape.take({kind: 'positions', values: new Float32Array(3 * model.about.surface_nodes).fill(0.25)});
  near(shape.positions(), model.rest.map((x) => x + 0.25), 1e-7);
  near([shape.extent().displacement], [0.25 * Math.sqrt(3)]);
  shape.take({kind: 'coordinates', values: new Float32Array(model.about.dimension)});
  near(shape.positions(), model.rest);
});

test('shapes of one model share its surface and know their distance', () => {
  const model = sheet(), shape = new Shape(model), other = new Shape(model, shape);
  other.take({kind: 'positions', values: Float32Array.from({length: 3 * model.about.surface_nodes}, (_, i) => (i === 10 ? 0.5 : 0))});
  near([shape.distance(other), other.distance(shape)], [0.5, 0.5]);
  assert.equal(other.fans, shape.fans);
});

test('normals of a plane are normal to it', () => {
  const normals = new Shape(sheet()).normals();
  for (let v = 0; v < normals.length; v += 3) near(normals.subarray(v, v + 3), [0, 0, 1]);
});

test('sharp edges part the sides of a node, smooth ones do not', () => {
  const parts = ({rest, triangles, about}) => fansOf(rest, triangles, ringsOf(triangles, about.nodes));
  assert.equal(parts(sheet()).count, 24);
  const {count, nodeOf, triangles, rings} = parts(tetrahedron());
  assert.equal(count, 12, 'each corner has three sides');
  assert.equal(new Set(triangles).size, 12);
  assert.deepEqual([...triangles].map((vertex) => nodeOf[vertex]), [...tetrahedron().triangles]);
  for (let vertex = 0; vertex < 12; ++vertex) {
    assert.equal(rings.starts[vertex + 1] - rings.starts[vertex], 1);
    assert.ok(rings.pairs[2 * rings.starts[vertex]] < 4, 'rings are of nodes');
  }
});

test('a strain is how much longer or shorter the surface has become', () => {
  const model = sheet(), {rest, triangles, about} = model, fans = fansOf(rest, triangles, ringsOf(triangles, about.nodes));
  const turn = new Matrix4().makeRotationAxis(new Vector3(1, 2, 3).normalize(), 0.8);
  const moved = (a, b, shear = 0) => Array.from({length: about.nodes}, (_, v) => {
    const [x, y, z] = rest.slice(3 * v, 3 * v + 3);
    return new Vector3(a * x + shear * y, b * y, z).applyMatrix4(turn).toArray();
  }).flat();
  const strained = (x, expected) => near(strainsOf(rest, x, fans), new Array(about.nodes).fill(expected), 1e-6);
  strained(moved(1, 1), 0);
  strained(moved(1.3, 0.9), 0.3);
  strained(moved(1.1, 0.7), -0.3);
  const shear = 0.4, long = Math.sqrt(1 + shear * shear / 2 + shear * Math.sqrt(1 + shear * shear / 4));
  strained(moved(1, 1, shear), long - 1);
});

test('rings hold each corner once, and edges each pair once', () => {
  const {triangles, about} = sheet();
  const rings = ringsOf(triangles, about.nodes);
  assert.equal(rings.starts.at(-1), triangles.length);
  for (let v = 0; v < about.nodes; ++v)
    for (let k = rings.starts[v]; k < rings.starts[v + 1]; ++k) {
      const [b, c] = rings.pairs.subarray(2 * k, 2 * k + 2);
      const found = Array.from({length: triangles.length / 3}, (_, t) => [...triangles.subarray(3 * t, 3 * t + 3)])
        .filter((t) => [0, 1, 2].some((s) => t[s] === v && t[(s + 1) % 3] === b && t[(s + 2) % 3] === c));
      assert.equal(found.length, 1);
    }
  const edges = edgesOf(rings).length / 2;
  assert.equal(about.nodes - edges + about.triangles, 1, 'Euler’s number of a disc');
});

test('a ray meets the nearest triangle and its nearest corner', () => {
  const {rest, triangles} = sheet();
  const hit = intersect(rest, triangles, [0.41, 0.21, 2], [0, 0, -1]);
  near(hit.point, [0.41, 0.21, 0]);
  assert.equal(hit.node, 1 * 6 + 2);
  near([hit.distance], [2]);
  assert.equal(intersect(rest, triangles, [1.5, 0.2, 2], [0, 0, -1]), null);
  assert.equal(intersect(rest, triangles, [0.4, 0.2, 2], [0, 0, 1]), null, 'behind the eye');
});

test('a brush stays on its side of a gap', () => {
  // Two strips that lie above each other are one object but for the triangles between them.
  const {rest, triangles} = sheet({columns: 6, rows: 2});
  const x = [...rest, ...Array.from(rest, (value, i) => (i % 3 === 2 ? 0.01 : value))];
  const both = Uint32Array.from([...triangles, ...triangles.map((v) => v + 12)]);
  const found = brushed(x, ringsOf(both, 24), 2, [0.4, 0, 0], 0.25);
  assert.deepEqual(found.sort((a, b) => a - b), [1, 2, 3, 8]);
});

test('a box takes what it covers in the picture', () => {
  const {rest, about} = sheet();
  const identity = new Matrix4().elements;
  const found = boxed(rest, about.nodes, identity, {left: -0.1, right: 0.3, bottom: -0.1, top: 0.1});
  assert.deepEqual(found, [0, 1]);
});

test('a motion goes to a place and back', () => {
  const centre = [0.3, -1, 2];
  const turn = new Quaternion().setFromAxisAngle(new Vector3(1, 2, -1).normalize(), 1.1);
  const at = new Vector3(4, 5, 6);
  const motion = motionTo(at, turn.clone().set(2 * turn.x, 2 * turn.y, 2 * turn.z, 2 * turn.w), centre);
  const place = placeOf(motion, centre);
  near(place.position.toArray(), at.toArray());
  assert.ok(place.quaternion.angleTo(turn) < 1e-7);
  assert.ok(Math.abs(matrixOf(motion).determinant() - 1) < 1e-12);
  near(motionTo(new Vector3(...centre), new Quaternion(), centre), STILL);
});
