import {
  Color, GLSL3, Matrix4, Mesh, PerspectiveCamera, PlaneGeometry, RawShaderMaterial, Scene, TOUCH, Vector3, WebGLRenderer,
} from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {Body} from './body.js';
import {Deformer} from './deformer.js';
import {Ground} from './ground.js';
import {Lamp} from './lamp.js';
import {PRECISION} from './pixel_pass.js';
import {drawsInSoftware, Quality} from './quality.js';
import {Light} from './shading.js';
import {SkyLight} from './sky_light.js';
import {THEMES} from './themes.js';
import {upAxisOf} from './up_axis.js';

const KEY_MAP_SIZE = 1024, KEY_MAP_SIZE_IN_SOFTWARE = 512;
const SETTLED = 96;                       // lamps after the last change that make the sky's light complete
const SETTLED_IN_SOFTWARE = 32;           // less complete, but soon
const AZIMUTH = 30, ELEVATION = 18;       // degrees, as in Supple's own pictures
const FIELD_OF_VIEW = 24;
const GAP = 0.25;                         // between an object and its reference, over the diagonal
const SMOOTH = 2;                         // points along a pixel's side that smooth edges, without a graphics card

/** The studio: an object on a ground, light, a camera. It draws when something has changed, and only then. */
export class Stage {
  /** @param {HTMLElement} parent */
  constructor(parent) {
    this.parent = parent;
    this.software = drawsInSoftware();
    this.renderer = new WebGLRenderer({antialias: !this.software, powerPreference: 'high-performance'});
    this.pixelRatio = Math.min(2, window.devicePixelRatio);
    this.quality = new Quality((scale) => this.renderer.setPixelRatio(this.pixelRatio * scale),
      this.software ? SMOOTH / this.pixelRatio : 1);
    this.renderer.setPixelRatio(this.pixelRatio);
    this.canvas = this.renderer.domElement;
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute('aria-label', 'The object. Drag beside it to turn the view, drag on it to pull.');
    parent.append(this.canvas);
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 100);
    this.light = new Light();
    this.keyLamp = new Lamp(this.software ? KEY_MAP_SIZE_IN_SOFTWARE : KEY_MAP_SIZE);
    this.background = backdrop();
    this.scene.add(this.background);
    this.counters = {drawn: 0};
    this.beforeDrawing = [];   // called with the time before each picture
    this.afterDrawing = [];
    this.themeName = 'light';
    this.ball = {centre: [0, 0, 0], radius: 1};
    this.unsettled = 0;
    this.inset = {right: 0, bottom: 0};  // pixels that a panel covers
    new ResizeObserver(() => this.#resize()).observe(parent);
    this.#resize();
  }

  /** Adds the controls of the camera; tools that come before them have been given their listeners by then. */
  addControls() {
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.18;
    this.controls.zoomToCursor = true;
    // An object that fills a small screen leaves no room beside it, where one finger turns the view.
    this.controls.touches.TWO = TOUCH.DOLLY_ROTATE;
    this.controls.addEventListener('change', () => this.invalidate());
  }

