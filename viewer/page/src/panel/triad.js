import {element, svgElement} from './widgets.js';

const SIZE = 76, REACH = 24, BEYOND = 32;  // pixels: the drawing, an axis, its name

/** The axes of the model as the camera sees them. */
export class Triad {
  constructor() {
    this.axes = ['x', 'y', 'z'].map((name) => {
      const line = svgElement('line', {x1: 0, y1: 0}), label = svgElement('text', {dy: '0.34em'});
      label.textContent = name;
      const group = svgElement('g', {class: name});
      group.append(line, label);
      return {group, line, label};
    });
    const drawing = svgElement('svg', {viewBox: `${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}`, 'aria-hidden': 'true'});
    this.holder = svgElement('g');
    drawing.append(this.holder);
    this.element = element('div', {class: 'triad', title: 'Axes of the model'}, drawing);
  }

  /** @param {import('three').Camera} camera */
  turn({matrixWorldInverse: {elements}}) {
    const seen = this.axes.map((axis, k) => ({...axis, at: elements.slice(4 * k, 4 * k + 3)}));
    for (const {line, label, at: [right, up]} of seen) {
      place(line, {x2: REACH * right, y2: -REACH * up});
      place(label, {x: BEYOND * right, y: -BEYOND * up});
    }
    this.holder.append(...seen.sort((a, b) => a.at[2] - b.at[2]).map(({group}) => group));  // what is near covers what is far
  }
}

function place(part, places) {
  for (const [name, value] of Object.entries(places)) part.setAttribute(name, value.toFixed(2));
}
