/**
 * Makes the pictures of the page in docs/images again:
 *   SUPPLE_COMMAND=build/release/app/supple node screenshots.mjs SOLID.supple SHELL.supple [OUT]
 */
import {mkdtemp, rm} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {launchBrowser, openPage, run, settled, startServer} from './harness.mjs';

const [solid, shell, out = fileURLToPath(new URL('../../docs/images', import.meta.url))] = process.argv.slice(2);
if (!shell) throw new Error('expected a solid model and a shell model');
const SIZE = {width: 1240, height: 760};

const browser = await launchBrowser();
try {
  await withSession(solid, async (page) => {
    await pulled(page);
    await components(page);
    await modes(page);
  });
  await withSession(shell, edited);
  await compared();
} finally {
  await browser.close();
}

async function withSession(model, act, options = []) {
  const server = await startServer({model: [model], options});
  try {
    await act(await openPage(browser, server.url, {viewport: SIZE}));
  } finally {
    await server.stop();
  }
}

/** Waits for a picture at rest, without notes over it. */
async function shoot(page, name) {
  await page.evaluate(() => {
    document.querySelector('.toasts').replaceChildren();
    supple.app.layout.hint.dismiss();
  });
  await settled(page);
  await page.waitForTimeout(300);
  await page.screenshot({path: join(out, `view-${name}.png`)});
}

/** The free node that is farthest along a direction and seen. */
function extreme(page, direction) {
  return page.evaluate((towards) => {
    const along = (v) => supple.position(v).reduce((sum, c, k) => sum + c * towards[k], 0);
    const nodes = Array.from({length: supple.about.surface_nodes}, (_, v) => v).sort((a, b) => along(b) - along(a));
    return nodes.find((v) => {
      const {x, y} = supple.project(v);
      return [[0, 0], [6, 0], [-6, 0], [0, 6], [0, -6]].every(([h, k]) => supple.pick(x + h, y + k)) && supple.pick(x, y).node === v;
    });
  }, direction);
}

/** A person holds the object by its head. */
async function pulled(page) {
  const node = await extreme(page, [-1, 0.7, 0.2]), from = await page.evaluate((v) => supple.project(v), node);
  await page.evaluate(() => {
    supple.set({pullStiffness: 0.5});
    supple.ask({do: 'set', damping: {mass: 1, stiffness: 0.01}});
    supple.ask({do: 'play'});
  });
  await page.waitForFunction(() => supple.frame.steps > 200);
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(from.x - 60, from.y - 110, {steps: 12});
  await page.waitForTimeout(7000);
  await page.keyboard.press('Space');
  await page.waitForFunction(() => !supple.frame.playing);
  await shoot(page, 'pull');
  await page.evaluate(() => supple.set({theme: 'dark', colours: 'displacement'}));
  await shoot(page, 'dark');
  await page.evaluate(() => supple.set({theme: 'light', colours: 'plain'}));
  await page.mouse.up();
}

async function components(page) {
  await page.keyboard.press('r');
  await page.keyboard.press('c');
  await shoot(page, 'components');
  await page.keyboard.press('c');
}

async function modes(page) {
  await page.keyboard.press('3');
  await page.waitForFunction(() => supple.state.mode === 'modes');
  await page.evaluate(() => supple.set({amplitude: 0.2, colours: 'displacement'}));
  await page.getByRole('option').nth(2).click();
  // Near the end of a swing, when the shape is farthest from rest.
  const size = () => page.evaluate(() => Math.hypot(...supple.frame.values));
  let most = 0;
  for (let k = 0; k < 40; ++k) most = Math.max(most, await size()), await page.waitForTimeout(30);
  await page.waitForFunction((limit) => Math.hypot(...supple.frame.values) > limit, 0.92 * most);
  await page.evaluate(() => supple.ask({do: 'pause'}));
  await shoot(page, 'modes');
}

/** One handle holds, another has been moved and turned. */
async function edited(page) {
  await page.keyboard.press('2');
  await page.waitForFunction(() => supple.state.mode === 'edit');
  const region = (keep) => page.evaluate((source) => {
    const {low, high, surface_nodes} = supple.about, inside = new Function('s', `return ${source}`);
    return Array.from({length: surface_nodes}, (_, v) => v)
      .filter((v) => inside(supple.position(v).map((c, k) => (c - low[k]) / (high[k] - low[k]))));
  }, keep);
  await page.evaluate((nodes) => supple.select(nodes), await region('s[1] < 0.22'));
  await page.getByRole('button', {name: 'Fixed handle'}).click();
  await page.waitForFunction(() => supple.state.handles.length === 1);
  await page.evaluate((nodes) => supple.select(nodes), await region('s[1] > 0.82'));
  await page.getByRole('button', {name: 'Movable handle'}).click();
  await page.waitForFunction(() => supple.state.handles.length === 2);
  await page.evaluate(() => {
    const {id, centre: [x, y]} = supple.state.handles[1], d = supple.about.diagonal;
    for (let k = 1; k <= 12; ++k) {
      const t = k / 12, c = Math.cos(0.35 * t), s = Math.sin(0.35 * t);
      supple.ask({do: 'move', handle: id, grab: k === 1, motion: [
        c, -s, 0, x - c * x + s * y + 0.14 * d * t, s, c, 0, y - s * x - c * y + 0.03 * d * t, 0, 0, 1, 0.02 * d * t]});
    }
  });
  await page.waitForTimeout(4000);
  await page.evaluate(() => supple.set({gizmo: 'rotate'}));
  await shoot(page, 'edit');
}

/** The full object swings beside the reduced one. */
async function compared() {
  const folder = await mkdtemp(join(tmpdir(), 'supple-pictures-')), [reduced, full] = ['reduced', 'full'].map((name) => join(folder, name));
  const motion = ['--time', '1', '--frames', 'none'];
  await run('simulate', solid, ...motion, '-o', reduced);
  await run('simulate', solid, '--full', ...motion, '-o', full);
  await withSession(solid, async (page) => {
    await page.waitForFunction(() => supple.compares);
    await page.evaluate(() => {
      const {begin, duration, frames} = supple.about.recording;
      supple.ask({do: 'pause'});
      supple.set({colours: 'error'});
      window.moments = Array.from({length: frames}, (_, k) => begin + duration * k / (frames - 1));
    });
    // Every moment once, for the curve; then the one where they are farthest apart.
    let most = [0, 0];
    for (const time of await page.evaluate(() => moments)) {
      await page.evaluate((t) => supple.ask({do: 'seek', time: t}), time);
      await page.waitForFunction((t) => Math.abs(supple.frame.time - t) < 1e-6, time);
      const apart = await page.evaluate(() => supple.frame.values.reduce((sum, u, i) => sum + (u - supple.frame.reference[i]) ** 2, 0));
      if (apart > most[0]) most = [apart, time];
    }
    await page.evaluate((t) => supple.ask({do: 'seek', time: t}), most[1]);
    await page.waitForFunction((t) => Math.abs(supple.frame.time - t) < 1e-6, most[1]);
    await shoot(page, 'replay');
  }, ['--replay', reduced, '--beside', full]);
  await rm(folder, {recursive: true, force: true});
}
