const SLOW = 45, FAST = 22;      // milliseconds between pictures
const COARSEST = 0.5;            // scale
const WINDOW = 6;                // pictures that a judgement takes
const PATIENCE = 150;            // milliseconds of rest after which a fine picture is worth its time

/**
 * Draws coarser while things move on machines that are slow, and finely when they rest. It looks at pictures that
 * follow each other as fast as the browser can, so that a session which sends few frames is not taken for a slow page.
 * A scale is pixels of a picture over those of the screen, along each side.
 */
export class Quality {
  /**
   * @param {(scale: number) => void} apply
   * @param {number} finest  scale at rest: more than 1 where nothing else smooths edges
   */
  constructor(apply, finest) {
    this.apply = apply;
    this.finest = finest;
    this.moving = 1;  // scale while things move
    this.shown = 1;
    this.intervals = [];
  }

  /** Whether the last picture is a fine one. */
  get fine() {
    return this.shown === this.finest;
  }

  /** Before a picture at `time`. @param {boolean} pressed  whether it was asked for as soon as the last was done */
  begin(time, pressed) {
    clearTimeout(this.timer);
    if (pressed && this.last !== undefined) this.#judge(time - this.last);
    else this.intervals = [];
    this.last = time;
    this.#show(this.moving);
  }

  /** After it. @param {() => void} redraw  draws once more, finely */
  end(redraw) {
    if (!this.fine) this.timer = setTimeout(redraw, PATIENCE);
  }

  /** Before a picture that is to be fine. */
  rest() {
    clearTimeout(this.timer);
    this.last = undefined;
    this.#show(this.finest);
  }

  #judge(interval) {
    this.intervals.push(interval);
    if (this.intervals.length < WINDOW) return;
    const median = this.intervals.sort((a, b) => a - b)[WINDOW >> 1];
    this.intervals = [];
    if (median > SLOW) this.moving = Math.max(COARSEST, this.moving * Math.max(0.6, Math.sqrt(SLOW / median)));
    else if (median < FAST) this.moving = Math.min(1, this.moving * 1.15);
  }

  #show(scale) {
    if (scale === this.shown || Math.abs(scale - this.shown) < 0.02 && scale < 1) return;
    this.shown = scale;
    this.apply(scale);
  }
}

/** Whether pictures are drawn by the processor. */
export function drawsInSoftware() {
  const gl = document.createElement('canvas').getContext('webgl2');
  const info = gl?.getExtension('WEBGL_debug_renderer_info');
  const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : '';
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return /llvmpipe|swiftshader|software/i.test(name);
}
