import assert from 'node:assert/strict';
import {mkdtemp, readFile, rm} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, beforeEach, test} from 'node:test';
import * as harness from './harness.mjs';
import {launchBrowser, openPage, settled, startServer} from './harness.mjs';

let server, browser, page, folder;

before(async () => {
  folder = await mkdtemp(join(tmpdir(), 'supple-page-'));
  [server, browser] = await Promise.all([startServer(), launchBrowser()]);
  page = await openPage(browser, server.url);
});

after(async () => {
  await Promise.allSettled([browser?.close(), server?.stop(), rm(folder, {recursive: true, force: true})]);
});

beforeEach(async () => {
  page.errors.length = 0;
  await page.mouse.up();  // which a test that failed may have left out
  await page.evaluate(() => {
    supple.release();
    supple.ask({do: 'mode', mode: 'simulate'});
    supple.ask({do: 'set', gravity: [0, 0, 0], speed: 1, floor: null, damping: {mass: 0, stiffness: 0}});
    supple.ask({do: 'fix', nodes: []});
    supple.ask({do: 'pause'});
    supple.ask({do: 'reset'});
    supple.set({tool: 'pull', colours: 'plain', components: false, wireframe: false, pullStiffness: 1, stream: 'coordinates', theme: 'auto'});
    supple.select([]);
  });
  await until(() => supple.state.mode === 'simulate' && !supple.state.playing && supple.state.pulls.length === 0);
  await until(() => supple.frame.steps === 0 || supple.frame.time === 0);
});

const until = (holds, argument, of = page, timeout) => harness.until(of, holds, argument, timeout);
const noErrors = () => assert.deepEqual(page.errors, []);

const freeNode = () => harness.freeNode(page);

/** Nodes at one end of the longest axis: 0 the low one, 1 the high one. */
const endNodes = (end) => page.evaluate((high) => {
  const {about} = supple, axis = [0, 1, 2].reduce((a, b) => (about.high[b] - about.low[b] > about.high[a] - about.low[a] ? b : a));
  const length = about.high[axis] - about.low[axis];
  return Array.from({length: about.surface_nodes}, (_, v) => v).filter((v) => {
    const share = (supple.position(v)[axis] - about.low[axis]) / length;
    return high ? share > 0.9 : share > 0.35 && share < 0.5;
  });
}, end);

/** What the page says of something, given as code, when it has stopped changing. */
async function atRest(code) {
  await page.evaluate(() => (window.before = null));
  await page.waitForFunction((what) => {
    const now = JSON.stringify(eval(what)), rests = now === window.before;
    window.before = now;
    return rests;
  }, code, {polling: 300});
  return page.evaluate(code);
}

const distance = (a, b) => Math.hypot(...a.map((c, k) => c - b[k]));

test('the page shows the object on its ground', async () => {
  await settled(page);
  const {on, off} = await page.evaluate(() => {
    const {x, y} = supple.project(Math.floor(supple.about.surface_nodes / 2));
    return {on: supple.pixel(x, y), off: supple.pixel(400, 110)};
  });
  assert.ok(on[2] > on[0] + 15, `the object is blue, not ${on}`);
  assert.ok(Math.max(...off.slice(0, 3)) - Math.min(...off.slice(0, 3)) < 12 && off[0] > 200, `the background is light, not ${off}`);
  assert.equal(await page.textContent('h1'), await page.evaluate(() => supple.about.name));
  assert.equal(await page.getByRole('button', {name: 'Replay'}).count(), 0, 'there is no recording');
  noErrors();
});

test('it plays, pauses, steps and goes back to rest', async () => {
  await page.evaluate(() => supple.ask({do: 'set', gravity: [0, -2, 1]}));
  await page.getByRole('button', {name: 'Play'}).click();
  await until(() => supple.frame.steps > 20 && supple.frame.playing);
  await page.keyboard.press('Space');
  await until(() => !supple.state.playing && !supple.frame.playing);
  await page.waitForTimeout(100);
  const steps = await page.evaluate(() => supple.frame.steps);
  await page.keyboard.press('.');
  await until((before) => supple.frame.steps === before + 1, steps);
  await page.keyboard.press('r');
  await until(() => supple.frame.steps === 0);
  noErrors();
});

