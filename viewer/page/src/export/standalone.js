import {decodeRecording, encodeRecording} from './recording.js';

export const DATA_ID = 'supple-recording';

/** One HTML file of this page with a recording inside, which plays without a server. @returns {Promise<Blob>} */
export async function standalonePage(recording) {
  const [script, style] = await Promise.all([ownScript(), ownStyle()]);
  const data = base64(await through(new CompressionStream('gzip'), encodeRecording(recording)));
  const title = `${recording.model.about.name} – Supple`.replace(/[<&]/g, '');
  // The bundle must not end the element that holds it.
  const safe = script.replaceAll('</script', '<\\/script');
  return new Blob([
    '<!doctype html><html lang="en"><meta charset="utf-8">',
    '<meta name="viewport" content="width=device-width, initial-scale=1">',
    `<title>${title}</title><style>${style}</style><div id="app"></div>`,
    `<script type="text/plain" id="${DATA_ID}">${data}</script>`,
    `<script type="module">${safe}</script></html>`,
  ], {type: 'text/html'});
}

/** The recording inside this page, if it is such a page. */
export async function embeddedRecording() {
  const holder = document.getElementById(DATA_ID);
  if (!holder) return null;
  const packed = Uint8Array.from(atob(holder.textContent), (c) => c.charCodeAt(0));
  return decodeRecording(await through(new DecompressionStream('gzip'), packed));
}

async function ownScript() {
  const linked = document.querySelector('script[type=module][src]');
  return linked ? (await fetch(linked.src)).text() : document.querySelector('script[type=module]').textContent;
}

async function ownStyle() {
  const linked = document.querySelector('link[rel=stylesheet]');
  return linked ? (await fetch(linked.href)).text() : document.querySelector('style').textContent;
}

async function through(transform, bytes) {
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(transform)).arrayBuffer());
}

function base64(bytes) {
  let text = '';
  for (let k = 0; k < bytes.length; k += 0x8000) text += String.fromCharCode(...bytes.subarray(k, k + 0x8000));
  return btoa(text);
}
