import {execFile, spawn} from 'node:child_process';
import {once} from 'node:events';
import {join} from 'node:path';
import {createInterface} from 'node:readline';
import {promisify} from 'node:util';
import {chromium} from 'playwright-core';

const STARTS_WITHIN = 60_000, ENDS_WITHIN = 3_000;  // milliseconds
const NO_MODEL = ['bar:16x4x4', '--fix', 'x<=0'];

const command = process.env.SUPPLE_COMMAND;
if (!command) throw new Error('SUPPLE_COMMAND has to name the program, such as build/release/app/supple');

const running = new Set();
process.on('exit', () => running.forEach((child) => child.kill('SIGKILL')));
for (const signal of ['SIGINT', 'SIGTERM']) process.on(signal, () => process.exit(1));

/** What a command says, such as run('simulate', model, '-o', folder). */
export async function run(...args) {
  return (await promisify(execFile)(command, args)).stdout;
}

/** What SUPPLE_MODEL names, or the bar as a model in a folder. */
export async function modelFile(folder) {
  if (process.env.SUPPLE_MODEL) return process.env.SUPPLE_MODEL;
  const file = join(folder, 'bar.supple');
  await run('reduce', ...NO_MODEL, '-o', file);
  return file;
}

/**
 * Starts `supple view` on what SUPPLE_MODEL names, or on a bar. `options` are more of the command's.
 * @returns {Promise<{url: string, port: number, stop: () => Promise<number>}>}  `stop`: milliseconds that it took to end
 */
export async function startServer({port = 0, model = process.env.SUPPLE_MODEL ? [process.env.SUPPLE_MODEL] : NO_MODEL, options = []} = {}) {
  const page = process.env.SUPPLE_PAGE ? ['--page', process.env.SUPPLE_PAGE] : [];
  const child = spawn(command, ['view', ...model, '--port', String(port), ...page, ...options], {stdio: ['ignore', 'pipe', 'pipe']});
  running.add(child);
  let errors = '';
  child.stderr.on('data', (text) => (errors += text));
  const ended = once(child, 'exit').then(([code]) => {
    running.delete(child);
    return code;
  });
  const address = new Promise((resolve) => createInterface(child.stdout).on('line', (line) => {
    const found = line.match(/https?:\/\/\S+/);
    if (found) resolve(found[0]);
  }));
  const late = new Promise((_, reject) => setTimeout(() => reject(new Error('the server did not start')), STARTS_WITHIN).unref());
  const url = await Promise.race([address, late, ended.then((code) => {
    throw new Error(`the server ended with ${code}: ${errors}`);
  })]);
  return {
    url,
    port: Number(new URL(url).port),
    async stop() {
      const start = performance.now();
      child.kill('SIGINT');
      const timer = setTimeout(() => child.kill('SIGKILL'), ENDS_WITHIN);
      await ended;
      clearTimeout(timer);
      return performance.now() - start;
    },
  };
}

/** A browser that draws with Mesa's llvmpipe, which costs half of what Chromium's own software renderer does. */
export function launchBrowser() {
  return chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--headless=new', '--no-sandbox', '--use-angle=gl-egl', '--ignore-gpu-blocklist'],
  });
}

/** A page that shows the session. Errors in it are collected in `page.errors`. */
export async function openPage(browser, url, options = {}) {
  const context = await browser.newContext({viewport: {width: 1100, height: 700}, colorScheme: 'light', ...options});
  const page = await context.newPage();
  page.errors = [];
  page.on('pageerror', (error) => page.errors.push(error.message));
  await page.goto(url);
  await page.waitForFunction(() => window.supple?.ready && window.supple.state, null, {timeout: 60_000});
  return page;
}

/** Waits until the last picture is as good as it gets. */
export function settled(page) {
  return page.waitForFunction(() => window.supple.settled, null, {timeout: 120_000});
}

/** Waits until something holds in a page. */
export function until(page, holds, argument, timeout = 15_000) {
  return page.waitForFunction(holds, argument, {timeout});
}

/** A node at the far end of the object that is seen and free: where it can be taken. */
export function freeNode(page) {
  return page.evaluate(() => {
    const {about} = supple, axis = [0, 1, 2].reduce((a, b) => (about.high[b] - about.low[b] > about.high[a] - about.low[a] ? b : a));
    const far = Array.from({length: about.surface_nodes}, (_, v) => v).sort((a, b) => supple.position(b)[axis] - supple.position(a)[axis]);
    const around = [[0, 0], [5, 0], [-5, 0], [0, 5], [0, -5]];  // pixels: no node on the outline
    for (const v of far) {
      const {x, y} = supple.project(v);
      if (document.elementFromPoint(x, y)?.tagName !== 'CANVAS') continue;
      if (around.every(([h, k]) => supple.pick(x + h, y + k)) && supple.pick(x, y).node === v) return v;
    }
    return null;
  });
}
