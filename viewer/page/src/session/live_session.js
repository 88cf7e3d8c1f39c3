import {parseFrame} from './frame.js';
import {fetchModel} from './model.js';

const FIRST_RETRY = 300, LONGEST_RETRY = 5000;  // milliseconds

/**
 * A session on a server. It connects again after the connection is lost, for as long as the page is open.
 *
 * Events, each with its `detail`: `connection` (whether there is one), `progress` ({stage, share}), `model` (a Model,
 * after each connection), `state`, `frame`, `warning` (a text), `refused` ({do, reason}), `saved` (a scene).
 */
export class LiveSession extends EventTarget {
  /** @param {Location|URL} address of the page */
  constructor(address) {
    super();
    this.base = new URL('.', address.href).href;
    this.search = address.search;
    this.live = true;
    this.client = 0;
    this.stream = 'coordinates';
    this.counters = {frames: 0, bytes: 0, connections: 0};
    this.retry = FIRST_RETRY;
    this.unacknowledged = 0;
    document.addEventListener('visibilitychange', () => this.#acknowledgeLate());
    this.#connect();
  }

  get connected() {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  /** Sends a message, such as {do: 'play'}; it is lost without a connection, as is the session it was meant for. */
  ask(message) {
    if (this.connected) this.socket.send(JSON.stringify(message));
  }

  /** Chooses what frames carry; remembered over reconnection. */
  choose(stream) {
    this.stream = stream;
    this.ask({do: 'stream', what: stream});
  }

  /** Says that a frame of positions was drawn: these are large, so that no more of them come than can be shown. */
  drawn(frame) {
    if (frame.kind === 'positions') this.#acknowledge(frame.number);
  }

  #connect() {
    const address = new URL('session' + this.search, this.base);
    address.protocol = address.protocol === 'https:' ? 'wss:' : 'ws:';
    const socket = this.socket = new WebSocket(address);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.retry = FIRST_RETRY;
      this.counters.connections++;
      if (this.stream !== 'coordinates') this.choose(this.stream);
      this.#emit('connection', true);
      this.#load(socket);
    };
    socket.onmessage = ({data}) => (typeof data === 'string' ? this.#hear(JSON.parse(data)) : this.#receive(data));
    socket.onclose = () => {
      this.#emit('connection', false);
      setTimeout(() => this.#connect(), this.retry);
      this.retry = Math.min(2 * this.retry, LONGEST_RETRY);
    };
  }

  async #load(socket) {
    try {
      const model = await fetchModel(this.base, this.search);
      if (model && socket === this.socket) this.#emit('model', model);
    } catch (error) {
      this.#emit('warning', error.message);
    }
  }

  #hear(message) {
    switch (message.say) {
      case 'hello': this.client = message.client; break;
      case 'ready': this.#load(this.socket); break;
      case 'warning': this.#emit('warning', message.text); break;
      case 'saved': this.#emit('saved', message.scene); break;
      default: this.#emit(message.say, message);
    }
  }

  #receive(buffer) {
    const frame = parseFrame(buffer);
    this.counters.frames++;
    this.counters.bytes += buffer.byteLength;
    this.#emit('frame', frame);
    if (frame.kind === 'coordinates') this.#acknowledge(frame.number);
  }

  /** A page that nobody sees asks for no more frames until somebody does. */
  #acknowledge(number) {
    if (document.hidden) this.unacknowledged = number;
    else this.ask({do: 'ack', frame: number});
  }

  #acknowledgeLate() {
    if (document.hidden || !this.unacknowledged) return;
    this.ask({do: 'ack', frame: this.unacknowledged});
    this.unacknowledged = 0;
  }

  #emit(type, detail) {
    this.dispatchEvent(new CustomEvent(type, {detail}));
  }
}
