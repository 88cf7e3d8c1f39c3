import {Shape} from './geometry/shape.js';
import {Recorder} from './export/recorder.js';
import {makeFile} from './export/files.js';
import {download} from './export/download.js';
import {bindKeys} from './keys.js';
import {Layout} from './panel/layout.js';
import {quantity} from './panel/quantity.js';
import {Components} from './render/components.js';
import {REGION_COLOURS} from './render/themes.js';
import {Springs} from './render/springs.js';
import {Stage} from './render/stage.js';
import {MoveTool} from './tools/move_tool.js';
import {Pointer} from './tools/pointer.js';
import {PullTool} from './tools/pull_tool.js';
import {BoxTool, BrushTool} from './tools/select_tools.js';

const DEFAULTS = {
  tool: 'pull', colours: 'plain', strainRange: 0.25, wireframe: false, components: false, regions: true, overlay: false,
  pullStiffness: 1, brush: 0.05, gizmo: 'translate', amplitude: 0.1, stream: 'coordinates', theme: 'auto',
  panels: window.innerWidth > 720,
};

/** The page: it joins a session to the stage, the tools and the panel. What the session says is the truth. */
export class App {
  /** @param {HTMLElement} root  @param {import('./session/live_session.js').LiveSession} session */
  constructor(root, session) {
    this.session = session;
    this.options = {...DEFAULTS};
    this.selection = new Set();
    this.ready = false;
    this.recorder = new Recorder();
    this.layout = new Layout(root, this);
    this.stage = new Stage(this.layout.stage);
    this.pointer = new Pointer(this.stage, () => this.#toolInHand());
    this.stage.addControls();
    this.tools = {pull: new PullTool(this), brush: new BrushTool(this), box: new BoxTool(this), move: new MoveTool(this)};
    this.stage.beforeDrawing.push(() => this.#beforeDrawing());
    this.stage.afterDrawing.push((time) => this.#afterDrawing(time));
    bindKeys(this);
    const dark = matchMedia('(prefers-color-scheme: dark)');
    dark.addEventListener('change', () => this.#applyTheme());
    this.#listen();
    this.setOptions({theme: storedTheme()});
  }

  get mode() {
    return this.state?.mode ?? 'simulate';
  }

  /** Whether two recordings are shown. */
  get compares() {
    return Boolean(this.stage.reference);
  }

  /** What colours may say at this moment. */
  get colours() {
    return ['plain', 'displacement', 'strain', ...(this.compares ? ['error'] : [])];
  }

  // What the person at the page wants

  setOptions(options) {
    Object.assign(this.options, options);
    if ('theme' in options) this.#applyTheme();
    if ('stream' in options) this.session.choose(options.stream);
    if ('overlay' in options && this.compares) {
      this.stage.overlay = options.overlay;
      this.#nameRecordings();
    }
    if ('gizmo' in options) this.tools.move.way = options.gizmo;
    this.#applyOptions();
  }

  pull(node, target) {
    this.ownPull = {node, target, own: true};
    const {pull_stiffness} = this.model.about;
    this.session.ask({do: 'pull', node, target, stiffness: pull_stiffness * this.options.pullStiffness});
    this.#showPulls();
  }

  release() {
    if (this.ownPull) this.layout.hint.dismiss();
    this.ownPull = null;
    this.session.ask({do: 'release'});
    this.#showPulls();
  }

  /** @param {Iterable<number>} nodes  @param {'replace'|'add'|'remove'} how */
  select(nodes, how) {
    if (how === 'replace') this.selection.clear();
    for (const v of nodes) {
      if (how === 'remove') this.selection.delete(v);
      else this.selection.add(v);
    }
    this.#paintRegions();
    this.layout.panel.showSelection(this.selection.size);
  }

  fixSelection() {
    if (this.selection.size === 0) return;
    this.session.ask({do: 'fix', nodes: [...new Set([...this.state.fixed, ...this.selection])]});
    this.select([], 'replace');
  }

  makeHandle(movable) {
    if (this.selection.size === 0) return;
    const known = new Set(this.state.handles.map(({name}) => name));
    const stem = movable ? 'handle' : 'anchor';
    let number = 1;
    while (known.has(`${stem} ${number}`)) number++;
    const name = `${stem} ${number}`, nodes = [...this.selection].sort((a, b) => a - b);
    this.session.ask({do: 'handle', nodes, name, movable});
    this.select([], 'replace');
    if (!movable) return;
    this.wantsHandle = name;
    this.setOptions({tool: 'move'});
  }

  handleAt(node) {
    return this.state?.handles.find(({nodes}) => nodes.includes(node));
  }

  chooseHandle(id) {
    this.chosen = id;
    this.#showHandles();
  }

  moveHandle(id, motion, grab) {
    this.session.ask({do: 'move', handle: id, motion, grab});
  }

  showMode(index) {
    this.shownMode = index;
    this.session.ask({do: 'show_mode', mode: index, amplitude: this.options.amplitude});
    this.layout.panel.showMode(index);
  }

  /** @param {'obj'|'ply'|'glb'|'png'|'html'} kind */
  async exportFile(kind) {
    return makeFile(kind, this);
  }

  async save(kind) {
    try {
      if (kind === 'scene') return this.session.ask({do: 'save'});
      const {name, content, type} = await this.exportFile(kind);
      download(name, content, type);
      this.layout.toasts.say(`${name} is saved`);
    } catch (error) {
      this.layout.toasts.say(error.message, 'error');
    }
  }

  loadScene(text) {
    try {
      this.session.ask({do: 'load', scene: JSON.parse(text)});
    } catch {
      this.layout.toasts.say('This file is no JSON', 'error');
    }
  }

  // What the session says

  #listen() {
    const {session, layout} = this;
    const on = (type, act) => session.addEventListener(type, ({detail}) => act(detail));
    on('connection', (connected) => {
      layout.showConnection(connected);
      if (!connected) this.ownPull = null;
    });
    on('progress', ({stage, share}) => layout.showProgress(stage, share));
    on('model', (model) => this.#takeModel(model));
    on('state', (state) => this.#takeState(state));
    on('frame', (frame) => this.#takeFrame(frame));
    on('warning', (text) => layout.toasts.say(text, 'warning'));
    on('refused', ({do: what, reason}) => layout.toasts.say(`${what}: ${reason}`, 'error'));
    on('saved', (scene) => download(`${this.model.about.name}-scene.json`, JSON.stringify(scene, null, 1), 'application/json'));
  }

  #takeModel(model) {
    const known = this.model && JSON.stringify(this.model.about) === JSON.stringify(model.about);
    this.layout.showProgress(null);
    if (known) return;
    const similar = this.model?.about.name === model.about.name;
    this.model = model;
    this.selection.clear();
    this.recorder = new Recorder();
    this.springs?.dispose();
    this.components?.dispose();
    for (const thing of [this.springs?.group, this.components?.mesh]) if (thing) this.stage.scene.remove(thing);
    const shape = new Shape(model);
    this.stage.setShape(shape, {keepCamera: similar});
    this.#nameRecordings();
    this.springs = new Springs(shape);
    this.components = new Components(this.stage.body, model);
    this.stage.scene.add(this.springs.group, this.components.mesh);
    this.displacementRange = this.errorRange = 1e-4 * model.about.diagonal;
    this.layout.setModel(model, this.session);
    if (!this.stage.deformer.computes) this.setOptions({stream: 'positions'});
    for (const text of model.about.notes ?? []) this.layout.toasts.say(text);
    if (this.session.recording?.view) this.#restoreView(this.session.recording.view);
    this.ready = true;
    this.#applyOptions();
    this.#applyState();
    if (this.frame) this.#takeFrame(this.frame);
  }

  #takeState(state) {
    const before = this.state;
    this.state = state;
    if (state.mode !== before?.mode) {
      this.setOptions({tool: {simulate: 'pull', edit: state.handles.length ? 'move' : 'brush'}[state.mode] ?? null});
      if (state.mode === 'modes' && this.model?.about.frequencies.length) this.showMode(this.shownMode ?? 0);
    }
    if (this.wantsHandle) {
      const made = state.handles.find(({name}) => name === this.wantsHandle);
      if (made) this.chosen = made.id, this.wantsHandle = null;
    }
    this.#applyState();
  }

  #takeFrame(frame) {
    this.frame = frame;
    if (!this.ready) return;
    const {dimension, surface_nodes} = this.model.about;
    if (frame.values.length !== (frame.kind === 'coordinates' ? dimension : 3 * surface_nodes)) return;
    this.stage.shape.take(frame);
    const reference = frame.reference && {kind: 'positions', values: frame.reference};
    if (Boolean(reference) !== this.compares) this.#compare(reference);
    else if (reference) this.stage.reference.shape.take(reference);
    this.layout.plots.take(frame, this.mode);
    this.layout.showFrame(frame);
    this.fresh = frame;
    if (frame.kind === 'coordinates') this.recorder.take(frame.values, performance.now() / 1000);
    this.stage.shapeChanged();
  }

  /** Begins or ends to show a second recording. */
  #compare(reference) {
    const shape = reference && new Shape(this.model, this.stage.shape);
    shape?.take(reference);
    this.stage.setReference(shape);
    if (!this.colours.includes(this.options.colours)) this.options.colours = 'plain';
    this.stage.overlay = this.options.overlay;
    this.#nameRecordings();
    this.#applyOptions();
  }

  /** Under the objects where these are side by side, else by their colours. */
  #nameRecordings() {
    const {compares, layout, stage, options: {overlay}} = this, {names} = this.model.about.recording ?? {};
    layout.labels.show(compares && !overlay ? stage.bodies.map(({shift}, k) => [names[k], shift]) : []);
    layout.legend.showNames('recordings', compares && overlay ? names.map((name, k) => [name, stage.colours[k]]) : []);
  }

  // What is shown

  #toolInHand() {
    if (!this.ready || !this.session.live || !['simulate', 'edit'].includes(this.mode)) return null;
    if (this.mode === 'edit' && this.tools.move.aimed) return void (this.stage.controls.enabled = false);
    return this.tools[this.options.tool] ?? null;
  }

