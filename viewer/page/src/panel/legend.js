import {cssColour} from '../render/colour_maps.js';
import {element} from './widgets.js';

/** What colours mean: bars with numbers and units, and what is painted. */
export class Legend {
  constructor() {
    this.element = element('div', {class: 'legend', role: 'img'});
    this.entries = new Map();
  }

  /**
   * Shows a bar or, without `scale`, removes it.
   * @param {string} key
   * @param {{title: string, map: string, labels: string[]}|null} scale  labels from low to high
   */
  show(key, scale) {
    this.#put(key, scale, ({title, map, labels}) => {
      const stops = Array.from({length: 17}, (_, k) => cssColour(map, k / 16));
      return element('figure', {class: 'bar'}, element('figcaption', {}, title),
        element('i', {style: `background: linear-gradient(to right, ${stops.join(', ')})`}),
        element('div', {}, ...labels.map((label) => element('span', {}, label))));
    });
  }

  /** Says what has a colour of its own. @param {string} key  @param {[string, string][]} names  each with its colour */
  showNames(key, names) {
    this.#put(key, names.length > 0 ? names : null, () => element('ul', {class: 'names'},
      ...names.map(([name, colour]) => element('li', {}, element('i', {style: `background: ${colour}`}), name))));
  }

  #put(key, content, draw) {
    const said = JSON.stringify(content);
    if (this.entries.get(key)?.said === said) return;
    this.entries.get(key)?.drawn.remove();
    this.entries.delete(key);
    if (content) {
      const drawn = draw(content);
      this.element.append(drawn);
      this.entries.set(key, {said, drawn});
    }
    this.element.setAttribute('aria-label', [...this.element.querySelectorAll('figcaption, li')].map((c) => c.textContent).join(', '));
    this.element.hidden = this.entries.size === 0;
  }
}
