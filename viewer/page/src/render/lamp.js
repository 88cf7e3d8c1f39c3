import {DepthTexture, LessEqualCompare, LinearFilter, Matrix4, NearestFilter, OrthographicCamera, Vector3, WebGLRenderTarget} from 'three';

/** A light infinitely far away, and what it sees of the object: a map of depths. */
export class Lamp {
  constructor(size) {
    const depthTexture = new DepthTexture(size, size);
    depthTexture.compareFunction = LessEqualCompare;
    depthTexture.minFilter = depthTexture.magFilter = LinearFilter;
    this.target = new WebGLRenderTarget(size, size, {depthTexture, minFilter: NearestFilter, magFilter: NearestFilter});
    this.camera = new OrthographicCamera();
    this.towards = {value: new Vector3(0, 1, 0)};
    this.map = {value: depthTexture};
    this.matrix = {value: new Matrix4()};
  }

  /** Points the lamp from a direction at a ball. */
  aim(towards, {centre, radius}) {
    const {camera} = this;
    this.towards.value.copy(towards);
    camera.left = camera.bottom = -radius;
    camera.right = camera.top = radius;
    camera.near = 0;
    camera.far = 2 * radius;
    camera.position.set(...centre).addScaledVector(towards, radius);
    // Any direction that is not the lamp's own does as its up.
    camera.up.set(Math.abs(towards.x) < 0.9 ? 1 : 0, Math.abs(towards.x) < 0.9 ? 0 : 1, 0);
    camera.lookAt(...centre);
    camera.updateMatrixWorld();
    camera.updateProjectionMatrix();
    this.matrix.value.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
  }

  /** Draws what casts shadows. */
  look(renderer, scene) {
    const before = renderer.getRenderTarget();
    renderer.setRenderTarget(this.target);
    renderer.clear();
    renderer.render(scene, this.camera);
    renderer.setRenderTarget(before);
  }

  dispose() {
    this.target.dispose();
  }
}
