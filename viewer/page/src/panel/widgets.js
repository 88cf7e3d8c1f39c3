/** Small parts of a panel. Each returns an element; those that show a value have a method `show(value)`. */

/** @returns {HTMLElement} */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) made.addEventListener(name.slice(2), value);
    else if (value === true) made.setAttribute(name, '');
    else if (value !== false && value != null) made.setAttribute(name, value);
  }
  made.append(...children.filter((child) => child != null));
  return made;
}

export function svgElement(tag, attributes = {}) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

/** An element that is there in some modes alone, `modes` being their names; the layout hides it in others. */
export function inModes(modes, made) {
  made.dataset.for = modes;
  return made;
}

export function button(label, act, {title, icon, kind = ''} = {}) {
  const made = element('button', {type: 'button', class: `button ${kind}`, onclick: act, title: title ?? null,
    'aria-label': icon ? label : null});
  if (icon) made.innerHTML = icon;
  else made.textContent = label;
  return made;
}

export function toggle(label, act, {title} = {}) {
  const input = element('input', {type: 'checkbox', role: 'switch', onchange: () => act(input.checked)});
  const made = element('label', {class: 'row toggle', title}, element('span', {}, label), input, element('i'));
  made.show = (on) => (input.checked = on);
  return made;
}

let ids = 0;

/** A slider with the number beside it. With `log` its steps are factors. */
export function slider(label, {low, high, log = false, digits = 3, unit = '', title}, act) {
  const to = (v) => (log ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low));
  const from = (s) => (log ? low * (high / low) ** s : low + s * (high - low));
  const id = `slider-${++ids}`;
  const range = element('input', {
    type: 'range', id, min: 0, max: 1, step: 0.001,
    oninput: () => {
      const value = Number(from(range.valueAsNumber).toPrecision(digits));
      number.value = value;
      range.style.setProperty('--share', range.value);
      act(value);
    },
  });
  const number = element('input', {
    type: 'number', step: 'any', 'aria-label': `${label}${unit ? ` in ${unit}` : ''}, as a number`,
    onchange: () => {
      if (Number.isFinite(number.valueAsNumber)) act(number.valueAsNumber);
    },
  });
  const made = element('div', {class: 'row slider', title},
    element('label', {for: id}, label), range, number, element('small', {}, unit));
  made.show = (value) => {
    if (document.activeElement === number) return;
    number.value = Number(value.toPrecision(digits));
    if (document.activeElement !== range || !range.matches(':active')) {
      range.value = Math.min(1, Math.max(0, to(value)));
      range.style.setProperty('--share', range.value);
    }
  };
  return made;
}

export function vector(label, unit, act) {
  const inputs = ['x', 'y', 'z'].map((axis) => element('input', {
    type: 'number', step: 'any', 'aria-label': `${label} along ${axis} in ${unit}`, placeholder: axis,
    onchange: () => {
      const values = inputs.map((input) => input.valueAsNumber);
      if (values.every(Number.isFinite)) act(values);
    },
  }));
  const made = element('div', {class: 'row vector'}, element('span', {}, label), ...inputs, element('small', {}, unit));
  made.show = (values) => inputs.forEach((input, k) => {
    if (document.activeElement !== input) input.value = Number(values[k].toPrecision(4));
  });
  return made;
}

export function choice(label, options, act) {
  const select = element('select', {'aria-label': label, onchange: () => act(select.value)},
    ...options.map((option) => element('option', {value: option}, option.replaceAll('-', ' '))));
  const made = element('div', {class: 'row choice'}, element('span', {}, label), select);
  made.show = (value) => {
    if (![...select.options].some((option) => option.value === value)) select.append(element('option', {value}, value));
    select.value = value;
  };
  return made;
}

/** Buttons of which one is pressed. @param {[string, string, string?][]} options  value, label and title */
export function segments(label, options, act) {
  const buttons = options.map(([value, text, title]) => {
    const made = element('button', {type: 'button', title, 'data-value': value, onclick: () => act(value)});
    if (text.startsWith('<svg')) made.innerHTML = text, made.setAttribute('aria-label', title);
    else made.textContent = text;
    return made;
  });
  const made = element('div', {class: 'segments', role: 'group', 'aria-label': label}, ...buttons);
  made.show = (value) => buttons.forEach((b) => b.setAttribute('aria-pressed', String(b.dataset.value === value)));
  return made;
}

export function section(title, ...children) {
  return element('details', {class: 'section', open: true}, element('summary', {}, title), ...children);
}

export function buttons(...children) {
  return element('div', {class: 'row buttons'}, ...children);
}

export function note(text) {
  return element('p', {class: 'note'}, text);
}
