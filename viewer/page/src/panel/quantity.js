const PREFIXES = [[1e9, 'G'], [1e6, 'M'], [1e3, 'k'], [1, ''], [1e-3, 'm'], [1e-6, 'µ'], [1e-9, 'n'], [1e-12, 'p']];

/** A number of three digits with its unit, such as 1.20 ms. */
export function quantity(value, unit = '') {
  if (!Number.isFinite(value)) return '–';
  if (Math.abs(value) < 1e-15) return `0 ${unit}`.trim();
  const [factor, prefix] = PREFIXES.find(([f]) => Math.abs(value) >= 0.9995 * f) ?? PREFIXES.at(-1);
  return `${(value / factor).toPrecision(3)} ${prefix}${unit}`.trim();
}

/** A whole number in groups of three digits. */
export function count(value) {
  return String(value).replace(/\B(?=(\d{3})+$)/g, '\u202f');
}

/** A share as a percentage of two digits or more. */
export function percent(share) {
  if (!Number.isFinite(share)) return '–';
  const value = 100 * share;
  return `${Math.abs(value) < 99.5 ? value.toPrecision(2) : count(Math.round(value))} %`;
}
