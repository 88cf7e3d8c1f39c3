import {Plane, Ray, Vector3} from 'three';

/** Points under the pointer on a plane through a point, parallel to the screen. */
export class DragPlane {
  /** @param {import('../render/stage.js').Stage} stage  @param {number[]} point  @param {PointerEvent} event  that grasps */
  constructor(stage, point, event) {
    this.stage = stage;
    this.plane = new Plane().setFromNormalAndCoplanarPoint(stage.camera.getWorldDirection(new Vector3()), new Vector3(...point));
    const grasped = this.#under(event);
    this.offset = grasped ? new Vector3(...point).sub(grasped) : new Vector3();
  }

  /** Where the point that was grasped has been dragged to, or null if the pointer has left the plane. */
  at(event) {
    return this.#under(event)?.add(this.offset) ?? null;
  }

  #under(event) {
    const {origin, direction} = this.stage.ray(event);
    return new Ray(new Vector3(...origin), new Vector3(...direction)).intersectPlane(this.plane, new Vector3());
  }
}
