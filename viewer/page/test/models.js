/** A grid of two triangles a cell in the plane z = 0, with a random basis: enough of a model for tests. */
export function sheet({columns = 6, rows = 4, block = 3, fields = 5, seed = 1} = {}) {
  const random = randomNumbers(seed);
  const nodes = columns * rows, rest = new Float32Array(3 * nodes), triangles = [];
  for (let r = 0; r < rows; ++r)
    for (let c = 0; c < columns; ++c) {
      rest.set([c / (columns - 1), r / (columns - 1), 0], 3 * (r * columns + c));
      if (r === 0 || c === 0) continue;
      const v = r * columns + c;
      triangles.push(v - columns - 1, v - columns, v, v - columns - 1, v, v - 1);
    }
  const dimension = block === 3 ? 3 * fields : fields;
  const basis = Float32Array.from({length: (block === 3 ? 1 : 3) * nodes * fields}, () => 0.1 * random());
  return {
    about: {
      name: 'sheet', nodes, surface_nodes: nodes, triangles: triangles.length / 3, block, fields, dimension, components: 1,
      component_nodes: 4, solid: false, low: [0, 0, 0], high: [1, (rows - 1) / (columns - 1), 0],
      diagonal: Math.hypot(1, (rows - 1) / (columns - 1)), fixed: [0], frequencies: [],
    },
    rest, triangles: Uint32Array.from(triangles), basis, nodes: Uint32Array.from({length: nodes}, (_, v) => v),
    components: Uint32Array.of(0, 1, columns, columns + 1), weights: Float32Array.of(2), modes: new Float32Array(0),
  };
}

/** Four nodes and the four triangles between them, seen from outside. */
export function tetrahedron() {
  return {
    about: {nodes: 4},
    rest: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1),
    triangles: Uint32Array.of(0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3),
  };
}

/** Numbers in −1 … 1 that are the same in each run. */
export function randomNumbers(seed) {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return 2 * state / 2 ** 32 - 1;
  };
}

/** X + U q as the protocol defines it, one number after another. */
export function positionsOf({about: {block, fields, nodes}, rest, basis}, q) {
  const x = Float64Array.from(rest);
  for (let v = 0; v < nodes; ++v)
    for (let axis = 0; axis < 3; ++axis)
      for (let f = 0; f < fields; ++f)
        x[3 * v + axis] += block === 3 ? basis[v * fields + f] * q[3 * f + axis] : basis[(3 * v + axis) * fields + f] * q[f];
  return x;
}
