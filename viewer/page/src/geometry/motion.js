import {Matrix4, Quaternion, Vector3} from 'three';

/** The motion that leaves everything where it is. A motion is 12 numbers: the rows of [R t]. */
export const STILL = Object.freeze([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]);

/** @param {ArrayLike<number>} motion */
export function matrixOf(motion) {
  return new Matrix4().set(...motion, 0, 0, 0, 1);
}

/**
 * Where a frame that stood unturned at `centre` has come to.
 * @returns {{position: Vector3, quaternion: Quaternion}}
 */
export function placeOf(motion, centre) {
  const matrix = matrixOf(motion);
  return {
    position: new Vector3(...centre).applyMatrix4(matrix),
    quaternion: new Quaternion().setFromRotationMatrix(matrix),
  };
}

/**
 * The motion that takes a frame from `centre`, unturned, to where it stands: the inverse of placeOf. The quaternion is
 * normalised first, so that R stays a rotation however often it was turned.
 * @returns {number[]}
 */
export function motionTo(position, quaternion, centre) {
  const turn = new Matrix4().makeRotationFromQuaternion(quaternion.clone().normalize());
  const shift = position.clone().sub(new Vector3(...centre).applyMatrix4(turn));
  const e = turn.elements;
  return [e[0], e[4], e[8], shift.x, e[1], e[5], e[9], shift.y, e[2], e[6], e[10], shift.z];
}
