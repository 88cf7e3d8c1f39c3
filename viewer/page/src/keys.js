const TOOLS = {p: 'pull', b: 'brush', x: 'box', m: 'move'};
const MODES = {1: 'simulate', 2: 'edit', 3: 'modes', 4: 'replay'};

/** Keys of the page. @param {import('./app.js').App} app */
export function bindKeys(app) {
  const {session, layout} = app;
  const flip = (name) => app.setOptions({[name]: !app.options[name]});
  const keys = {
    ' ': () => session.ask({do: app.state?.playing ? 'pause' : 'play'}),
    '.': () => session.ask({do: 'step'}),
    r: () => session.ask({do: 'reset'}),
    f: () => app.stage.frame(),
    w: () => flip('wireframe'),
    c: () => flip('components'),
    h: () => flip('panels'),
    d: () => app.setOptions({colours: app.colours[(app.colours.indexOf(app.options.colours) + 1) % app.colours.length]}),
    o: () => app.compares && flip('overlay'),
    t: () => app.setOptions({theme: document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark'}),
    s: () => app.save('png'),
    '?': () => layout.toggleHelp(),
  };
  const liveKeys = {
    g: () => app.setOptions({gizmo: app.options.gizmo === 'translate' ? 'rotate' : 'translate'}),
    Escape: () => app.select([], 'replace'),
    Enter: () => (app.mode === 'edit' ? app.makeHandle(true) : app.fixSelection()),
  };
  window.addEventListener('keydown', (event) => {
    if (!app.ready || event.target.closest?.('input:not([type=range]):not([type=checkbox]), select, dialog')) return;
    if (event.ctrlKey || event.metaKey) {
      if (event.key.toLowerCase() !== 'z' || !session.live) return;
      event.preventDefault();
      return session.ask({do: event.shiftKey ? 'redo' : 'undo'});
    }
    if (event.altKey) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const onButton = event.target.closest?.('button, summary, label, input');
    if (onButton && (key === ' ' || key === 'Enter')) return;  // these press it
    const act = keys[key] ?? (session.live ? liveKeys[key] : undefined);
    if (act) event.preventDefault(), act();
    else if (session.live && key in TOOLS) app.setOptions({tool: TOOLS[key]});
    else if (session.live && key in MODES && (key !== '4' || app.model.about.recording)) session.ask({do: 'mode', mode: MODES[key]});
  });
}
