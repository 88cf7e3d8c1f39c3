import {count, percent, quantity} from './quantity.js';
import {helpDialog} from './help.js';
import {Hint} from './hint.js';
import {ICONS} from './icons.js';
import {Labels} from './labels.js';
import {Legend} from './legend.js';
import {Panel} from './panel.js';
import {Plots} from './plots.js';
import {Toasts} from './toasts.js';
import {Triad} from './triad.js';
import {button, element, inModes, segments} from './widgets.js';

const NARROW = 720, LOW = 480;  // pixels: smaller pages have their plots in the panel

/** Where everything is on the page. */
export class Layout {
  /** @param {HTMLElement} root  @param {import('../app.js').App} app */
  constructor(root, app) {
    this.app = app;
    const {live} = app.session;
    const ask = (what) => () => app.session.ask({do: what});
    this.stage = element('main', {class: 'stage'});
    this.toasts = new Toasts();
    this.hint = new Hint();
    this.triad = new Triad();
    this.labels = new Labels();
    this.plots = new Plots();
    this.legend = new Legend();
    this.legend.show('colours', null);
    this.panel = new Panel(app);
    this.help = helpDialog({live});

    this.name = element('h1', {}, 'Supple');
    this.facts = element('p', {});
    this.modes = segments('What is done with the object', [['simulate', 'Simulate', '1'], ['edit', 'Edit', '2'], ['modes', 'Modes', '3'],
      ['replay', 'Replay', '4']],
      (mode) => app.session.ask({do: 'mode', mode}));
    this.toolBar = segments('Tool', [
      ['pull', ICONS.pull, 'Pull (p)'], ['brush', ICONS.brush, 'Select with a brush (b)'],
      ['box', ICONS.box, 'Select with a box (x)'], ['move', ICONS.move, 'Move handles (m)'],
    ], (tool) => app.setOptions({tool}));
    this.toolBar.classList.add('tools');
    inModes('simulate edit', this.toolBar);
    for (const [tool, mode] of [['pull', 'simulate'], ['move', 'edit']]) inModes(mode, this.toolBar.querySelector(`[data-value=${tool}]`));
    this.play = button('Play', () => app.session.ask({do: app.state?.playing ? 'pause' : 'play'}),
      {icon: ICONS.play, title: 'Play or pause (Space)', kind: 'round main'});
    this.record = button('Record', () => this.#record(), {icon: ICONS.record, title: 'Record for .glb and .html', kind: 'round record'});
    this.clock = element('output', {class: 'clock', 'aria-label': 'Time of the session'});
    this.badge = element('span', {class: 'badge', hidden: true});
    this.seek = element('input', {type: 'range', class: 'seek', min: 0, step: 'any', 'aria-label': 'Time',
      oninput: () => app.session.ask({do: 'seek', time: this.seek.valueAsNumber})});
    this.transport = element('div', {class: 'transport card'},
      inModes('simulate edit replay', button('Reset', ask('reset'), {icon: ICONS.reset, title: 'Back to the start (r)', kind: 'round'})),
      inModes('simulate modes replay', this.play),
      inModes('simulate replay', button('Step', ask('step'), {icon: ICONS.step, title: 'One step (.)', kind: 'round'})),
      inModes('simulate edit modes', this.record), inModes('replay', this.seek), inModes('simulate replay', this.clock), this.badge);
    inModes('simulate edit replay', this.plots.element);
    this.progress = element('div', {class: 'progress card'}, element('h2', {}, 'Waiting for the server'),
      element('progress', {max: 1}), element('p', {}, ''));
    this.connection = element('div', {class: 'connection', role: 'status', hidden: true}, 'The server is gone. Waiting for it to come back …');
    const corner = element('div', {class: 'corner'},
      button('Show the whole object', () => app.stage.frame(), {icon: ICONS.frame, title: 'Show the whole object (f)', kind: 'round'}),
      button('Screenshot', () => app.save('png'), {icon: ICONS.camera, title: 'Screenshot (s)', kind: 'round'}),
      button('Dark or light', () => app.setOptions({theme: document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark'}),
        {icon: ICONS.theme, title: 'Dark or light (t)', kind: 'round'}),
      button('Keys', () => this.toggleHelp(), {icon: ICONS.help, title: 'Keys (?)', kind: 'round'}),
      button('Panels', () => app.setOptions({panels: !app.options.panels}), {icon: ICONS.panel, title: 'Hide or show panels (h)', kind: 'round'}));
    this.root = root;
    root.classList.add('waiting');
    this.bottom = element('div', {class: 'bottom'}, this.transport, this.legend.element);
    const notices = element('div', {class: 'notices'}, this.connection, live && !this.hint.seen ? this.hint.element : null, this.toasts.element);
    root.append(this.stage, this.labels.element, element('header', {}, this.name, this.facts), ...(live ? [this.modes, this.toolBar] : []), corner,
      this.panel.element, this.bottom, this.triad.element, notices, this.help, this.progress);
    this.modes.classList.add('modes');
    new ResizeObserver(() => this.#arrange()).observe(root);
  }

  setModel(model, session) {
    const {about} = model;
    this.root.classList.remove('waiting');
    document.title = `${about.name} – Supple`;
    this.name.textContent = about.name;
    const of = about.solid ? 'solid' : 'shell';
    const error = about.full_error > 0 ? ` · ${percent(about.full_error)} off the full object` : '';
    this.facts.replaceChildren(`${of} of ${count(about.surface_nodes)} vertices`, element('br'),
      `${about.dimension} unknowns · ${about.components} components${error}`);
    this.plots.setModel(model);
    this.panel.setModel(model);
    const {begin, duration} = about.recording ?? {begin: 0, duration: session.duration};
    this.seek.min = begin;
    this.seek.max = this.end = begin + duration;
    this.modes.querySelector('[data-value=replay]').hidden = !about.recording;
  }

  showState(state) {
    this.modes.show(state.mode);
    for (const part of this.root.querySelectorAll('[data-for]')) part.hidden = !part.dataset.for.split(' ').includes(state.mode);
    this.play.innerHTML = state.playing ? ICONS.pause : ICONS.play;
    this.play.setAttribute('aria-label', state.playing ? 'Pause' : 'Play');
  }

  showOptions({tool, panels}) {
    this.toolBar.show(tool);
    this.root.classList.toggle('bare', !panels);
    this.clearPanel();
  }

  #arrange() {
    const {clientWidth: width, clientHeight: height} = this.root;
    if (this.app.session.live) (width <= NARROW || height < LOW ? this.panel.element : this.bottom).append(this.plots.element);
    this.clearPanel();
  }

  /** Tells the stage how much of it the panel covers. */
  clearPanel() {
    const panel = this.panel.element.getBoundingClientRect(), whole = this.root.getBoundingClientRect();
    const shown = panel.width > 0, beside = panel.left > 0.4 * whole.width;
    this.app.stage?.setInset(shown && beside ? whole.right - panel.left : 0, shown && !beside ? whole.bottom - panel.top : 0);
  }

  showFrame(frame) {
    const replays = this.app.mode === 'replay';
    this.clock.textContent = replays ? `${frame.time.toFixed(2)} / ${this.end.toFixed(2)} s` : `${frame.time.toFixed(2)} s`;
    if (replays && !this.seek.matches(':active')) this.seek.value = frame.time;
    this.seek.style.setProperty('--share', (this.seek.valueAsNumber - this.seek.min) / (this.seek.max - this.seek.min));
    const said = frame.unconverged ? ['bad', 'last step did not converge']
      : frame.behind ? ['slow', `${quantity(frame.realTime)} × real time`]
      : frame.untrained ? ['slow', 'beyond what was trained'] : null;
    this.badge.hidden = !said;
    if (said) this.badge.className = `badge ${said[0]}`, this.badge.textContent = said[1];
  }

  showConnection(connected) {
    this.connection.hidden = connected || !this.app.ready;
    this.root.classList.toggle('offline', !connected);
  }

  /** @param {string|null} stage  what is being done, or null when it is done */
  showProgress(stage, share) {
    this.progress.hidden = stage === null;
    if (stage === null) return;
    this.progress.querySelector('h2').textContent = 'Reducing the object';
    this.progress.querySelector('p').textContent = stage;
    this.progress.querySelector('progress').value = share;
  }

  toggleHelp() {
    if (this.help.open) this.help.close();
    else this.help.showModal();
  }

  #record() {
    const {recorder} = this.app;
    if (recorder.recording) recorder.stop();
    else recorder.start();
    this.record.setAttribute('aria-pressed', String(recorder.recording));
    this.toasts.say(recorder.recording ? 'Recording: export as .glb or .html afterwards'
      : `${recorder.motion().times.at(-1)?.toFixed(1) ?? 0} s recorded: see Export`);
  }
}
