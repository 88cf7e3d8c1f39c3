/**
 * The reduced model as it is drawn: fetched once, never changed.
 *
 * @typedef {object} Description  model.json; see docs/viewer-protocol.md
 *
 * @typedef {object} Model
 * @property {Description} about
 * @property {Float32Array} rest         nodes × 3 [m]
 * @property {Uint32Array} triangles     triangles × 3
 * @property {Float32Array} basis        rows of U at the nodes, or of W where `about.block` is 3
 * @property {Uint32Array} nodes         index of each node in the mesh
 * @property {Uint32Array} components    corners of the selected components
 * @property {Float32Array} weights      of the selected components
 * @property {Float32Array} modes        modes × dimension
 */

const ARRAYS = {
  rest: ['positions', Float32Array], triangles: ['triangles', Uint32Array], basis: ['basis', Float32Array],
  nodes: ['nodes', Uint32Array], components: ['components', Uint32Array], weights: ['weights', Float32Array],
  modes: ['modes', Float32Array],
};

/** How long each array of a model has to be. */
export function expectedLengths(about) {
  const rows = about.block === 3 ? about.nodes : 3 * about.nodes;
  return {
    rest: 3 * about.nodes,
    triangles: 3 * about.triangles,
    basis: rows * about.fields,
    nodes: about.nodes,
    components: about.components * about.component_nodes,
    weights: about.components,
    modes: about.frequencies.length * about.dimension,
  };
}

/**
 * @param {string} base     address of the page, with its closing slash
 * @param {string} search   query of the page's address: it carries the token where the server asks for one
 * @returns {Promise<Model|null>}  null while the server has no model yet
 */
export async function fetchModel(base, search) {
  const get = (path) => fetch(new URL(path + search, base), {cache: 'no-store'});
  const answer = await get('model.json');
  if (answer.status === 503) return null;
  if (!answer.ok) throw new Error(`the server answers ${answer.status} to model.json`);
  const model = {about: await answer.json()};
  const lengths = expectedLengths(model.about);
  await Promise.all(Object.entries(ARRAYS).map(async ([key, [file, Type]]) => {
    if (lengths[key] === 0) return void (model[key] = new Type(0));
    const response = await get(`model/${file}.bin`);
    if (!response.ok) throw new Error(`the server answers ${response.status} to ${file}.bin`);
    model[key] = new Type(await response.arrayBuffer());
    if (model[key].length !== lengths[key])
      throw new Error(`${file}.bin has ${model[key].length} numbers, expected ${lengths[key]}`);
  }));
  return model;
}