  #beforeDrawing() {
    this.springs?.update();
    const {stage} = this, {displacement} = stage.extent ?? {displacement: 0};
    // The scale grows at once and shrinks slowly, so that colours do not flicker.
    const range = (before, now) => Math.max(now, 0.998 * before, 1e-4 * this.model.about.diagonal);
    if (this.options.colours === 'displacement') this.displacementRange = range(this.displacementRange, displacement);
    else if (this.options.colours === 'error') this.errorRange = range(this.errorRange, stage.shape.distance(stage.reference.shape));
    else return;
    this.#applyColours();
  }

  #afterDrawing(time) {
    if (this.fresh) this.session.drawn(this.fresh);
    this.fresh = null;
    this.layout.plots.tick(time);
    this.layout.triad.turn(this.stage.camera);
    this.layout.labels.place(this.stage);
  }

  #applyOptions() {
    const {options, stage} = this;
    this.layout.panel.showOptions(options);
    this.layout.showOptions(options);
    if (!this.ready) return;
    const components = options.components && !this.compares;
    stage.body.ghost = components;
    for (const body of stage.bodies) body.wireframe = options.wireframe;
    this.components.mesh.visible = components;
    const {low, high} = this.components.range;
    this.layout.legend.show('weights', components
      ? {title: 'weight of a component', map: 'sequential', labels: [low, high].map((w) => w.toPrecision(3))} : null);
    stage.canvas.style.cursor = {pull: 'grab', brush: 'crosshair', box: 'crosshair'}[options.tool] ?? '';
    this.#applyColours();
    this.#paintRegions();
    this.#showHandles();
    stage.invalidate();
  }

  #applyColours() {
    const {colours, strainRange, overlay} = this.options, {body, reference} = this.stage;
    const range = {displacement: this.displacementRange, error: this.errorRange}[colours] ?? strainRange;
    body.show(colours, range);
    reference?.show(overlay ? 'plain' : colours, range);
    const lengths = {map: 'sequential', labels: ['0', quantity(range / 2, 'm'), quantity(range, 'm')]};
    this.layout.legend.show('colours', {
      plain: null,
      displacement: {title: 'displacement', ...lengths},
      error: {title: 'distance from each other', ...lengths},
      strain: {title: 'strain of the surface', map: 'diverging', labels: [`−${100 * range} %`, '0', `+${100 * range} %`]},
    }[colours]);
  }

  #applyState() {
    if (!this.ready || !this.state) return;
    const {floor} = this.state.settings;
    const height = floor && 'xyz'.indexOf(floor.axis) === this.stage.axis ? floor.height : null;
    if (height !== this.floorHeight) this.stage.setFloor(this.floorHeight = height);
    this.layout.showState(this.state);
    this.layout.panel.showState(this.state);
    this.#paintRegions();
    this.#showHandles();
    this.#showPulls();
  }

  #paintRegions() {
    if (!this.ready) return;
    const {held, fixed, selected, handles, anchors} = REGION_COLOURS, regions = [];
    const {state, options, model} = this;
    const inPlace = this.mode === 'simulate' ? state?.fixed ?? [] : [];
    if (options.regions && state) {
      regions.push([model.about.fixed, held], [inPlace, fixed]);
      if (state.mode === 'edit')
        for (const {id, nodes, movable} of state.handles)
          regions.push([nodes, movable ? handles[(id - 1) % handles.length] : anchors]);
    }
    regions.push([this.selection, selected]);
    for (const body of this.stage.bodies) body.paint(regions);
    const named = [['held by the model', model.about.fixed, held], ['held in place', inPlace, fixed]];
    this.layout.legend.showNames('regions', options.regions
      ? named.filter(([, nodes]) => nodes.length > 0).map(([name, , colour]) => [name, `rgb(${colour.join(' ')})`]) : []);
    this.stage.invalidate();
  }

  #showHandles() {
    if (!this.ready || !this.state) return;
    const editing = this.mode === 'edit';
    const handle = editing ? this.state.handles.find(({id}) => id === this.chosen) : null;
    this.tools.move.attach(this.options.tool === 'move' ? handle : null);
    this.layout.panel.showHandles(this.state, this.chosen);
  }

  #showPulls() {
    if (!this.ready) return;
    const others = (this.state?.pulls ?? []).filter(({client}) => client !== this.session.client);
    const shown = this.mode === 'simulate' ? [...others, ...(this.ownPull ? [this.ownPull] : [])] : [];
    this.springs.show(shown);
    this.stage.invalidate();
  }

  #applyTheme() {
    const {theme} = this.options;
    const dark = theme === 'auto' ? matchMedia('(prefers-color-scheme: dark)').matches : theme === 'dark';
    document.documentElement.dataset.theme = dark ? 'dark' : 'light';
    this.stage.setTheme(dark ? 'dark' : 'light');
  }

  #restoreView({position, target, options}) {
    this.stage.controls.target.fromArray(target);
    this.stage.camera.position.fromArray(position);
    this.stage.controls.update();
    this.setOptions(options);
  }

  /** What a standalone page has to know to show what this one shows. */
  view() {
    const {colours, strainRange, wireframe, components, theme} = this.options;
    const {camera, controls} = this.stage;
    return {
      position: camera.position.toArray(), target: controls.target.toArray(),
      options: {colours, strainRange, wireframe, components, theme},
    };
  }
}

function storedTheme() {
  const asked = new URLSearchParams(location.search).get('theme');
  return ['light', 'dark'].includes(asked) ? asked : 'auto';
}
