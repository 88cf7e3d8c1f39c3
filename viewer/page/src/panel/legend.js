import {cssColour} from '../render/colour_maps.js';
import {element} from './widgets.js';

/** What colours mean, with numbers and units. */
export class Legend {
  constructor() {
    this.element = element('div', {class: 'legend', role: 'img'});
    this.bars = new Map();
  }

  /**
   * Shows a bar or, without `scale`, removes it.
   * @param {string} key
   * @param {{title: string, map: string, labels: string[]}|null} scale  labels from low to high
   */
  show(key, scale) {
    const said = JSON.stringify(scale);
    if (this.bars.get(key)?.said === said) return;
    this.bars.get(key)?.element.remove();
    this.bars.delete(key);
    if (scale) {
      const stops = Array.from({length: 17}, (_, k) => cssColour(scale.map, k / 16));
      const bar = element('figure', {class: 'bar'}, element('figcaption', {}, scale.title),
        element('i', {style: `background: linear-gradient(to right, ${stops.join(', ')})`}),
        element('div', {}, ...scale.labels.map((label) => element('span', {}, label))));
      this.element.append(bar);
      this.bars.set(key, {said, element: bar});
    }
    this.element.setAttribute('aria-label', [...this.element.querySelectorAll('figcaption')].map((c) => c.textContent).join(', '));
    this.element.hidden = this.bars.size === 0;
  }
}
