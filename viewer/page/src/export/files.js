import {glbOf} from './glb.js';
import {objOf, plyOf} from './meshes.js';
import {standalonePage} from './standalone.js';

/**
 * A file of what the page shows or has recorded.
 * @param {'obj'|'ply'|'glb'|'png'|'html'} kind
 * @param {import('../app.js').App} app
 * @returns {Promise<{name: string, content: BlobPart, type: string}>}
 */
export async function makeFile(kind, app) {
  const {model, stage, recorder} = app, {about, triangles} = model;
  const named = (content, type) => ({name: `${about.name}.${kind}`, content, type});
  const comment = `${about.name}, a shape by Supple`;
  switch (kind) {
    case 'obj': return named(objOf(stage.shape.positions(), about.surface_nodes, triangles, comment), 'model/obj');
    case 'ply': return named(plyOf(stage.shape.positions(), about.surface_nodes, triangles, comment), 'model/ply');
    case 'glb': return named(glbOf(model, recorded(recorder)), 'model/gltf-binary');
    case 'png': return named(await picture(stage), 'image/png');
    case 'html': return named(await standalonePage({model, ...recorded(recorder), view: app.view()}), 'text/html');
    default: throw new Error(`no file of kind ${kind}`);
  }
}

function recorded(recorder) {
  const motion = recorder.motion();
  if (motion.times.length < 2) throw new Error('Nothing has moved yet: play, then export');
  return motion;
}

function picture(stage) {
  stage.drawNow();
  return new Promise((resolve) => stage.canvas.toBlob(resolve, 'image/png'));
}
