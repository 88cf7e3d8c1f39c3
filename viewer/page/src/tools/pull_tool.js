import {DragPlane} from './drag_plane.js';

/** Pulls at the point of the surface under the pointer. With Shift the spring stays when the button is let go. */
export class PullTool {
  /** @param {import('../app.js').App} app */
  constructor(app) {
    this.app = app;
  }

  begin(hit, event) {
    if (!hit) return false;
    const {stage} = this.app;
    this.node = hit.node;
    const at = stage.shape.position(hit.node);
    this.plane = new DragPlane(stage, at, event);
    this.app.pull(this.node, at);
    return true;
  }

  move(event) {
    const target = this.plane.at(event);
    if (target) this.app.pull(this.node, target.toArray());
  }

  end(event) {
    if (!event.shiftKey) this.app.release();
  }
}
