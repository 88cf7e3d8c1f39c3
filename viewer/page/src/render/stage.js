import {
  Color, GLSL3, Matrix4, Mesh, PerspectiveCamera, PlaneGeometry, RawShaderMaterial, Scene, Vector3, WebGLRenderer,
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
    this.inset = 0;  // pixels at the right that a panel covers
    new ResizeObserver(() => this.#resize()).observe(parent);
    this.#resize();
  }

  /** Adds the controls of the camera; tools that come before them have been given their listeners by then. */
  addControls() {
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.18;
    this.controls.zoomToCursor = true;
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
    this.deformer = new Deformer(this.renderer, shape);
    const light = {
      ...this.light.uniforms, shadow_map: this.keyLamp.map, to_shadow: this.keyLamp.matrix, sky_light: {value: null},
    };
    this.body = new Body(this.deformer, light);
    this.body.update();
    this.sky = new SkyLight(this.renderer, this.body.casters);
    this.body.uniforms.sky_light.value = this.sky.addReceiver(this.deformer.grid.columns, this.deformer.grid.rows,
      {positions: this.body.uniforms.positions, normals: this.body.uniforms.normals});
    this.ground = new Ground(this.sky, light);
    this.scene.add(this.body.mesh, this.ground.mesh);
    this.home = {centre: about.low.map((l, k) => (l + about.high[k]) / 2), radius: about.diagonal / 2};
    this.setFloor(null);
    if (!keepCamera) this.frame();
    this.setTheme(this.themeName);
    this.shapeChanged();
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
    const {centre, radius} = this.extent = this.shape.extent();
    const centreOfView = new Vector3(...centre);
    const right = this.up.x === 1 ? new Vector3(0, 1, 0) : new Vector3(1, 0, 0);
    const front = new Vector3().crossVectors(right, this.up);
    const away = this.framed
      ? this.camera.position.clone().sub(this.controls.target).normalize()
      : front.multiplyScalar(Math.cos(rad(AZIMUTH))).addScaledVector(right, Math.sin(rad(AZIMUTH)))
          .multiplyScalar(Math.cos(rad(ELEVATION))).addScaledVector(this.up, Math.sin(rad(ELEVATION)));
    this.framed = true;
    const narrow = Math.min(1, (this.parent.clientWidth - this.inset) / this.parent.clientHeight);
    const distance = radius / Math.sin(rad(FIELD_OF_VIEW / 2)) / narrow;
    this.controls.target.copy(centreOfView);
    this.camera.position.copy(centreOfView).addScaledVector(away, distance);
    this.controls.minDistance = 0.02 * radius;
    this.controls.maxDistance = 60 * radius;
    this.controls.update();
    this.invalidate();
  }

  /** Keeps the object's middle clear of what covers so many pixels at the right. */
  setInset(right) {
    if (right === this.inset) return;
    this.inset = right;
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
      this.body.uniforms.albedo.value.set(theme.object);
      this.body.lineColour.value.set(theme.lines).convertLinearToSRGB();
      this.ground.uniforms.line_colour.value.set(theme.grid).convertLinearToSRGB();
      this.ground.uniforms.strength.value = theme.shadow;
    }
    this.invalidate();
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
    if (this.moved) this.body.update();
    this.#light();
    this.renderer.render(this.scene, this.camera);
    this.counters.drawn++;
    this.moved = false;
    for (const call of this.afterDrawing) call(time);
  }

  #light() {
    const {renderer, camera} = this;
    camera.updateMatrixWorld();
    const right = new Vector3().setFromMatrixColumn(camera.matrixWorld, 0);
    this.light.turn(right.addScaledVector(this.up, -right.dot(this.up)).normalize(), this.up);
    if (this.moved) {
      const {centre, radius} = this.extent = this.shape.extent();
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
    keyLamp.look(renderer, this.body.casters);
    this.ground.update(renderer);
  }

  #resize() {
    const {clientWidth: width, clientHeight: height} = this.parent;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.setViewOffset(width, height, this.inset / 2, 0, width, height);
    if (!this.body) return;
    this.#draw(performance.now());  // or the canvas would be blank until the next picture
    this.invalidate();
  }

  #clear() {
    if (!this.body) return;
    this.scene.remove(this.body.mesh, this.ground.mesh);
    for (const thing of [this.body, this.deformer, this.sky, this.ground]) thing.dispose();
    this.body = null;
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
