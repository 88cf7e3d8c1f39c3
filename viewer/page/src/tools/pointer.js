import {intersect} from '../geometry/ray.js';

/**
 * Gives drags on the canvas to the tool in hand, and those that it does not want to the camera, as those of two fingers.
 * A tool has `begin(hit, event)`, which says whether it takes the drag, `move(event)`, `end(event)` and, where a drag that
 * is broken off shall do something else than end, `cancel()`.
 */
export class Pointer {
  /** @param {import('../render/stage.js').Stage} stage  @param {() => object|null} tool  the one in hand */
  constructor(stage, tool) {
    this.stage = stage;
    this.tool = tool;
    this.dragging = null;
    const {canvas} = stage;
    canvas.style.touchAction = 'none';
    canvas.addEventListener('pointerdown', (event) => this.#down(event), {capture: true});
    canvas.addEventListener('pointermove', (event) => this.#move(event), {capture: true});
    for (const type of ['pointerup', 'pointercancel'])
      canvas.addEventListener(type, (event) => this.#up(event), {capture: true});
    canvas.addEventListener('dblclick', (event) => {
      const hit = this.pick(event);
      if (hit) stage.focus(hit.point);
    });
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  }

  /** What of the surface is seen at a point of the page. */
  pick(event) {
    const {origin, direction} = this.stage.ray(event), {shape} = this.stage;
    return shape ? intersect(shape.positions(), shape.model.triangles, origin, direction) : null;
  }

  #down(event) {
    this.stage.canvas.focus({preventScroll: true});
    if (this.handing) return;
    if (this.dragging && event.pointerType === 'touch') return this.#handOver(event);
    if (this.dragging) return void event.stopImmediatePropagation();
    const tool = this.tool();
    if (!tool || !event.isPrimary || event.button !== 0 || event.altKey) return;
    if (!tool.begin(tool.aims === false ? null : this.pick(event), event)) return;
    event.stopImmediatePropagation();
    event.preventDefault();
    this.stage.canvas.setPointerCapture(event.pointerId);
    this.dragging = {tool, id: event.pointerId, last: event};
  }

  #move(event) {
    if (!this.dragging) return;
    event.stopImmediatePropagation();
    if (event.pointerId !== this.dragging.id) return;
    this.dragging.last = event;
    this.dragging.tool.move(event);
  }

  /** A second finger has come: both are the camera's, which has not heard of the first one yet. */
  #handOver(event) {
    const {tool, last} = this.dragging;
    this.dragging = null;
    if (tool.cancel) tool.cancel();
    else tool.end(event);
    this.handing = true;
    this.stage.canvas.dispatchEvent(new PointerEvent('pointerdown', last));
    this.handing = false;
  }

  #up(event) {
    if (!this.dragging || event.pointerId !== this.dragging.id) return;
    event.stopImmediatePropagation();
    const {tool} = this.dragging;
    this.dragging = null;
    tool.end(event);
  }
}