test('positions on the graphics card agree with the processor’s to 1e-5 of the object, and strains', async (t) => {
  await page.evaluate(() => {
    supple.ask({do: 'set', gravity: [1, -6, 3]});
    supple.ask({do: 'step', count: 60});
  });
  await until(() => supple.frame.steps === 60);
  const {gpu, disagreement, moved} = await page.evaluate(() => ({
    gpu: supple.computesOnGpu, disagreement: supple.disagreement(),
    moved: Math.max(...supple.frame.values.map(Math.abs)),
  }));
  assert.ok(gpu, 'the graphics card deforms');
  assert.ok(moved > 0, 'something has moved');
  assert.ok(disagreement < 1e-5, `they are ${disagreement} apart`);
  await page.evaluate(() => supple.set({colours: 'strain'}));
  const strains = await page.evaluate(() => ({apart: supple.strainDisagreement(), most: supple.app.stage.shape.strains().reduce((m, s) => Math.max(m, Math.abs(s)), 0)}));
  assert.ok(strains.most > 1e-3 && strains.apart < 1e-3 * strains.most + 1e-5, `strains ${JSON.stringify(strains)}`);
  assert.match(await page.textContent('.legend'), /strain.*%/);
  t.diagnostic(`GPU and CPU are ${disagreement.toExponential(1)} of the diagonal apart`);
  noErrors();
});

test('streamed positions show the same shape as coordinates', async () => {
  await page.evaluate(() => {
    supple.ask({do: 'set', gravity: [1, -6, 3]});
    supple.ask({do: 'step', count: 40});
  });
  await until(() => supple.frame.steps === 40);
  const before = await page.evaluate(() => supple.positions());
  await page.getByText('Deform on the server').click();
  await until(() => supple.frame.kind === 'positions' && !supple.computesOnGpu);
  const {after, surface, diagonal, disagreement} = await page.evaluate(() => ({
    after: supple.positions(), surface: supple.about.surface_nodes, diagonal: supple.about.diagonal, disagreement: supple.disagreement(),
  }));
  for (let i = 0; i < 3 * surface; ++i) assert.ok(Math.abs(after[i] - before[i]) < 1e-5 * diagonal);
  assert.ok(disagreement < 1e-6);
  noErrors();
});

test('a point is picked where it is seen', async () => {
  const node = await freeNode();
  assert.notEqual(node, null);
  const {picked, at, diagonal} = await page.evaluate((v) => {
    const {x, y} = supple.project(v);
    return {picked: supple.pick(x, y), at: supple.position(v), diagonal: supple.about.diagonal};
  }, node);
  assert.ok(distance(picked.point, at) < 0.02 * diagonal);
  assert.equal(await page.evaluate(() => supple.pick(4, 4)), null);
});

test('a dragged point comes to where it is pulled, and is let go', async () => {
  const node = await freeNode();
  await page.evaluate(() => {
    supple.set({pullStiffness: 100});
    supple.ask({do: 'set', damping: {mass: 10, stiffness: 0.02}});
    supple.ask({do: 'play'});
  });
  const start = await page.evaluate((v) => supple.project(v), node);
  const goal = {x: start.x - 30, y: start.y - 70};
  await page.mouse.move(start.x, start.y);
  await page.mouse.down();
  await page.mouse.move(goal.x, goal.y, {steps: 6});
  await until(() => supple.state.pulls.some(({client}) => client === supple.client));
  await until(([v, x, y]) => Math.hypot(supple.project(v).x - x, supple.project(v).y - y) < 10,
    [await page.evaluate(() => supple.state.pulls[0].node), goal.x, goal.y]);
  const ball = await page.evaluate(({x, y}) => supple.pixel(x, y), goal);
  assert.ok(ball[0] > 180 && ball[2] < 120, `an orange ball is at the target, not ${ball}`);
  await page.mouse.up();
  await until(() => supple.state.pulls.length === 0);
  assert.equal(await page.locator('.hint').count(), 0, 'who has pulled needs no hint');
  await page.reload();
  await until(() => window.supple?.ready);
  assert.equal(await page.locator('.hint').count(), 0, 'nor in the next visit');
  noErrors();
});

test('from a pull to a picture in which the point has moved', async (t) => {
  const node = await freeNode();
  await page.evaluate(() => {
    supple.set({pullStiffness: 100});
    supple.ask({do: 'play'});
  });
  await until(() => supple.frame.playing);
  const times = [];
  for (let k = 0; k < 7; ++k) {
    times.push(await page.evaluate((v) => supple.latency(v, supple.position(v).map((c, a) => c + (a === 1 ? 0.2 : 0) * supple.about.diagonal)), node));
    await page.evaluate(() => supple.release());
    await page.waitForTimeout(250);
  }
  const median = times.sort((a, b) => a - b)[3];
  assert.ok(median < 1000);
  t.diagnostic(`median of 7: ${median.toFixed(1)} ms`);
});

