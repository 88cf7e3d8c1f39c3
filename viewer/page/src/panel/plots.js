import {element, inModes} from './widgets.js';
import {percent, quantity} from './quantity.js';

const SPAN = 12;        // seconds that a plot shows
const POINTS = 300;     // of a plot along a recording
const REDRAW = 100;     // milliseconds between pictures of a plot

/** What is plotted: each line is a function of frame and page, with the name of its colour. In replay along the recording. */
const LIVE = ['simulate', 'edit'];
const PLOTS = [
  {title: 'steps', unit: '/s', lines: [['steps', (f) => f.stepsPerSecond]], text: (f) => `${quantity(f.stepsPerSecond)} /s`},
  {title: 'pictures', unit: '/s', lines: [['pictures', (f, page) => page.pictures]], text: (f, page) => `${page.pictures.toFixed(0)} /s`},
  {title: 'a step', lines: [['time', (f) => f.microseconds]], text: (f) => quantity(1e-6 * f.microseconds, 's')},
  {title: 'iterations', lines: [['iterations', (f) => f.iterations]], text: (f) => String(f.iterations)},
  {
    title: 'energy', wide: true, legend: true,
    lines: [['kinetic', (f) => f.kinetic], ['elastic', (f) => f.elastic], ['potential', (f) => f.potential],
      ['total', (f) => f.kinetic + f.elastic + f.potential]],
    text: (f) => quantity(f.kinetic + f.elastic + f.potential, 'J'),
  },
  {title: 'residual', log: true, lines: [['residual', (f) => f.residual]], text: (f) => f.residual.toExponential(1)},
  {
    title: 'error', lines: [['error', (f) => 100 * f.estimate]], help: 'Estimated distance from the full object over the size of the motion',
    text: (f, page) => (Number.isFinite(f.estimate) ? percent(f.estimate) : `– ${page.indicator ? 'not yet' : 'no indicator'}`),
  },
  {
    title: 'measured error', modes: ['replay'], wide: true, lines: [['error', (f) => 100 * f.estimate]],
    help: 'Distance from the second recording over its displacement, root mean squares over the nodes of the surface',
    text: (f) => percent(f.estimate),
  },
];

/** Live plots of the last seconds. */
export class Plots {
  constructor() {
    this.element = element('section', {class: 'plots card', 'aria-label': 'Live plots'});
    this.page = {pictures: 0};
    this.drawnAt = 0;
  }

  setModel({about}) {
    this.page.indicator = about.indicator;
    const compares = about.recording?.names.length > 1;
    this.plots = PLOTS.filter(({modes}) => !modes || compares).map((plot) => new Plot(plot, about.recording));
    this.element.replaceChildren(...this.plots.map((plot) => plot.element));
  }

  /** @param {string} mode  that the frame is of */
  take(frame, mode) {
    const now = performance.now() / 1000;
    for (const plot of this.plots) if (plot.modes.includes(mode)) plot.take(now, frame, this.page);
    this.frame = frame;
  }

  /** Called after each picture; it draws a few times a second. */
  tick(time) {
    this.pictureTimes = (this.pictureTimes ?? []).filter((t) => t > time - 1000);
    this.pictureTimes.push(time);
    this.page.pictures = this.pictureTimes.length;
    if (time - this.drawnAt < REDRAW || !this.frame || this.element.offsetParent === null) return;
    this.drawnAt = time;
    const style = getComputedStyle(this.element);
    for (const plot of this.plots) if (!plot.element.hidden) plot.draw(this.frame, this.page, style);
  }
}

class Plot {
  constructor(plot, recording) {
    this.plot = plot;
    this.modes = plot.modes ?? LIVE;
    this.recording = plot.modes ? recording : null;
    this.points = [];
    this.value = element('output');
    this.canvas = element('canvas', {'aria-hidden': 'true'});
    const keys = plot.legend
      ? element('span', {class: 'keys'}, ...plot.lines.map(([name]) => element('i', {style: `--colour: var(--plot-${name})`}, name)))
      : null;
    this.element = inModes(this.modes.join(' '), element('figure', {class: plot.wide ? 'plot wide' : 'plot', title: plot.help},
      element('figcaption', {}, keys ?? element('span', {}, plot.title), this.value), this.canvas));
  }

  take(now, frame, page) {
    const values = this.plot.lines.map(([, of]) => of(frame, page));
    if (this.recording) {
      this.points[Math.round(POINTS * this.#share(frame.time))] = [frame.time, ...values];
    } else {
      this.points.push([now, ...values]);
      while (this.points[0][0] < now - SPAN) this.points.shift();
    }
  }

  /** Of a recording's duration, 0 … 1. */
  #share(time) {
    const {begin, duration} = this.recording;
    return Math.min(1, Math.max(0, (time - begin) / duration));
  }

  /** Draws up to the last frame, so that a session at rest keeps its plots. */
  draw(frame, page, style) {
    const {canvas, plot} = this, points = Object.values(this.points);  // those of a recording have gaps
    if (points.length === 0) return;
    const now = points.at(-1)[0];
    this.value.textContent = plot.text(frame, page);
    const ratio = window.devicePixelRatio, width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio), canvas.height = Math.round(height * ratio);
    const context = canvas.getContext('2d');
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const scaled = (v) => (plot.log ? Math.log10(Math.max(v, 1e-16)) : v);
    const all = points.flatMap(([, ...values]) => values.map(scaled)).filter(Number.isFinite);
    if (all.length === 0) return;
    let low = Math.min(...all), high = Math.max(...all);
    if (!plot.log) low = Math.min(0, low);
    if (high - low < 1e-12 * Math.abs(high) || high === low) high = low + (Math.abs(low) || 1);
    const y = (v) => height - 2 - (height - 4) * (scaled(v) - low) / (high - low);
    const x = (time) => width * (this.recording ? this.#share(time) : 1 - (now - time) / SPAN);
    context.lineJoin = 'round';
    if (this.recording) {
      context.fillStyle = style.getPropertyValue('--faint');
      context.fillRect(x(frame.time) - 0.5, 0, 1, height);
    }
    plot.lines.forEach(([name], line) => {
      context.strokeStyle = style.getPropertyValue(`--plot-${name}`);
      context.lineWidth = name === 'total' ? 1 : 1.5;
      context.beginPath();
      for (const point of points) {
        if (!Number.isFinite(point[line + 1])) continue;
        context.lineTo(x(point[0]), y(point[line + 1]));
      }
      context.stroke();
    });
  }
}
