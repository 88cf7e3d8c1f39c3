import {count, quantity} from './quantity.js';
import {ICONS} from './icons.js';
import {REGION_COLOURS} from '../render/themes.js';
import {button, buttons, choice, element, inModes, note, section, segments, slider, toggle, vector} from './widgets.js';

/** The panel at the side: what can be set, by mode. */
export class Panel {
  /** @param {import('../app.js').App} app */
  constructor(app) {
    this.app = app;
    const {live} = app.session;
    this.element = element('aside', {class: 'panel card', 'aria-label': 'Settings'});
    if (live) this.element.append(this.#time(), this.#forces(), this.#editing(), this.#vibrations(), this.#selection());
    this.element.append(this.#playback());
    this.element.append(this.#view(), ...(live ? [this.#export()] : []));
  }

  setModel({about}) {
    if (!this.app.session.live) return;
    this.integrator.querySelector('select').replaceChildren(
      ...about.integrators.map((name) => element('option', {value: name}, name.replaceAll('-', ' '))));
    this.axis = this.app.stage.axis;
    this.modeList.replaceChildren(...about.frequencies.map((frequency, k) => element('button', {
      type: 'button', role: 'option', onclick: () => this.app.showMode(k),
    }, element('span', {}, String(k + 1)), quantity(frequency, 'Hz'))));
  }

  showState({settings, fixed, handles, can_undo, can_redo}) {
    this.playbackSpeed.show(settings.speed);
    if (!this.app.session.live) return;
    this.speed.show(settings.speed);
    this.step.show(1000 * settings.step);
    this.stiffness.show(settings.stiffness);
    this.massDamping.show(settings.damping.mass);
    this.stiffnessDamping.show(settings.damping.stiffness);
    this.integrator.show(settings.integrator);
    this.gravity.show(settings.gravity);
    this.floor.show(settings.floor !== null);
    this.floorHeight.hidden = settings.floor === null;
    if (settings.floor) this.floorHeight.show(settings.floor.height);
    this.free.disabled = fixed.length === 0;
    this.undo.disabled = !can_undo;
    this.redo.disabled = !can_redo;
    this.save.disabled = handles.length === 0;
  }

  showOptions(options) {
    this.colours.show(options.colours);
    this.colours.querySelector('[data-value=error]').hidden = this.overlay.hidden = !this.app.compares;
    this.overlay.show(options.overlay);
    this.strainRange.hidden = options.colours !== 'strain';
    this.strainRange.show(100 * options.strainRange);
    for (const name of ['wireframe', 'components', 'regions']) this[name]?.show(options[name]);
    if (!this.app.session.live) return;
    this.brush.show(100 * options.brush);
    this.pull.show(options.pullStiffness);
    this.gizmo.show(options.gizmo);
    this.amplitude.show(100 * options.amplitude);
    this.positions.show(options.stream === 'positions');
  }

  showSelection(size) {
    this.selected.textContent = size ? `${count(size)} vertices selected` : 'Paint with the brush (b) or draw a box (x).';
    for (const act of [this.hold, this.fix, this.make, this.drop]) act.disabled = size === 0;
  }

  showHandles({handles}, chosen) {
    if (!this.app.session.live) return;
    this.handleList.replaceChildren(...handles.map(({id, name, nodes, movable}) => {
      const {handles: colours, anchors} = REGION_COLOURS;
      const colour = movable ? colours[(id - 1) % colours.length] : anchors;
      return element('div', {class: 'handle', 'aria-current': String(id === chosen)},
        element('button', {type: 'button', class: 'name', onclick: () => {
          this.app.chooseHandle(id);
          this.app.setOptions({tool: 'move'});
        }}, element('i', {style: `background: rgb(${colour})`}), name, element('small', {}, `${count(nodes.length)}${movable ? '' : ', held'}`)),
        button(`Remove ${name}`, () => this.app.session.ask({do: 'remove', handle: id}), {icon: ICONS.remove, kind: 'small'}));
    }));
  }

  showMode(index) {
    [...this.modeList.children].forEach((b, k) => b.setAttribute('aria-selected', String(k === index)));
  }

  #set(settings) {
    this.app.session.ask({do: 'set', ...settings});
  }

  #time() {
    this.speed = slider('Speed', {low: 0.01, high: 10, log: true, unit: '×', title: 'Session time over wall-clock time'},
      (speed) => this.#set({speed}));
    this.step = slider('Time step', {low: 0.05, high: 50, log: true, unit: 'ms'}, (ms) => this.#set({step: ms / 1000}));
    this.integrator = choice('Integrator', [], (integrator) => this.#set({integrator}));
    const made = section('Time', this.speed, this.step, this.integrator);
    return inModes('simulate', made);
  }

  #forces() {
    const {app} = this;
    this.pull = slider('Pull', {low: 0.01, high: 100, log: true, unit: '×', title: 'Stiffness of the spring, over the default'},
      (pullStiffness) => app.setOptions({pullStiffness}));
    this.gravity = vector('Gravity', 'm/s²', (gravity) => this.#set({gravity}));
    const along = (g) => [0, 1, 2].map((axis) => (axis === this.axis ? g : 0));
    this.stiffness = slider('Stiffness', {low: 1e-3, high: 1e3, log: true, unit: '×'}, (stiffness) => this.#set({stiffness}));
    this.massDamping = slider('Drag', {low: 0, high: 10, unit: '1/s', title: 'Damping proportional to mass'}, (mass) => this.#damp({mass}));
    this.stiffnessDamping = slider('Viscosity', {low: 0, high: 0.02, unit: 's', title: 'Damping proportional to stiffness'},
      (stiffness) => this.#damp({stiffness}));
    const below = ({low, diagonal}) => low[this.axis] - 0.02 * diagonal;
    this.floor = toggle('Floor', (on) => this.#set({floor: on ? this.#floorAt(below(app.model.about)) : null}));
    this.floorHeight = slider('Its height', {low: 0, high: 1, unit: 'm', title: 'Height of the floor'},
      (height) => this.#set({floor: this.#floorAt(height)}));
    this.floorHeight.querySelector('input[type=range]').hidden = true;
    const made = section('Forces', this.pull, this.gravity,
      buttons(button('None', () => this.#set({gravity: [0, 0, 0]})), button('Earth', () => this.#set({gravity: along(-9.81)})),
        button('Sideways', () => this.#set({gravity: [9.81, 0, 0]}))),
      this.stiffness, this.massDamping, this.stiffnessDamping, this.floor, this.floorHeight);
    return inModes('simulate', made);
  }

  #damp(part) {
    this.#set({damping: {...this.app.state.settings.damping, ...part}});
  }

  #floorAt(height) {
    return {axis: 'xyz'[this.axis], height};
  }

  #selection() {
    const {app} = this;
    this.brush = slider('Brush', {low: 0.5, high: 25, log: true, unit: '%', title: 'Radius over the object’s diagonal'},
      (percent) => app.setOptions({brush: percent / 100}));
    this.selected = note('');
    this.fix = inModes('simulate', button('Hold in place', () => app.fixSelection()));
    this.free = inModes('simulate', button('Free all', () => app.session.ask({do: 'fix', nodes: []})));
    this.make = inModes('edit', button('Movable handle', () => app.makeHandle(true), {kind: 'primary', title: 'Enter'}));
    this.hold = inModes('edit', button('Fixed handle', () => app.makeHandle(false)));
    this.drop = button('Clear', () => app.select([], 'replace'), {title: 'Esc'});
    const made = section('Selection', this.brush, this.selected, buttons(this.make, this.hold, this.fix, this.free, this.drop));
    this.showSelection(0);
    return inModes('simulate edit', made);
  }

  #editing() {
    const {app} = this;
    this.handleList = element('div', {class: 'handles'});
    this.gizmo = segments('Gizmo', [['translate', 'Translate', 'g'], ['rotate', 'Rotate', 'g']], (gizmo) => app.setOptions({gizmo}));
    this.undo = button('Undo', () => app.session.ask({do: 'undo'}), {title: 'Ctrl+Z'});
    this.redo = button('Redo', () => app.session.ask({do: 'redo'}), {title: 'Ctrl+Shift+Z'});
    this.save = button('Save', () => app.save('scene'), {title: 'A scene that `supple edit` takes'});
    const file = element('input', {type: 'file', accept: '.json,application/json', hidden: true, 'aria-label': 'Scene file', onchange: async () => {
      if (file.files[0]) app.loadScene(await file.files[0].text());
      file.value = '';
    }});
    const made = section('Handles', this.handleList, this.gizmo,
      buttons(this.undo, this.redo, this.save, button('Load', () => file.click())), file);
    return inModes('edit', made);
  }

  #vibrations() {
    const {app} = this;
    this.amplitude = slider('Amplitude', {low: 1, high: 50, log: true, unit: '%', title: 'Over the object’s diagonal'}, (percent) => {
      app.setOptions({amplitude: percent / 100});
      if (app.shownMode !== undefined) app.showMode(app.shownMode);
    });
    this.modeList = element('div', {class: 'mode-list', role: 'listbox', 'aria-label': 'Vibration modes'});
    const made = section('Vibration modes', this.amplitude, this.modeList);
    return inModes('modes', made);
  }

  #view() {
    const {app} = this;
    const flip = (name, label, title) => (this[name] = toggle(label, (on) => app.setOptions({[name]: on}), {title}));
    this.colours = segments('Colour', [['plain', 'Plain'], ['displacement', 'Displacement'], ['strain', 'Strain'], ['error', 'Error']],
      (colours) => app.setOptions({colours}));
    this.strainRange = slider('Range', {low: 1, high: 100, log: true, unit: '%'}, (percent) => app.setOptions({strainRange: percent / 100}));
    const parts = [this.colours, this.strainRange, flip('components', 'Selected components', 'The components whose forces stand for all (c)'),
      flip('wireframe', 'Wireframe', 'w')];
    if (app.session.live) inModes('simulate edit modes', this.components);
    if (app.session.live) {
      parts.push(flip('regions', 'Held regions'));
      this.positions = toggle('Deform on the server', (on) => app.setOptions({stream: on ? 'positions' : 'coordinates'}),
        {title: 'Positions travel instead of reduced coordinates: for graphics without float targets'});
      parts.push(inModes('simulate edit modes', this.positions));
    }
    return section('View', ...parts);
  }

  #playback() {
    this.playbackSpeed = slider('Speed', {low: 0.01, high: 10, log: true, unit: '×'}, (speed) => this.#set({speed}));
    this.overlay = toggle('Overlay', (overlay) => this.app.setOptions({overlay}), {title: 'The second as a ghost in the place of the first (o)'});
    return inModes('replay', section('Replay', this.playbackSpeed, this.overlay));
  }

  #export() {
    const save = (kind, label, title) => button(label, () => this.app.save(kind), {title});
    const row = buttons(save('obj', 'OBJ', 'The shape as it is now'), save('ply', 'PLY', 'The shape as it is now'),
      save('png', 'PNG', 'The picture as it is now (s)'), inModes('simulate edit modes', save('glb', 'glTF', 'What was recorded, or the last seconds, as an animation')),
      inModes('simulate edit modes', save('html', 'Page', 'What was recorded, or the last seconds, as one HTML file that needs no server')));
    row.classList.add('exports');
    return section('Export', row);
  }
}
