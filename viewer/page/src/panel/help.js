import {element} from './widgets.js';

const LIVE = [
  ['drag on the object', 'pull it, or what the tool in hand does'],
  ['Shift at the end of a pull', 'the spring stays'],
  ['1  2  3  4', 'simulate, edit, modes, replay'],
  ['p  b  x  m', 'pull, brush, box, move handles'],
  ['g', 'gizmo: translate or rotate'],
  ['Enter', 'selection: a handle (edit), held in place (simulate)'],
  ['Ctrl with brush or box', 'take out of the selection'],
  ['o', 'replay: overlay, or beside'],
  ['Esc', 'drop the selection'],
  ['Ctrl+Z  Ctrl+Shift+Z', 'undo, redo'],
];
const ALL = [
  ['drag beside it, or with Alt', 'turn the view'],
  ['right drag', 'shift the view'],
  ['wheel', 'zoom'],
  ['two fingers', 'zoom, turn the view'],
  ['double click', 'turn around this point'],
  ['f', 'show the whole object'],
  ['Space', 'play, pause'],
  ['.', 'one step'],
  ['r', 'reset'],
  ['c', 'selected components'],
  ['w', 'wireframe'],
  ['d', 'colour: plain, displacement, strain, error'],
  ['s', 'screenshot'],
  ['t', 'dark, light'],
  ['h', 'hide or show panels'],
  ['?', 'this list'],
];

/** The list of keys. */
export function helpDialog({live}) {
  const dialog = element('dialog', {class: 'help', 'aria-label': 'Keys', onclick: (event) => {
    if (event.target === dialog) dialog.close();
  }});
  const rows = [...(live ? LIVE : []), ...ALL].map(([keys, what]) =>
    element('div', {}, element('kbd', {}, keys), element('span', {}, what)));
  dialog.append(element('h2', {}, 'Keys and mouse'), element('div', {class: 'keys-list'}, ...rows),
    element('form', {method: 'dialog'}, element('button', {class: 'button'}, 'Close')));
  return dialog;
}
