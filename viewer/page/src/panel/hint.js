import {ICONS} from './icons.js';
import {button, element} from './widgets.js';

const KEY = 'supple-hint';

/** A line for who is here for the first time. It goes, for good, when it was followed or closed. */
export class Hint {
  constructor() {
    const keys = matchMedia('(pointer: coarse)').matches ? 'two fingers zoom and turn' : '? for keys';
    this.element = element('div', {class: 'toast hint', 'data-for': 'simulate'},
      `Drag the object to pull it · drag beside it to turn · ${keys}`,
      button('Close the hint', () => this.dismiss(), {icon: ICONS.remove, kind: 'small'}));
    this.seen = stored() !== null;
  }

  dismiss() {
    if (this.seen) return;
    this.seen = true;
    this.element.remove();
    try {
      localStorage.setItem(KEY, 'seen');
    } catch {
      // Without storage it comes again with the next page.
    }
  }
}

function stored() {
  try {
    return localStorage.getItem(KEY);
  } catch {
    return null;
  }
}
