import {boxed, brushed} from '../geometry/regions.js';

/** Paints nodes into the selection, or with Ctrl out of it. */
export class BrushTool {
  constructor(app) {
    this.app = app;
  }

  begin(hit, event) {
    if (!hit) return false;
    this.#dab(hit, event);
    return true;
  }

  move(event) {
    const hit = this.app.pointer.pick(event);
    if (hit) this.#dab(hit, event);
  }

  end() {}

  #dab(hit, event) {
    const {shape} = this.app.stage;
    const radius = this.app.options.brush * shape.model.about.diagonal;
    const nodes = brushed(shape.positions(), shape.rings, hit.node, hit.point, radius);
    this.app.select(nodes, event.ctrlKey || event.metaKey ? 'remove' : 'add');
  }
}

/** Selects what a rectangle covers, at any depth; with Shift in addition, with Ctrl it is taken out. */
export class BoxTool {
  aims = false;

  constructor(app) {
    this.app = app;
    this.frame = document.createElement('div');
    this.frame.className = 'rubber-band';
  }

  begin(_, event) {
    this.from = [event.clientX, event.clientY];
    document.body.append(this.frame);
    this.move(event);
    return true;
  }

  move(event) {
    const [x, y] = this.from;
    Object.assign(this.frame.style, {
      left: `${Math.min(x, event.clientX)}px`, top: `${Math.min(y, event.clientY)}px`,
      width: `${Math.abs(event.clientX - x)}px`, height: `${Math.abs(event.clientY - y)}px`,
    });
  }

  cancel() {
    this.frame.remove();
  }

  end(event) {
    this.frame.remove();
    const {stage} = this.app, area = stage.canvas.getBoundingClientRect();
    const h = [this.from[0], event.clientX].map((x) => 2 * (x - area.left) / area.width - 1).sort((a, b) => a - b);
    const v = [this.from[1], event.clientY].map((y) => 1 - 2 * (y - area.top) / area.height).sort((a, b) => a - b);
    const nodes = boxed(stage.shape.positions(), stage.shape.model.about.surface_nodes, stage.viewMatrix(),
      {left: h[0], right: h[1], bottom: v[0], top: v[1]});
    this.app.select(nodes, event.ctrlKey || event.metaKey ? 'remove' : event.shiftKey ? 'add' : 'replace');
  }
}
