import {BufferAttribute, BufferGeometry, Camera, GLSL3, Mesh, NoBlending, RawShaderMaterial, Scene} from 'three';

/** Computes each pixel of a target by a fragment shader. */
export class PixelPass {
  /**
   * @param {string} fragment        GLSL ES 3.0, without its first line
   * @param {Record<string, {value: any}>} uniforms
   * @param {object} options         of the material, such as blending or defines
   */
  constructor(fragment, uniforms, options = {}) {
    const triangle = new BufferGeometry();
    triangle.setAttribute('position', new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    this.uniforms = uniforms;
    this.material = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: 'in vec3 position; void main() { gl_Position = vec4(position, 1); }',
      fragmentShader: PRECISION + fragment,
      uniforms,
      depthTest: false,
      depthWrite: false,
      blending: NoBlending,
      ...options,
    });
    const mesh = new Mesh(triangle, this.material);
    mesh.frustumCulled = false;
    this.scene = new Scene().add(mesh);
    this.camera = new Camera();
  }

  render(renderer, target) {
    const before = renderer.getRenderTarget();
    renderer.setRenderTarget(target);
    renderer.render(this.scene, this.camera);
    renderer.setRenderTarget(before);
  }

  dispose() {
    this.scene.children[0].geometry.dispose();
    this.material.dispose();
  }
}

export const PRECISION = `
  precision highp float;
  precision highp int;
  precision highp sampler2D;
  precision highp sampler2DArray;
  precision highp sampler2DShadow;
  precision highp usampler2D;
`;
