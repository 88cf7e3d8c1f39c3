import {CylinderGeometry, Group, Mesh, MeshBasicMaterial, SphereGeometry, Vector3} from 'three';

const THIN = 0.0022, NODE = 0.007, TARGET = 0.012;  // over the object's diagonal

/** Pulls, drawn from the node to the ball that it is pulled to. */
export class Springs {
  constructor(shape) {
    this.shape = shape;
    this.group = new Group();
    this.rod = new CylinderGeometry(1, 1, 1, 12);
    this.ball = new SphereGeometry(1, 24, 16);
    // Over everything, since what is pulled into the object must stay in sight.
    const above = {depthTest: false, transparent: true};
    this.own = new MeshBasicMaterial({color: '#f0662e', ...above});
    this.foreign = new MeshBasicMaterial({color: '#7c8a9c', ...above});
    this.drawn = [];
  }

  /** @param {{node: number, target: number[], own: boolean}[]} pulls */
  show(pulls) {
    while (this.drawn.length < pulls.length) this.drawn.push(this.#make());
    this.pulls = pulls;
    this.drawn.forEach(({group}, k) => (group.visible = k < pulls.length));
    this.update();
  }

  /** Follows the nodes. */
  update() {
    const size = this.shape.model.about.diagonal;
    this.pulls?.forEach(({node, target, own}, k) => {
      const {rod, start, end} = this.drawn[k];
      const from = new Vector3(...this.shape.position(node)), to = new Vector3(...target);
      const along = to.clone().sub(from), length = along.length();
      for (const part of [rod, start, end]) part.material = own ? this.own : this.foreign;
      start.position.copy(from);
      end.position.copy(to);
      start.scale.setScalar(NODE * size);
      end.scale.setScalar(TARGET * size);
      rod.position.copy(from).addScaledVector(along, 0.5);
      rod.scale.set(THIN * size, Math.max(length, 1e-9), THIN * size);
      if (length > 0) rod.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), along.divideScalar(length));
    });
  }

  dispose() {
    for (const thing of [this.rod, this.ball, this.own, this.foreign]) thing.dispose();
  }

  #make() {
    const group = new Group();
    const rod = new Mesh(this.rod, this.own), start = new Mesh(this.ball, this.own), end = new Mesh(this.ball, this.own);
    group.add(rod, start, end);
    for (const part of group.children) part.renderOrder = 3;
    this.group.add(group);
    return {group, rod, start, end};
  }
}
