import assert from 'node:assert/strict';
import {test} from 'node:test';
import {Quality} from '../src/render/quality.js';

function qualityOf(finest) {
  const scales = [], quality = new Quality((scale) => scales.push(scale), finest);
  let redrawn = 0;
  const draw = (time, pressed = false) => {
    quality.begin(time, pressed);
    quality.end(() => {
      redrawn++;
      quality.rest();
    });
  };
  return {quality, scales, draw, redrawn: () => redrawn};
}

test('what rests is drawn finely, once, and what moves as fast as it can be', ({mock}) => {
  mock.timers.enable({apis: ['setTimeout']});
  const {quality, scales, draw, redrawn} = qualityOf(2);
  draw(0);
  mock.timers.tick(100);
  draw(100);
  mock.timers.tick(149);
  assert.equal(redrawn(), 0, 'something moved less than 150 ms ago');
  mock.timers.tick(1);
  assert.equal(redrawn(), 1);
  assert.ok(quality.fine);
  mock.timers.tick(10_000);
  assert.equal(redrawn(), 1);
  draw(11_000);
  assert.deepEqual(scales, [2, 1]);
});

test('a slow machine draws coarsely while things move, but no coarser than half', ({mock}) => {
  mock.timers.enable({apis: ['setTimeout']});
  const {quality, scales, draw} = qualityOf(1);
  for (let k = 0; k < 100; ++k) draw(200 * k, k > 0);
  assert.equal(scales.at(-1), 0.5);
  quality.rest();
  assert.equal(scales.at(-1), 1);
});
