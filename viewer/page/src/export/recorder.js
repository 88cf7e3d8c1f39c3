const SHORTEST = 1 / 31;   // seconds between two kept frames
const MEMORY = 15;         // seconds that are remembered without being asked
const LONGEST = 180;       // seconds of a recording

/** Keeps what was shown: always the last seconds, and all from start to stop. Times are those of the wall clock. */
export class Recorder {
  constructor() {
    this.clear();
  }

  clear() {
    this.times = [];
    this.coordinates = [];
    this.recording = false;
  }

  start() {
    this.clear();
    this.recording = true;
  }

  stop() {
    this.recording = false;
    this.kept = true;  // until the next start, so that what was recorded is what is exported
  }

  /** @param {Float32Array} q  @param {number} now seconds */
  take(q, now) {
    if (this.kept && !this.recording) return;
    if (now - (this.times.at(-1) ?? -Infinity) < SHORTEST) return;
    this.times.push(now);
    this.coordinates.push(q.slice());
    const limit = this.recording ? LONGEST : MEMORY;
    while (this.times[0] < now - limit) this.times.shift(), this.coordinates.shift();
  }

  /** @returns {{times: number[], coordinates: Float32Array[]}} times from 0; no frames if there was nothing to see */
  motion() {
    return {times: this.times.map((t) => t - this.times[0]), coordinates: this.coordinates};
  }
}