  /** Puts a shape on the stage, instead of what was there. */
  setShape(shape, {keepCamera = false} = {}) {
    this.#clear();
    this.shape = shape;
    const {about} = shape.model;
    this.axis = upAxisOf(shape.model);
    this.up = new Vector3().setComponent(this.axis, 1);
    this.camera.up.copy(this.up);
    this.casters = new Scene();
    this.sky = new SkyLight(this.renderer, this.casters);
    this.body = this.#add(shape);
    this.ground = new Ground(this.sky, this.#lightUniforms());
    this.scene.add(this.ground.mesh);
    this.home = {centre: about.low.map((l, k) => (l + about.high[k]) / 2), radius: about.diagonal / 2};
    this.setFloor(null);
    if (!keepCamera) this.frame();
    this.setTheme(this.themeName);
    this.shapeChanged();
  }

  /** Shows a second shape of the model, which the first ought to be, or none. @param {Shape|null} shape */
  setReference(shape) {
    if (this.reference) this.#remove(this.reference);
    this.reference = null;
    this.body.uniforms.other.value = null;
    if (shape) {
      this.reference = this.#add(shape);
      this.setTheme(this.themeName);
    }
    this.#rearranged();
  }

  /** Draws the reference as a ghost in the object's place, or at its right. */
  set overlay(on) {
    this.overlaid = on;
    this.frame();
  }

  /** All that is drawn of the model. */
  get bodies() {
    return this.reference ? [this.body, this.reference] : [this.body];
  }

  /** Their colours. */
  get colours() {
    const {object, reference} = THEMES[this.themeName];
    return [object, reference];
  }

  get deformer() {
    return this.body.deformer;
  }

  /** Lays the ground at a floor's height, with a grid, or under the object at rest, without. */
  setFloor(height) {
    this.groundHeight = height ?? this.shape.model.about.low[this.axis];
    this.ground.uniforms.lines.value = height === null ? 0 : 1;
    this.light.uniforms.ground_height.value = this.groundHeight;
    this.ground.place(this.up, this.groundHeight, this.home);
    this.shapeChanged();
  }

  /** Tells that the shape, or what its shadow falls on, has moved. */
  shapeChanged() {
    this.moved = true;
    this.unsettled = this.software ? SETTLED_IN_SOFTWARE : SETTLED;
    this.invalidate();
  }

  /** Whether the last picture is as good as it gets. */
  get settled() {
    return this.unsettled <= 0 && this.quality.fine && !this.request;
  }

  invalidate() {
    this.request ??= requestAnimationFrame((time) => this.#tick(time));
  }

  /** Moves the camera so that the object as it is now fills the view. */
  frame() {
    this.#arrange();
    const {centre, radius, height} = this.extent = this.#extentOfAll();
    const centreOfView = new Vector3(...centre);
    const right = this.up.x === 1 ? new Vector3(0, 1, 0) : new Vector3(1, 0, 0);
    const front = new Vector3().crossVectors(right, this.up);
    const away = this.framed
      ? this.camera.position.clone().sub(this.controls.target).normalize()
      : front.multiplyScalar(Math.cos(rad(AZIMUTH))).addScaledVector(right, Math.sin(rad(AZIMUTH)))
          .multiplyScalar(Math.cos(rad(ELEVATION))).addScaledVector(this.up, Math.sin(rad(ELEVATION)));
    this.framed = true;
    const {clientWidth: across, clientHeight: along} = this.parent, {right: covered, bottom} = this.inset;
    const distance = Math.max(height / (along - bottom), radius / (across - covered)) * along / Math.sin(rad(FIELD_OF_VIEW / 2));
    this.controls.target.copy(centreOfView);
    this.camera.position.copy(centreOfView).addScaledVector(away, distance);
    this.controls.minDistance = 0.02 * radius;
    this.controls.maxDistance = 60 * radius;
    this.controls.update();
    this.invalidate();
  }

  /** Keeps the object's middle clear of what covers so many pixels at the right and at the bottom. */
  setInset(right, bottom) {
    if (right === this.inset.right && bottom === this.inset.bottom) return;
    this.inset = {right, bottom};
    this.#resize();
  }

  /** Turns around another point from now on. */
  focus(point) {
    const shift = new Vector3(...point).sub(this.controls.target);
    this.controls.target.add(shift);
    this.camera.position.add(shift);
    this.controls.update();
    this.invalidate();
  }

  /** @param {keyof THEMES} name */
  setTheme(name) {
    this.themeName = name;
    const theme = THEMES[name];
    this.background.material.uniforms.top.value.set(theme.top);
    this.background.material.uniforms.bottom.value.set(theme.bottom);
    if (this.body) {
      this.bodies.forEach(({uniforms, lineColour}, k) => {
        uniforms.albedo.value.set(this.colours[k]);
        lineColour.value.set(theme.lines).convertLinearToSRGB();
      });
      this.ground.uniforms.line_colour.value.set(theme.grid).convertLinearToSRGB();
      this.ground.uniforms.strength.value = theme.shadow;
    }
    this.invalidate();
  }

  /** A point on the ground under the object, when that is shifted. @param {Vector3} shift */
  under(shift) {
    return new Vector3(...this.home.centre).setComponent(this.axis, this.groundHeight).add(shift).toArray();
  }

  /** The ray from the eye through a point of the page. */
  ray({clientX, clientY}) {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector3(2 * (clientX - box.left) / box.width - 1, 1 - 2 * (clientY - box.top) / box.height, 0.5);
    const direction = at.unproject(this.camera).sub(this.camera.position).normalize();
    return {origin: this.camera.position.toArray(), direction: direction.toArray()};
  }

  /** Where a point in space is on the page, in pixels of style sheets. */
  project(point) {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector3(...point).project(this.camera);
    return {x: box.left + box.width * (at.x + 1) / 2, y: box.top + box.height * (1 - at.y) / 2};
  }

  /** Projection × view, 16 numbers by columns. */
  viewMatrix() {
    this.camera.updateMatrixWorld();
    return new Matrix4().multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse).elements;
  }

  /** Draws at once, so that the canvas can be read in the same turn. */
  drawNow() {
    this.quality.rest();
    this.#draw(performance.now());
  }

  #tick(time) {
    this.request = null;
    this.quality.begin(time, this.pressed);
    this.controls.update();
    this.#draw(time);
    this.pressed = this.unsettled > 0;
    if (this.pressed) this.invalidate();
    this.quality.end(() => this.drawNow());
  }

