import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {freeNode, launchBrowser, openPage, startServer, until} from './harness.mjs';

let server, browser, address;

before(async () => {
  [server, browser] = await Promise.all([startServer({options: ['--listen', '0.0.0.0']}), launchBrowser()]);
  address = `http://127.0.0.1:${server.port}/`;
});

after(() => Promise.allSettled([browser?.close(), server?.stop()]));

test('who has the token sees the page, also after a reload and without it in the address', async () => {
  const page = await openPage(browser, address + new URL(server.url).search);
  await page.reload();
  await until(page, () => window.supple?.ready && window.supple.frame);
  await page.goto(address);
  await until(page, () => window.supple?.ready && window.supple.frame);
  await page.evaluate(() => supple.ask({do: 'play'}));
  await until(page, () => supple.frame.playing);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('who has none sees nothing', async () => {
  for (const path of ['', 'page.js', 'page.css', 'model.json', 'model/basis.bin', '?token=00000000000000000000000000000000'])
    assert.equal((await fetch(address + path)).status, 401, path);
});

test('a finger pulls, two fingers zoom and turn, wherever they begin', async () => {
  const page = await openPage(browser, address + new URL(server.url).search, {viewport: {width: 390, height: 780}, hasTouch: true});
  const screen = await page.context().newCDPSession(page);
  const touch = (type, ...points) => screen.send('Input.dispatchTouchEvent', {type, touchPoints: points.map(([x, y], id) => ({x, y, id}))});
  const node = await freeNode(page), {x, y} = await page.evaluate((v) => supple.project(v), node);
  await page.evaluate(() => supple.ask({do: 'play'}));
  const before = await page.evaluate((v) => supple.position(v), node);
  await touch('touchStart', [x, y]);
  for (let k = 1; k <= 5; ++k) await touch('touchMove', [x, y - 12 * k]);
  await until(page, () => supple.state.pulls.length === 1);
  await until(page, ([v, from]) => Math.hypot(...supple.position(v).map((c, k) => c - from[k])) > 5e-3 * supple.about.diagonal, [node, before]);
  const camera = await page.evaluate(() => supple.camera);
  await touch('touchStart', [x, y - 60], [x - 80, y - 60]);
  await until(page, () => supple.state.pulls.length === 0);
  for (let k = 1; k <= 5; ++k) await touch('touchMove', [x + 6 * k, y - 60 - 8 * k], [x - 80 - 14 * k, y - 60 - 8 * k]);
  await touch('touchEnd');
  await until(page, ({position, target}) => {
    const away = (p, t) => p.map((c, k) => c - t[k]), now = away(supple.camera.position, supple.camera.target), then = away(position, target);
    const near = Math.hypot(...now) / Math.hypot(...then), along = now.reduce((sum, c, k) => sum + c * then[k], 0) / Math.hypot(...now) / Math.hypot(...then);
    return near < 0.95 && along < Math.cos(0.05);
  }, camera);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});