test('beside the object a drag turns the view, and f brings it back', async () => {
  const before = await page.evaluate(() => supple.camera.position);
  await page.mouse.move(300, 130);
  await page.mouse.down();
  await page.mouse.move(370, 140, {steps: 4});
  await page.mouse.up();
  await until((from) => Math.hypot(...supple.camera.position.map((c, k) => c - from[k])) > 0.05 * supple.about.diagonal, before);
  assert.equal(await page.evaluate(() => supple.state.pulls.length), 0);
  await page.mouse.wheel(0, -800);
  await page.keyboard.press('f');
  noErrors();
});

test('colours, ghost, wireframe and theme change what is seen', async () => {
  await page.evaluate(() => {
    supple.ask({do: 'set', gravity: [0, -2, 0]});
    supple.ask({do: 'step', count: 40});
  });
  await until(() => supple.frame.steps === 40);
  const node = await freeNode();
  const look = () => page.evaluate((v) => {
    const {x, y} = supple.project(v);
    return supple.pixel(x, y);
  }, node);
  const plain = await look();
  await page.getByRole('button', {name: 'Displacement'}).click();
  const coloured = await look();
  assert.ok(distance(plain, coloured) > 60, `${plain} became ${coloured}`);
  assert.match(await page.textContent('.legend'), /displacement.*m/);
  await page.getByRole('button', {name: 'Plain'}).click();
  await page.keyboard.press('c');
  assert.ok(distance(plain, await look()) > 10, 'the surface is a ghost');
  assert.match(await page.textContent('.legend'), /weight/);
  await page.keyboard.press('c');
  const light = await page.evaluate(() => supple.pixel(400, 110));
  await page.keyboard.press('t');
  const dark = await page.evaluate(() => supple.pixel(400, 110));
  assert.ok(light[0] > 180 && dark[0] < 90, `${light} became ${dark}`);
  await page.emulateMedia({colorScheme: 'dark'});
  await page.evaluate(() => supple.set({theme: 'auto'}));
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), 'dark');
  await page.emulateMedia({colorScheme: 'light'});
  await until(() => document.documentElement.dataset.theme === 'light');
  noErrors();
});

test('a painted region is held in place and freed', async () => {
  const node = await freeNode(), {x, y} = await page.evaluate((v) => supple.project(v), node);
  await page.keyboard.press('b');
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x - 12, y + 4, {steps: 3});
  await page.mouse.up();
  const painted = await page.evaluate(() => supple.selection.length);
  assert.ok(painted > 0);
  await page.getByRole('button', {name: 'Hold in place'}).click();
  await until((count) => supple.state.fixed.length === count, painted);
  await page.evaluate(() => {
    supple.ask({do: 'set', gravity: [0, -4, 0]});
    supple.ask({do: 'step', count: 60});
  });
  await until(() => supple.frame.steps === 60);
  const moved = await page.evaluate(() => {
    const {about, state} = supple;
    return {held: state.fixed[0], at: supple.position(state.fixed[0]), diagonal: about.diagonal};
  });
  await page.getByRole('button', {name: 'Free all'}).click();
  await until(() => supple.state.fixed.length === 0);
  await page.evaluate(() => supple.ask({do: 'reset'}));
  await until(() => supple.frame.steps === 0);
  const rest = await page.evaluate((v) => supple.position(v), moved.held);
  assert.ok(distance(moved.at, rest) < 0.02 * moved.diagonal, 'what is held stays');
  noErrors();
});

