/**
 * A session that was recorded: it plays in the page itself, with the events and the `ask` of a LiveSession, as far as
 * these make sense.
 */
export class RecordedSession extends EventTarget {
  /** @param {import('../export/recording.js').Recording} recording */
  constructor(recording) {
    super();
    this.recording = recording;
    this.live = false;
    this.connected = true;
    this.client = 0;
    this.counters = {frames: 0, bytes: 0, connections: 0};
    this.at = 0;        // [s]
    this.speed = 1;
    this.playing = true;
    this.number = 0;
    queueMicrotask(() => {
      this.#emit('model', recording.model);
      this.#tell();
      this.#show();
      requestAnimationFrame((time) => this.#tick(time));
    });
  }

  get duration() {
    return this.recording.times.at(-1);
  }

  ask(message) {
    switch (message.do) {
      case 'play': this.playing = true; break;
      case 'pause': this.playing = false; break;
      case 'reset': this.at = 0; break;
      case 'step': this.playing = false; this.at = Math.min(this.duration, this.at + 1 / 30); break;
      case 'seek': this.at = message.time; break;
      case 'set': this.speed = message.speed; break;
      default: return;
    }
    this.#tell();
    this.#show();
  }

  choose() {}

  drawn() {}

  #tick(time) {
    const passed = Math.min(0.1, (time - (this.last ?? time)) / 1000);
    this.last = time;
    if (this.playing && this.duration > 0) {
      this.at = (this.at + passed * this.speed) % this.duration;
      this.#show();
    }
    requestAnimationFrame((next) => this.#tick(next));
  }

  #show() {
    const {times, coordinates} = this.recording;
    let k = times.findIndex((t) => t > this.at) - 1;
    if (k < 0) k = Math.max(0, times.length - 2);
    const next = Math.min(k + 1, times.length - 1);
    const share = next > k ? Math.min(1, (this.at - times[k]) / (times[next] - times[k])) : 0;
    const values = coordinates[k].map((from, i) => from + share * (coordinates[next][i] - from));
    this.#emit('frame', {
      kind: 'coordinates', number: ++this.number, time: this.at, kinetic: NaN, elastic: NaN, potential: NaN, drift: NaN,
      residual: NaN, iterations: 0, microseconds: NaN, stepsPerSecond: NaN, realTime: this.speed, estimate: NaN,
      playing: this.playing, behind: false, unconverged: false, untrained: false, steps: k, values,
    });
    this.counters.frames++;
  }

  #tell() {
    this.#emit('state', {
      mode: 'replay', playing: this.playing, settings: {speed: this.speed}, handles: [], pulls: [], fixed: [],
      can_undo: false, can_redo: false,
    });
  }

  #emit(type, detail) {
    this.dispatchEvent(new CustomEvent(type, {detail}));
  }
}
