import {Object3D} from 'three';
import {TransformControls} from 'three/addons/controls/TransformControls.js';
import {motionTo, placeOf} from '../geometry/motion.js';
import {DragPlane} from './drag_plane.js';

/** Moves handles: by their gizmo, or dragged by their region along the screen. */
export class MoveTool {
  /** @param {import('../app.js').App} app */
  constructor(app) {
    this.app = app;
    const {stage} = app;
    this.anchor = new Object3D();
    stage.scene.add(this.anchor);
    this.gizmo = new TransformControls(stage.camera, stage.canvas);
    this.gizmo.setSize(0.85);
    this.gizmo.setColors('#d9584c', '#3f9d68', '#4a7fd6', '#f0a63c');
    this.gizmo.showE = false;  // a fourth circle, around the eye's own axis
    stage.scene.add(this.gizmo.getHelper());
    this.gizmo.addEventListener('change', () => stage.invalidate());
    this.gizmo.addEventListener('dragging-changed', ({value}) => {
      stage.controls.enabled = !value;
      this.first = value;
    });
    this.gizmo.addEventListener('objectChange', () => this.#send());
  }

  /** Whether the gizmo is what a press at this moment would move. */
  get aimed() {
    return this.gizmo.enabled && this.gizmo.object !== undefined && this.gizmo.axis !== null;
  }

  get busy() {
    return this.gizmo.dragging || this.plane !== undefined;
  }

  /** Shows the gizmo of a handle, or of none. */
  attach(handle) {
    this.handle = handle?.movable ? handle : null;
    if (!this.handle) return void this.gizmo.detach();
    if (!this.busy) {
      const {position, quaternion} = placeOf(handle.motion, handle.centre);
      this.anchor.position.copy(position);
      this.anchor.quaternion.copy(quaternion);
    }
    if (this.gizmo.object !== this.anchor) this.gizmo.attach(this.anchor);
    this.app.stage.invalidate();
  }

  /** @param {'translate'|'rotate'} way */
  set way(way) {
    this.gizmo.setMode(way);
    this.app.stage.invalidate();
  }

  begin(hit, event) {
    if (this.aimed) return false;
    const handle = hit && this.app.handleAt(hit.node);
    if (!handle) return false;
    this.app.chooseHandle(handle.id);
    if (!handle.movable) return false;
    this.plane = new DragPlane(this.app.stage, this.anchor.position.toArray(), event);
    this.first = true;
    return true;
  }

  move(event) {
    const at = this.plane.at(event);
    if (!at) return;
    this.anchor.position.copy(at);
    this.#send();
  }

  end() {
    this.plane = undefined;
  }

  #send() {
    const {handle, anchor} = this;
    if (!handle) return;
    this.app.moveHandle(handle.id, motionTo(anchor.position, anchor.quaternion, handle.centre), this.first);
    this.first = false;
  }
}
