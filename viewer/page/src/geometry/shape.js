import {fansOf} from './fans.js';
import {ringsOf} from './rings.js';
import {strainsOf} from './strain.js';

/**
 * The shape at this moment on the processor: x = X + U q in double precision, computed when somebody asks. Picking,
 * regions and exports use it; drawing does not.
 */
export class Shape {
  /**
   * @param {import('../session/model.js').Model} model
   * @param {Shape} [like]   another shape of the model, whose surface it shares
   */
  constructor(model, like) {
    this.model = model;
    this.q = new Float64Array(model.about.dimension);
    this.displacements = null;  // of the surface's nodes, where a server streams positions
    this.rings = like?.rings ?? ringsOf(model.triangles, model.about.nodes);
    this.fans = like?.fans ?? fansOf(model.rest, model.triangles, this.rings);
    this.stale = true;
    this.cached = new Float64Array(3 * model.about.nodes);
    this.samples = evenSamples(model.about.surface_nodes, 400);
  }

  /** @param {import('../session/frame.js').Frame} frame */
  take(frame) {
    if (frame.kind === 'coordinates') {
      this.q.set(frame.values);
      this.displacements = null;
    } else {
      this.displacements = frame.values;
    }
    this.stale = true;
  }

  /** All positions, nodes × 3; valid until the next frame. */
  positions() {
    if (this.stale) this.#deform();
    this.stale = false;
    return this.cached;
  }

  /** Position of one node, at the price of one row of the basis. */
  position(node, out = [0, 0, 0]) {
    const {about: {block, fields, surface_nodes}, rest, basis} = this.model;
    for (let axis = 0; axis < 3; ++axis) {
      let u = 0;
      if (this.displacements) {
        u = node < surface_nodes ? this.displacements[3 * node + axis] : 0;
      } else if (block === 3) {
        for (let f = 0, row = node * fields; f < fields; ++f) u += basis[row + f] * this.q[3 * f + axis];
      } else {
        for (let f = 0, row = (3 * node + axis) * fields; f < fields; ++f) u += basis[row + f] * this.q[f];
      }
      out[axis] = rest[3 * node + axis] + u;
    }
    return out;
  }

  /**
   * What a few hundred nodes tell of the whole: a ball around the shape, and the largest displacement.
   * @returns {{centre: number[], radius: number, displacement: number}}
   */
  extent() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity], x = [0, 0, 0];
    let displacement = 0;
    for (const node of this.samples) {
      this.position(node, x);
      let squared = 0;
      for (let axis = 0; axis < 3; ++axis) {
        low[axis] = Math.min(low[axis], x[axis]);
        high[axis] = Math.max(high[axis], x[axis]);
        squared += (x[axis] - this.model.rest[3 * node + axis]) ** 2;
      }
      displacement = Math.max(displacement, squared);
    }
    const centre = low.map((l, axis) => (l + high[axis]) / 2);
    return {centre, radius: Math.hypot(...low.map((l, axis) => high[axis] - l)) / 2, displacement: Math.sqrt(displacement)};
  }

  /** Largest distance of the same few hundred nodes from those of another shape of the model. */
  distance(other) {
    let squared = 0;
    for (const node of this.samples) {
      const x = this.position(node), y = other.position(node);
      squared = Math.max(squared, (x[0] - y[0]) ** 2 + (x[1] - y[1]) ** 2 + (x[2] - y[2]) ** 2);
    }
    return Math.sqrt(squared);
  }

  /** Normals of the vertices that are drawn, weighted by area; 0 for those without a triangle. */
  normals() {
    const x = this.positions(), {count, nodeOf, rings: {starts, pairs}} = this.fans;
    const normals = new Float32Array(3 * count);
    for (let v = 0; v < count; ++v) {
      let nx = 0, ny = 0, nz = 0;
      for (let k = starts[v]; k < starts[v + 1]; ++k) {
        const b = 3 * pairs[2 * k], c = 3 * pairs[2 * k + 1], a = 3 * nodeOf[v];
        const bx = x[b] - x[a], by = x[b + 1] - x[a + 1], bz = x[b + 2] - x[a + 2];
        const cx = x[c] - x[a], cy = x[c + 1] - x[a + 1], cz = x[c + 2] - x[a + 2];
        nx += by * cz - bz * cy, ny += bz * cx - bx * cz, nz += bx * cy - by * cx;
      }
      const length = Math.hypot(nx, ny, nz) || 1;
      normals[3 * v] = nx / length, normals[3 * v + 1] = ny / length, normals[3 * v + 2] = nz / length;
    }
    return normals;
  }

  /** Strain of the surface at the vertices that are drawn. */
  strains() {
    return strainsOf(this.model.rest, this.positions(), this.fans);
  }

  #deform() {
    const {about: {block, fields, nodes}, rest, basis} = this.model;
    const {q, cached: x} = this;
    if (this.displacements) {
      x.set(rest);
      for (let i = 0; i < this.displacements.length; ++i) x[i] += this.displacements[i];
    } else if (block === 3) {
      for (let v = 0; v < nodes; ++v) {
        let ux = 0, uy = 0, uz = 0;
        for (let f = 0, row = v * fields; f < fields; ++f) {
          const w = basis[row + f];
          ux += w * q[3 * f], uy += w * q[3 * f + 1], uz += w * q[3 * f + 2];
        }
        x[3 * v] = rest[3 * v] + ux, x[3 * v + 1] = rest[3 * v + 1] + uy, x[3 * v + 2] = rest[3 * v + 2] + uz;
      }
    } else {
      for (let i = 0; i < 3 * nodes; ++i) {
        let u = 0;
        for (let f = 0, row = i * fields; f < fields; ++f) u += basis[row + f] * q[f];
        x[i] = rest[i] + u;
      }
    }
  }
}

function evenSamples(count, wanted) {
  const step = Math.max(1, count / wanted);
  return Uint32Array.from({length: Math.min(count, wanted)}, (_, k) => Math.floor(k * step));
}
