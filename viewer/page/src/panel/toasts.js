import {element} from './widgets.js';

const STAYS = 7000;  // milliseconds

/** Messages that come and go. The same text does not come twice while it is there. */
export class Toasts {
  constructor() {
    this.element = element('div', {class: 'toasts', role: 'status', 'aria-live': 'polite'});
  }

  /** @param {'note'|'warning'|'error'} kind */
  say(text, kind = 'note') {
    const shown = [...this.element.children].find((toast) => toast.textContent === text);
    if (shown) return this.#stay(shown);
    const toast = element('div', {class: `toast ${kind}`, onclick: () => toast.remove()}, text);
    this.element.append(toast);
    while (this.element.children.length > 4) this.element.firstChild.remove();
    this.#stay(toast);
  }

  #stay(toast) {
    clearTimeout(toast.timer);
    toast.timer = setTimeout(() => toast.remove(), STAYS);
  }
}
