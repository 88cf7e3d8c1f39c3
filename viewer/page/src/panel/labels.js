import {element} from './widgets.js';

/** Names that stand under what they name. */
export class Labels {
  constructor() {
    this.element = element('div', {class: 'labels'});
    this.shown = [];
  }

  /** @param {[string, import('three').Vector3][]} labels  names, and by how much what they name is shifted */
  show(labels) {
    this.shown = labels.map(([name, shift]) => ({shift, label: element('span', {class: 'label'}, name)}));
    this.element.replaceChildren(...this.shown.map(({label}) => label));
  }

  /** Follows the camera. @param {import('../render/stage.js').Stage} stage */
  place(stage) {
    for (const {shift, label} of this.shown) {
      const {x, y} = stage.project(stage.under(shift));
      label.style.translate = `calc(${x.toFixed(1)}px - 50%) ${(y + 24).toFixed(1)}px`;
    }
  }
}