  #draw(time) {
    if (!this.body) return;
    for (const call of this.beforeDrawing) call(time);
    if (this.moved) this.#update();
    this.#light();
    this.renderer.render(this.scene, this.camera);
    this.counters.drawn++;
    this.moved = false;
    for (const call of this.afterDrawing) call(time);
  }

  #add(shape) {
    const body = new Body(new Deformer(this.renderer, shape), this.#lightUniforms());
    body.update();
    const {columns, rows} = body.deformer.grid, {positions, normals, shift, sky_light} = body.uniforms;
    sky_light.value = this.sky.addReceiver(columns, rows, {positions, normals, shift});
    this.scene.add(body.mesh);
    this.casters.add(body.caster);
    return body;
  }

  #remove(body) {
    this.scene.remove(body.mesh);
    this.casters.remove(body.caster);
    this.sky.removeReceiver(body.uniforms.sky_light.value);
    body.deformer.dispose();
    body.dispose();
  }

  #lightUniforms() {
    return {...this.light.uniforms, shadow_map: this.keyLamp.map, to_shadow: this.keyLamp.matrix, sky_light: {value: null}};
  }

  #update() {
    for (const body of this.bodies) body.update();
    if (!this.reference) return;
    this.body.uniforms.other.value = this.reference.deformer.positions;
    this.reference.uniforms.other.value = this.body.deformer.positions;
  }

  /** Puts the reference in its place: at the right, along the axis that lies most across the view, or where the object is. */
  #arrange() {
    const {reference, overlaid} = this;
    if (!reference) return;
    reference.ghost = overlaid;
    reference.caster.visible = !overlaid;
    reference.shift.set(0, 0, 0);
    this.#rearranged();
    if (overlaid) return;
    const {low, high, diagonal} = this.shape.model.about, right = this.#right().toArray();
    const axis = [0, 1, 2].reduce((a, b) => (Math.abs(right[b]) > Math.abs(right[a]) ? b : a));
    reference.shift.setComponent(axis, Math.sign(right[axis]) * (high[axis] - low[axis] + GAP * diagonal));
  }

  #rearranged() {
    this.sky.restart();
    this.shapeChanged();
  }

  /** A ball around all shapes, the radius of one, and the largest displacement. */
  #extentOfAll() {
    const [first, second] = this.bodies.map(({shape, shift}) => {
      const {centre, ...extent} = shape.extent();
      return {centre: new Vector3(...centre).add(shift), ...extent};
    });
    if (!second) return {...first, centre: first.centre.toArray(), height: first.radius};
    const height = Math.max(first.radius, second.radius);
    return {
      centre: first.centre.clone().lerp(second.centre, 0.5).toArray(),
      radius: first.centre.distanceTo(second.centre) / 2 + height,
      height,
      displacement: Math.max(first.displacement, second.displacement),
    };
  }

  /** What lies to the right of the camera, level. */
  #right() {
    this.camera.updateMatrixWorld();
    const right = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    return right.addScaledVector(this.up, -right.dot(this.up)).normalize();
  }

  #light() {
    const {renderer, camera} = this;
    this.light.turn(this.#right(), this.up);
    if (this.moved) {
      const {centre, radius} = this.extent = this.#extentOfAll();
      this.ball = {centre, radius: 1.15 * radius};
    }
    this.light.uniforms.scene_radius.value = this.ball.radius;
    this.#castShadows();
    // Without a graphics card a moving object keeps the light that it had at rest.
    const busy = this.software && this.moved && this.sky.count > SETTLED;
    if (this.unsettled-- > 0 && !busy) this.sky.refine(this.up, this.ball);
    const distance = camera.position.distanceTo(new Vector3(...this.home.centre));
    camera.near = Math.max(1e-3 * this.home.radius, distance - 12 * this.home.radius);
    camera.far = distance + 40 * this.home.radius;
    camera.updateProjectionMatrix();
  }

  /** Shadows move with the object and, since the studio turns with it, with the camera. */
  #castShadows() {
    const {renderer, keyLamp} = this, towards = this.light.uniforms.key_towards.value;
    this.shadowsLag ||= this.moved || keyLamp.towards.value.distanceTo(towards) > 1e-4;
    // Without a graphics card those of a moving object lag by a picture.
    const waits = this.software && this.moved && this.counters.drawn % 2;
    if (!this.shadowsLag || waits) return;
    this.shadowsLag = false;
    keyLamp.aim(towards, this.ball);
    keyLamp.look(renderer, this.casters);
    this.ground.update(renderer);
  }

  #resize() {
    const {clientWidth: width, clientHeight: height} = this.parent;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.setViewOffset(width, height, this.inset.right / 2, this.inset.bottom / 2, width, height);
    if (!this.body) return;
    this.#draw(performance.now());  // or the canvas would be blank until the next picture
    this.invalidate();
  }

  #clear() {
    if (!this.body) return;
    for (const body of this.bodies) this.#remove(body);
    this.scene.remove(this.ground.mesh);
    for (const thing of [this.sky, this.ground]) thing.dispose();
    this.body = this.reference = null;
  }
}

const rad = (degrees) => degrees * Math.PI / 180;

function backdrop() {
  const mesh = new Mesh(new PlaneGeometry(2, 2), new RawShaderMaterial({
    glslVersion: GLSL3, depthTest: false, depthWrite: false,
    uniforms: {top: {value: new Color()}, bottom: {value: new Color()}},
    vertexShader: 'in vec3 position; out float height; void main() { height = 0.5 + 0.5 * position.y; gl_Position = vec4(position, 1); }',
    fragmentShader: PRECISION + `
      uniform vec3 top, bottom;
      in float height;
      out vec4 pixel;
      void main() {
        pixel = vec4(pow(mix(bottom, top, smoothstep(0.0, 1.0, height)), vec3(1.0 / 2.2)), 1);
      }`,
  }));
  mesh.renderOrder = -2;
  mesh.frustumCulled = false;
  return mesh;
}