test('two handles edit the shape; undo, redo, save, reload and load', async () => {
  await page.getByRole('button', {name: 'Edit', exact: true}).click();
  await until(() => supple.state.mode === 'edit');
  const [near, far] = [await endNodes(0), await endNodes(1)];
  await page.evaluate((nodes) => supple.select(nodes), near);
  await page.getByRole('button', {name: 'Fixed handle'}).click();
  await until(() => supple.state.handles.length === 1);
  await page.evaluate((nodes) => supple.select(nodes), far);
  await page.keyboard.press('Enter');
  await until(() => supple.state.handles.length === 2);

  const node = await freeNode(), before = await page.evaluate((v) => supple.position(v), node);
  const start = await page.evaluate((v) => supple.project(v), node);
  // Grasped by its region: the gizmo of a chosen handle might stand before it.
  await page.evaluate(() => supple.app.chooseHandle(null));
  await page.mouse.move(start.x, start.y);
  await page.mouse.down();
  await page.mouse.move(start.x - 10, start.y - 60, {steps: 5});
  await page.mouse.up();
  await until(() => supple.state.handles.some(({motion}) => motion[3] || motion[7] || motion[11]));
  const diagonal = await page.evaluate(() => supple.about.diagonal);
  await until(([v, from, d]) => Math.hypot(...supple.position(v).map((c, k) => c - from[k])) > 0.03 * d, [node, before, diagonal]);
  const moved = await atRest('JSON.stringify(supple.state.handles.map(({motion}) => motion))');
  assert.ok(await page.evaluate((v) => supple.state.handles[1].nodes.includes(v), node));

  await page.keyboard.press('Control+z');
  await until(([v, from, d]) => Math.hypot(...supple.position(v).map((c, k) => c - from[k])) < 0.01 * d, [node, before, diagonal]);
  await page.keyboard.press('Control+Shift+z');
  await until((motions) => JSON.stringify(supple.state.handles.map(({motion}) => motion)) === motions, moved);

  const [download] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', {name: 'Save'}).click()]);
  const path = join(folder, 'scene.json');
  await download.saveAs(path);
  const scene = JSON.parse(await readFile(path, 'utf8'));
  assert.equal(scene.handles.length, 2);

  await page.reload();
  await until(() => window.supple?.ready && window.supple.state?.handles.length === 2);
  assert.equal(await page.evaluate(() => supple.state.mode), 'edit');
  for (const name of await page.evaluate(() => supple.state.handles.map((h) => h.name)))
    await page.getByRole('button', {name: `Remove ${name}`}).click();
  await until(() => supple.state.handles.length === 0);
  assert.ok(await page.getByRole('button', {name: 'Save'}).isDisabled(), 'there is nothing to save');
  await page.setInputFiles('input[type=file]', path);
  await until(() => supple.state.handles.length === 2);
  assert.deepEqual((await page.evaluate(() => supple.state.handles.map((h) => h.nodes.length))), [near.length, far.length]);
  for (const id of await page.evaluate(() => supple.state.handles.map((h) => h.id))) await page.evaluate((h) => supple.ask({do: 'remove', handle: h}), id);
  noErrors();
});

test('a mode of vibration plays', async (t) => {
  if (!(await page.evaluate(() => supple.about.frequencies.length))) return t.skip('the model has none');
  await page.keyboard.press('3');
  await until(() => supple.state.mode === 'modes');
  await page.getByRole('option').first().click();
  await until(() => Math.max(...supple.frame.values.map(Math.abs)) > 0);
  const node = await freeNode();
  const places = [];
  for (let k = 0; k < 6; ++k) {
    places.push(await page.evaluate((v) => supple.position(v), node));
    await page.waitForTimeout(80);
  }
  const diagonal = await page.evaluate(() => supple.about.diagonal);
  assert.ok(places.some((place) => distance(place, places[0]) > 1e-3 * diagonal));
  await page.getByRole('button', {name: 'Pause'}).click();
  await until(() => !supple.state.playing);
  noErrors();
});

