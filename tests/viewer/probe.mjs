// Whether the browser starts here and draws by WebGL 2; ends with 1 and the reason if not.
import {launchBrowser} from './harness.mjs';

const browser = await launchBrowser();
const page = await browser.newPage();
const draws = await page.evaluate(() => Boolean(document.createElement('canvas').getContext('webgl2')));
await browser.close();
if (!draws) {
  console.error('there is no WebGL 2');
  process.exitCode = 1;
}
