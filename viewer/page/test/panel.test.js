import assert from 'node:assert/strict';
import {test} from 'node:test';
import {count, percent, quantity} from '../src/panel/quantity.js';
import {cssColour, mapColour} from '../src/render/colour_maps.js';
import {upAxisOf} from '../src/render/up_axis.js';

test('quantities have three digits and a prefix', () => {
  assert.equal(quantity(0.00123456, 's'), '1.23 ms');
  assert.equal(quantity(999.6, 'Hz'), '1.00 kHz');
  assert.equal(quantity(-4.2e-6, 'J'), '-4.20 µJ');
  assert.equal(quantity(1e-200, 'J'), '0 J');
  assert.equal(quantity(NaN, 'J'), '–');
  assert.equal(percent(0.0219), '2.2 %');
  assert.equal(percent(1.234), '123 %');
  assert.equal(count(1234567).replaceAll('\u202f', ' '), '1 234 567');
});

test('colours grow lighter along the sequential map, and darker to both sides of the diverging one', () => {
  const luminance = (map, share) => mapColour(map, share).reduce((sum, c, k) => sum + c * [0.2126, 0.7152, 0.0722][k], 0);
  for (let share = 0; share < 1; share += 0.05) assert.ok(luminance('sequential', share + 0.05) > luminance('sequential', share));
  for (let side = 0; side < 0.45; side += 0.05)
    for (const sign of [-1, 1])
      assert.ok(luminance('diverging', 0.5 + sign * (side + 0.05)) < luminance('diverging', 0.5 + sign * side));
  assert.match(cssColour('sequential', 0.3), /^rgb\(\d+ \d+ \d+\)$/);
});

test('up is y, but z for what stands on z = 0', () => {
  const model = (fixed) => ({about: {fixed, low: [0, 0, 0], high: [1, 1, 1]}, rest: [0, 0, 0, 0.5, 0.9, 0, 0.5, 0, 0.9]});
  assert.equal(upAxisOf(model([])), 1);
  assert.equal(upAxisOf(model([0, 1])), 2);
  assert.equal(upAxisOf(model([0, 2])), 1);
});