test('files: shapes, a picture, an animation, and a page that plays without a server', async (t) => {
  await page.evaluate(() => {
    supple.ask({do: 'set', gravity: [0, -5, 2]});
    supple.ask({do: 'play'});
  });
  await until(() => supple.frame.steps > 10);
  await page.waitForTimeout(800);
  const sizes = {};
  for (const [label, kind] of [['OBJ', 'obj'], ['PLY', 'ply'], ['PNG', 'png'], ['glTF', 'glb'], ['Page', 'html']]) {
    const [download] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', {name: label, exact: true}).click()]);
    await download.saveAs(join(folder, `shape.${kind}`));
    sizes[kind] = (await readFile(join(folder, `shape.${kind}`))).length;
  }
  t.diagnostic(`bytes: ${JSON.stringify(sizes)}`);
  const head = async (kind) => (await readFile(join(folder, `shape.${kind}`))).subarray(0, 8).toString('latin1');
  assert.match(await head('obj'), /^# /);
  assert.match(await head('ply'), /^ply\n/);
  assert.match(await head('png'), /^\x89PNG/);
  assert.match(await head('glb'), /^glTF/);

  const context = await browser.newContext({viewport: {width: 700, height: 500}, offline: true});
  const alone = await context.newPage(), errors = [], requests = [];
  alone.on('pageerror', (error) => errors.push(error.message));
  alone.on('request', (request) => requests.push(request.url()));
  await alone.goto(`file://${join(folder, 'shape.html')}`);
  await until(() => window.supple?.ready && window.supple.frame, undefined, alone);
  const first = await alone.evaluate(() => supple.frame.number);
  await until((number) => supple.frame.number > number + 3, first, alone);
  assert.ok(await alone.evaluate(() => supple.disagreement()) < 1e-5);
  assert.deepEqual(errors, []);
  assert.deepEqual(requests.filter((url) => !/^(file|data|blob):/.test(url)), []);
  await context.close();
  noErrors();
});

test('a message that is not followed is said', async () => {
  await page.evaluate(() => supple.ask({do: 'set', step: -1}));
  await page.getByText(/^set: /).first().waitFor();
});

test('two pages share a session, each with its own pull', async () => {
  const other = await openPage(browser, server.url);
  const node = await freeNode();
  await page.evaluate((v) => supple.pull(v, supple.position(v).map((c) => c + 0.05 * supple.about.diagonal)), node);
  await other.evaluate((v) => supple.pull(v, supple.position(v).map((c) => c - 0.05 * supple.about.diagonal)), node);
  for (const one of [page, other]) await until(() => supple.state.pulls.length === 2, undefined, one);
  assert.notEqual(await page.evaluate(() => supple.client), await other.evaluate(() => supple.client));
  await other.evaluate(() => supple.ask({do: 'play'}));
  for (const one of [page, other]) await until(() => supple.frame.playing && supple.frame.steps > 5, undefined, one);
  await other.context().close();
  await until(() => supple.state.pulls.length === 1);
  noErrors();
});

test('the page finds a server again that was started anew, and keeps its camera', async (t) => {
  await page.mouse.move(300, 130);
  await page.mouse.down();
  await page.mouse.move(370, 160, {steps: 4});
  await page.mouse.up();
  const camera = await atRest('supple.camera');
  const {port} = server, took = await server.stop();
  t.diagnostic(`the server ended within ${took.toFixed(0)} ms`);
  await until(() => !supple.connected);
  await page.getByText('The server is gone').waitFor();
  server = await startServer({port});
  const reduces = 60_000;  // without a model the server makes one anew
  await until(() => supple.connected && supple.frame.steps === 0 && !supple.state.playing, undefined, page, reduces);
  await page.getByText('The server is gone').waitFor({state: 'hidden'});
  const again = await page.evaluate(() => supple.camera);
  // What is left of the swing when it is too small to be drawn may still come.
  assert.ok(distance(again.position, camera.position) < 0.01 * await page.evaluate(() => supple.about.diagonal));
  await page.keyboard.press('Space');
  await until(() => supple.frame.playing);
  noErrors();
});

test('in no window is anything out of reach or in the way', async () => {
  const small = await openPage(browser, server.url, {hasTouch: true});
  for (const [width, height] of [[390, 780], [800, 500], [1100, 700]]) {
    await small.setViewportSize({width, height});
    await small.evaluate(() => {
      document.querySelector('.toasts').replaceChildren();
      supple.set({panels: true, colours: 'strain', components: true});
    });
    for (const mode of ['modes', 'edit', 'simulate']) {
      await small.evaluate((name) => (supple.ask({do: 'mode', mode: name}), name !== 'edit' && supple.ask({do: 'pause'})), mode);
      await until((name) => supple.state.mode === name && !supple.state.playing, mode, small);
      const wrong = await small.evaluate(() => {
        const boxes = ['header h1', '.modes', '.corner', '.tools', '.panel', '.bottom > .plots', '.transport', '.legend', '.triad', '.hint']
          .map((name) => ({name, box: document.querySelector(name)?.getBoundingClientRect()})).filter(({box}) => box?.width);
        const meet = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1;
        const covered = [...document.querySelectorAll('#app button')].filter((button) => {
          if (button.getClientRects().length === 0) return false;
          button.scrollIntoView({block: 'nearest'});
          const {left, top, width, height} = button.getBoundingClientRect();
          return !button.contains(document.elementFromPoint(left + width / 2, top + height / 2));
        });
        return [
          ...boxes.flatMap(({name, box}, k) => [
            ...(box.left < 0 || box.top < 0 || box.right > innerWidth || box.bottom > innerHeight ? [`${name} is outside`] : []),
            ...boxes.slice(k + 1).filter((other) => meet(box, other.box)).map((other) => `${name} meets ${other.name}`),
          ]),
          ...covered.map((button) => `${button.textContent || button.title} cannot be pressed`),
        ];
      });
      assert.deepEqual(wrong, [], `${width} × ${height}, ${mode}`);
    }
  }
  assert.deepEqual(small.errors, []);
  await small.context().close();
});
