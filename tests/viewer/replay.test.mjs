import assert from 'node:assert/strict';
import {mkdtemp, rm} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, describe, test} from 'node:test';
import {launchBrowser, modelFile, openPage, run, startServer, until} from './harness.mjs';

const skip = (await run('view', '--help')).includes('--replay') ? false : 'this `supple view` has no --replay';

describe('a recording of the reduced object beside the full one', {skip}, () => {
  let folder, server, browser, page;

  before(async () => {
    folder = await mkdtemp(join(tmpdir(), 'supple-replay-'));
    const model = await modelFile(folder), [reduced, full] = ['reduced', 'full'].map((name) => join(folder, name));
    const motion = ['--time', '1', '--every', '1', '--frames', 'none'];
    await run('simulate', model, ...motion, '-o', reduced);
    await run('simulate', model, '--full', ...motion, '-o', full);
    [server, browser] = await Promise.all([startServer({model: [model], options: ['--replay', reduced, '--beside', full]}), launchBrowser()]);
    page = await openPage(browser, server.url);
    await until(page, () => supple.compares);
  });

  after(() => Promise.allSettled([browser?.close(), server?.stop(), rm(folder, {recursive: true, force: true})]));

  const pauseAt = async (time) => {
    await page.evaluate((t) => (supple.ask({do: 'pause'}), supple.ask({do: 'seek', time: t})), time);
    await until(page, (t) => !supple.frame.playing && Math.abs(supple.frame.time - t) < 1e-6, time);
  };

  test('plays in a loop, and stops, steps and goes where one asks', async () => {
    assert.equal(await page.evaluate(() => supple.state.mode), 'replay');
    const {begin, duration, frames} = await page.evaluate(() => supple.about.recording);
    await page.evaluate(() => supple.ask({do: 'play'}));
    await until(page, () => supple.frame.playing && supple.frame.time > supple.about.recording.begin + 0.7 * supple.about.recording.duration);
    await until(page, () => supple.frame.time < supple.about.recording.begin + 0.3 * supple.about.recording.duration);
    await page.keyboard.press('Space');
    await until(page, () => !supple.frame.playing);
    await page.getByRole('button', {name: 'Reset'}).click();
    await until(page, (t) => supple.frame.time === t, begin);
    await page.getByRole('button', {name: 'Step'}).click();
    await until(page, ([t, h]) => Math.abs(supple.frame.time - t - h) < 0.2 * h, [begin, duration / (frames - 1)]);
    await page.locator('.seek').fill(String(begin + duration / 2));
    await until(page, (t) => Math.abs(supple.frame.time - t) < 1e-3, begin + duration / 2);
    assert.match(await page.textContent('.clock'), /^0\.\d\d \/ \d\.\d\d s$/);
    assert.deepEqual(page.errors, []);
  });

  test('shows both, side by side or one as a ghost, and how far they are apart', async () => {
    const middle = await page.evaluate(() => supple.about.recording.begin + supple.about.recording.duration / 2);
    await pauseAt(middle);
    assert.deepEqual(await page.locator('.label').allTextContents(), ['reduced', 'full']);
    const {measured, said, agreement, apart} = await page.evaluate(() => {
      const {about} = supple, x = supple.positions(), y = supple.referencePositions();
      const {rest} = supple.app.model, surface = Array.from({length: 3 * about.surface_nodes}, (_, i) => i);
      const size = (of) => Math.hypot(...surface.map(of));
      return {
        measured: size((i) => x[i] - y[i]) / size((i) => y[i] - rest[i]), said: supple.frame.estimate, agreement: supple.disagreement(),
        apart: supple.app.stage.reference.shift.length() / about.diagonal,
      };
    });
    assert.ok(Math.abs(measured - said) < 1e-3 * said + 1e-6, `${measured} is said to be ${said}`);
    assert.ok(agreement < 1e-6);
    assert.ok(apart > 0.2, 'they are side by side');
    await page.getByRole('button', {name: 'Error', exact: true}).click();
    assert.match(await page.textContent('.legend'), /distance.*m/);
    assert.match(await page.textContent('.plots'), /measured error\d.* %/);
    await page.getByText('Overlay', {exact: true}).click();
    assert.equal(await page.evaluate(() => supple.app.stage.reference.shift.length()), 0);
    assert.match(await page.textContent('.legend'), /reduced.*full/);
    await page.getByText('Overlay', {exact: true}).click();
    assert.deepEqual(page.errors, []);
  });

  test('leaves one object to simulate, and comes back', async () => {
    await page.getByRole('button', {name: 'Simulate'}).click();
    await until(page, () => supple.state.mode === 'simulate' && !supple.compares && supple.frame.kind === 'coordinates');
    assert.equal(await page.evaluate(() => supple.options.colours), 'plain', 'there is no other to be far from');
    assert.equal(await page.locator('.label').count(), 0);
    await page.keyboard.press('4');
    await until(page, () => supple.state.mode === 'replay' && supple.compares);
    assert.deepEqual(page.errors, []);
  });
});
