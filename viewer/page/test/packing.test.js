import assert from 'node:assert/strict';
import {test} from 'node:test';
import {packBasis, packCoordinates} from '../src/render/basis_packing.js';
import {gridOf} from '../src/render/vertex_grid.js';
import {positionsOf, randomNumbers, sheet} from './models.js';

/** What the shader does with a chunk, in double precision. */
function addChunk({about: {block, nodes}}, grid, chunk, q, x) {
  const texel = (layer, v) => chunk.data.subarray(4 * (layer * grid.texels + v), 4 * (layer * grid.texels + v) + 4);
  const dot = (w, at) => w.reduce((sum, value, lane) => sum + value * q[4 * at + lane], 0);
  for (let v = 0; v < nodes; ++v)
    for (let g = 0; g < chunk.groups; ++g)
      for (let axis = 0; axis < 3; ++axis)
        x[3 * v + axis] += block === 3 ? dot(texel(g, v), 3 * g + axis) : dot(texel(3 * g + axis, v), g);
}

for (const block of [1, 3])
  for (const [layers, parts] of [[256, 1], [6, block === 3 ? 1 : 2], [3, block === 3 ? 2 : 4]])
    test(`packed fields give X + U q with block ${block} and at most ${layers} layers`, () => {
      const model = sheet({block, fields: 14}), grid = gridOf(model.about.nodes), random = randomNumbers(3);
      const q = Float32Array.from({length: model.about.dimension}, random), x = Float64Array.from(model.rest);
      const chunks = [...packBasis(model, model.nodes, grid, {layers, bytes: 2 ** 28})];
      assert.equal(chunks.length, parts);
      for (const chunk of chunks) {
        assert.ok(chunk.layers <= layers);
        const packed = packCoordinates(model.about, chunk, q, new Float32Array(4 * chunk.groups * (block === 3 ? 3 : 1)));
        addChunk(model, grid, chunk, packed, x);
      }
      const expected = positionsOf(model, q);
      x.forEach((value, i) => assert.ok(Math.abs(value - expected[i]) < 1e-12));
    });

test('a grid has room for all nodes and is about square', () => {
  for (const nodes of [1, 2, 1000, 16306, 130000, 1 << 20]) {
    const {columns, rows} = gridOf(nodes);
    assert.ok(columns * rows >= nodes && Number.isInteger(columns) && columns <= 3 * rows + 2 && rows <= 3 * columns);
  }
});
