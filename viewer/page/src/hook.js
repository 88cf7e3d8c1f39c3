/** `window.supple`: what tests and curious people ask the page. @param {import('./app.js').App} app */
export function exposeHook(app) {
  const {session} = app;
  window.supple = {
    get ready() { return app.ready; },
    get settled() { return app.stage.settled; },
    get connected() { return session.connected; },
    get client() { return session.client; },
    get compares() { return app.compares; },
    get state() { return app.state; },
    get frame() { return app.frame; },
    get about() { return app.model?.about; },
    get selection() { return [...app.selection]; },
    get options() { return {...app.options}; },
    get computesOnGpu() { return app.stage.deformer.computes && !app.stage.shape.displacements; },
    get counters() {
      const {memory, render} = app.stage.renderer.info;
      return {...session.counters, ...app.stage.counters, textures: memory.textures, triangles: render.triangles};
    },
    get camera() {
      return {position: app.stage.camera.position.toArray(), target: app.stage.controls.target.toArray()};
    },

    /** All the rest, for the console. */
    app,
    ask: (message) => session.ask(message),
    choose: (stream) => session.choose(stream),
    set: (options) => app.setOptions(options),
    select: (nodes) => app.select(nodes, 'replace'),
    pull: (node, target) => app.pull(node, target),
    release: () => app.release(),

    /** What is seen at a point of the page: {node, point, …} or null. */
    pick: (clientX, clientY) => app.pointer.pick({clientX, clientY}),
    /** Where a node is on the page. */
    project: (node) => app.stage.project(app.stage.shape.position(node)),
    position: (node) => [...app.stage.shape.position(node)],
    referencePositions: () => Array.from(app.stage.reference.shape.positions()),
    positions: () => Array.from(app.stage.shape.positions()),
    /** Largest distance between positions on the graphics card and on the processor, over the object's diagonal. */
    disagreement() {
      app.stage.drawNow();
      const here = app.stage.shape.positions(), there = app.stage.deformer.readPositions();
      return here.reduce((worst, x, i) => Math.max(worst, Math.abs(x - there[i])), 0) / app.model.about.diagonal;
    },
    /** Largest difference between strains on the graphics card and on the processor. */
    strainDisagreement() {
      app.stage.drawNow();
      const here = app.stage.shape.strains(), there = app.stage.deformer.readStrains();
      return there.reduce((worst, strain, v) => Math.max(worst, Math.abs(strain - here[v])), 0);
    },
    /** Red, green, blue and alpha at a point of the page, each 0 … 255. */
    pixel(clientX, clientY) {
      app.stage.drawNow();
      const {canvas, renderer} = app.stage, box = canvas.getBoundingClientRect(), gl = renderer.getContext();
      const rgba = new Uint8Array(4), ratio = canvas.width / box.width;
      gl.readPixels((clientX - box.left) * ratio, canvas.height - 1 - (clientY - box.top) * ratio, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
      return [...rgba];
    },
    /** Milliseconds from a pull to the picture in which the node has moved by a thousandth of the diagonal. */
    async latency(node, target) {
      const before = app.stage.shape.position(node), {diagonal} = app.model.about;
      const start = performance.now();
      app.pull(node, target);
      return new Promise((resolve) => {
        const look = () => {
          const x = app.stage.shape.position(node);
          if (Math.hypot(...x.map((c, k) => c - before[k])) < 1e-3 * diagonal) return;
          app.stage.renderer.getContext().finish();
          app.stage.afterDrawing.splice(app.stage.afterDrawing.indexOf(look), 1);
          resolve(performance.now() - start);
        };
        app.stage.afterDrawing.push(look);
      });
    },
    /** A file as the panel would hand it out: obj, ply, glb, png or html. */
    export: (kind) => app.exportFile(kind),
  };
}
